use freeform_curve_fit::{Outline, outward_normals};
use freeform_riccati::MotionModel;
use nalgebra::{DMatrix, DVector, Matrix2, Matrix3, Point2, SMatrix, SVector, Vector2};

use super::outline_cells::{BodyPoint, OutlineCells};
use crate::{
    estimate::{MAX_PARAMETERS, MotionEstimate},
    filter::{FilterError, FilterSettings, MotionFilter, Phase, median},
    information::invert_positive_definite,
    motion_algebra::{
        CoordinateMatrix, Coordinates, adjoint, columns, coordinates, map_point, normal_velocities, pull_back,
    },
};

/// Residuals up to this many standard deviations count in full, beyond `NO_WEIGHT` not at all, with Tukey's biweight between.
const FULL_WEIGHT: f64 = 3.0;
const NO_WEIGHT: f64 = 6.0;
/// Length of a cell in standard deviations of the noise.
const NOISE_PER_CELL: f64 = 3.0;
/// How far points may lie from their cell, in standard deviations of the noise.
const REACH: f64 = 8.0;
/// Fewest points for each cell in the mean, over all frames, and a guess of the outline's length in RMS radii for it.
const POINTS_PER_CELL: f64 = 8.0;
const OUTLINE_LENGTH: f64 = 8.0;
/// Longest cell in RMS radii.
const LONGEST_CELL: f64 = 0.3;
/// Smallest standard deviation of the noise that is reckoned with, in RMS radii.
const SMALLEST_NOISE: f64 = 1e-7;
/// Half width of the window of normals, as a fraction of the outline's length.
const NORMAL_HALF_WINDOW: f64 = 0.02;
/// Times that the cells are taken anew from the points.
const ROUNDS: usize = 3;
/// Most Gauss-Newton steps with one set of cells.
const MOST_STEPS: usize = 20;
/// A step of so many standard deviations is the last.
const SETTLED: f64 = 0.02;
/// Steps after which points stay with their cells, so that those between two do not keep the solution from settling.
const FREE_STEPS: usize = 4;

/// Why a recording gives no motion.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum BatchError {
    /// A frame that cannot be used at all.
    #[error("frame {index} cannot be used: {error}")]
    Frame {
        /// Its position, counted from 0.
        index: usize,
        /// What is wrong with it.
        error: FilterError,
    },
    /// The motion filter, which gives the start, found the object in fewer than two frames.
    #[error("the object was found in fewer than two of {frames} frames")]
    NoStart {
        /// Frames given.
        frames: usize,
    },
    /// The equations have no solution: too few points agree on one outline and one motion.
    #[error("the points do not determine a motion, {cells} pieces of the outline are known")]
    Undetermined {
        /// Pieces of the outline.
        cells: usize,
    },
}

/// The constant motion that all frames of a recording agree on.
#[derive(Debug, Clone, PartialEq)]
pub struct BatchEstimate {
    /// The motion in image units, with standard deviations.
    pub motion: MotionEstimate,
    /// Covariance of its parameters, in their order.
    pub covariance: DMatrix<f64>,
    /// Standard deviation of the noise on the points, image lengths.
    pub noise: f64,
    /// Frames used, and not taken for wrong by the filter that gave the start.
    pub frames_used: usize,
    /// Pieces that the outline was taken as, each with an offset and a slope of its own.
    pub outline_pieces: usize,
    /// Gauss-Newton steps in all.
    pub steps: usize,
    /// Whether the last step was small against the standard deviations.
    pub converged: bool,
}

/// One frame in normalised coordinates.
struct RecordedFrame {
    /// Since the first frame, in seconds.
    time: f64,
    points: Vec<Point2<f64>>,
    normals: Vec<Vector2<f64>>,
}

/// A frame at the motion at hand.
struct PlacedFrame {
    flow: Matrix3<f64>,
    inverse: Matrix3<f64>,
    by_motion: CoordinateMatrix,
    body: Vec<BodyPoint>,
}

/// One Gauss-Newton step of the motion, its covariance, and the noise that the residuals before it show.
struct Step {
    motion: DVector<f64>,
    covariance: DMatrix<f64>,
    sigma: f64,
}

type PieceCoupling = SMatrix<f64, MAX_PARAMETERS, 2>;

/// Estimates a constant motion from all frames at once: `min sum rho(residual / sigma)` over the motion and the outline, by
/// Gauss-Newton on the exact flow with Tukey weights.
///
/// The body frame is the image at the first frame used, so that the initial pose is part of the outline. Every point is mapped back to
/// it; its residual is the distance from a straight piece of the outline, whose offset and slope are eliminated. Work is linear in
/// the points, and repeated for every step: this is the reference for recorded data, [`MotionFilter`] the way to keep up with a
/// camera. The filter gives the start, and tells which frames show something else.
///
/// ```
/// use freeform_curve_fit::Outline;
/// use freeform_identify::estimate_batch;
/// use freeform_riccati::MotionModel;
/// use nalgebra::{Isometry2, Point2, Vector2};
///
/// let egg = |i: i32| {
///     let t = std::f64::consts::TAU * f64::from(i) / 300.0;
///     Point2::new(0.5 * t.cos() + 0.05 * (2.0 * t).cos(), 0.35 * t.sin())
/// };
/// let mut frames = Vec::new();
/// for frame in 0..10 {
///     let time = f64::from(frame) / 30.0;
///     let pose = Isometry2::new(Vector2::new(0.2 * time, 0.0), 0.5 * time);
///     frames.push((time, Outline::closed((0..300).map(|i| pose * egg(i)).collect())?));
/// }
/// let found = estimate_batch(MotionModel::Rigid, &frames)?;
/// assert!((found.motion.values()[0] + 0.5).abs() < 0.001);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Times that do not increase, a first outline of fewer than 8 points, an object that is found in fewer than two frames.
pub fn estimate_batch(model: MotionModel, frames: &[(f64, Outline)]) -> Result<BatchEstimate, BatchError> {
    let k = model.parameter_count();
    let mut filter = MotionFilter::new(FilterSettings { model, ..FilterSettings::default() })
        .map_err(|error| BatchError::Frame { index: 0, error })?;
    let mut used = Vec::new();
    for (index, (time, outline)) in frames.iter().enumerate() {
        let step = filter.step(*time, outline).map_err(|error| BatchError::Frame { index, error })?;
        if step.accepted {
            // Looked for anew: it has not gone on from the frames before.
            if step.phase == Phase::Acquiring {
                used.clear();
            }
            used.push(index);
        }
    }
    let start = filter.estimate().filter(|_| used.len() > 1).ok_or(BatchError::NoStart { frames: frames.len() })?;
    let (first_time, first) = &frames[used[0]];
    let (origin, radius) = (first.centroid(), first.rms_radius());
    let to_image = Matrix3::new(radius, 0.0, origin.x, 0.0, radius, origin.y, 0.0, 0.0, 1.0);
    let from_image = to_image.try_inverse().ok_or(BatchError::Undetermined { cells: 0 })?;
    let recorded: Vec<RecordedFrame> = used
        .iter()
        .map(|i| RecordedFrame {
            time: frames[*i].0 - first_time,
            points: frames[*i].1.points().map(|p| Point2::from((p - origin) / radius)).collect(),
            normals: outward_normals(&frames[*i].1, NORMAL_HALF_WINDOW),
        })
        .collect();
    let mut motion = coordinates(model, &(from_image * start.generator() * to_image));
    let mut sigma = filter.map().map_or(0.0, crate::filter::OutlineMap::noise) / radius;
    let total: usize = recorded.iter().map(|f| f.points.len()).sum();
    let finest = POINTS_PER_CELL * OUTLINE_LENGTH / total as f64;
    let (mut steps, mut converged) = (0, false);
    let mut solution = None;
    let mut known: Option<OutlineCells> = None;
    // The outline as the filter knows it, if it has begun with the same frame.
    let begun = filter.map().filter(|map| map.origin == origin && map.radius == radius);
    for _ in 0..ROUNDS {
        let placed = place(model, &recorded, &motion);
        let mut all: Vec<BodyPoint> = placed.iter().flat_map(|f| f.body.iter().copied()).collect();
        // Outliers turn the normals of their neighbours in the frame; the outline has those of many frames.
        for point in &mut all {
            let normal = match &known {
                Some(known) => known.normal_at(point),
                None => begun.and_then(|map| map.normal_near(&point.place)),
            };
            point.normal = normal.unwrap_or(point.normal);
        }
        let length = (NOISE_PER_CELL * sigma).max(finest).min(LONGEST_CELL);
        let mut cells = OutlineCells::covering(&all, length, REACH * sigma);
        let mut owners = Vec::new();
        for step in 0..MOST_STEPS {
            let placed = place(model, &recorded, &motion);
            if step < FREE_STEPS {
                owners = placed.iter().flat_map(|f| f.body.iter().map(|point| cells.nearest(point))).collect();
            }
            let undetermined = BatchError::Undetermined { cells: cells.list.len() };
            let moved = gauss_newton(model, &recorded, &placed, (&mut cells, &owners), sigma).ok_or(undetermined)?;
            (0..k).for_each(|j| motion[j] += moved.motion[j]);
            steps += 1;
            converged = (0..k).all(|j| moved.motion[j].abs() < SETTLED * moved.covariance[(j, j)].sqrt());
            sigma = moved.sigma.max(SMALLEST_NOISE);
            solution = Some((moved.covariance, cells.list.len()));
            if converged {
                break;
            }
        }
        known = Some(cells);
    }
    let (covariance, outline_pieces) = solution.ok_or(BatchError::Undetermined { cells: 0 })?;
    let change = adjoint(model, &to_image, &from_image);
    let change = DMatrix::from_fn(k, k, |i, j| change[i][j]);
    let covariance = &change * covariance * change.transpose();
    let values = coordinates(model, &(to_image * model.generator(&motion[..k]) * from_image));
    let deviations: Vec<f64> = covariance.diagonal().iter().map(|v| v.max(0.0).sqrt()).collect();
    // What the filter, which knows of directions that an outline does not show, has not seen is not there to be seen.
    let unseen = start.parameters().enumerate().filter(|(_, p)| p.value.is_none()).map(|(j, _)| j);
    let motion =
        unseen.fold(MotionEstimate::new(model, &values[..k], Some(&deviations)), MotionEstimate::with_unobservable);
    let noise = sigma * radius;
    Ok(BatchEstimate { motion, covariance, noise, frames_used: used.len(), outline_pieces, steps, converged })
}

/// All frames mapped back to the body frame.
fn place(model: MotionModel, recorded: &[RecordedFrame], motion: &Coordinates) -> Vec<PlacedFrame> {
    let theta = &motion[..model.parameter_count()];
    let placed = recorded.iter().map(|frame| {
        let flow = model.flow(theta, frame.time).into_inner();
        let inverse = flow.try_inverse().unwrap_or_else(|| Matrix3::repeat(f64::NAN));
        let by_motion = columns(model, model.flow_sensitivities(theta, frame.time).into_iter());
        let body = frame.points.iter().zip(&frame.normals).map(|(p, n)| {
            let place = map_point(&inverse, p);
            let normal = pull_back(&flow, &place, p, n);
            BodyPoint { place, normal: normal.try_normalize(0.0).unwrap_or_else(Vector2::zeros) }
        });
        let body = body.filter(|b| b.place.coords.iter().all(|c| c.is_finite())).collect();
        PlacedFrame { flow, inverse, by_motion, body }
    });
    placed.collect()
}

/// One step for the motion, already taken for the pieces of the outline, given which of them every point belongs to.
fn gauss_newton(
    model: MotionModel,
    recorded: &[RecordedFrame],
    placed: &[PlacedFrame],
    (cells, owners): (&mut OutlineCells, &[Option<usize>]),
    sigma: f64,
) -> Option<Step> {
    let k = model.parameter_count();
    let count = cells.list.len();
    let mut information = SMatrix::<f64, MAX_PARAMETERS, MAX_PARAMETERS>::zeros();
    let mut right = SVector::<f64, MAX_PARAMETERS>::zeros();
    let mut coupling = vec![PieceCoupling::zeros(); count];
    let mut own = vec![Matrix2::zeros(); count];
    let mut own_right = vec![Vector2::zeros(); count];
    let mut sizes = Vec::new();
    let mut owners = owners.iter();
    for (frame, at) in recorded.iter().zip(placed) {
        if at.body.len() != frame.points.len() {
            // The flow has left the plane: this motion is no solution.
            return None;
        }
        for (p, body) in frame.points.iter().zip(&at.body) {
            let Some(number) = owners.next().copied().flatten() else { continue };
            let cell = &cells.list[number];
            let (z, along) = cell.read(&body.place, cells.length);
            // A step along the image normal moves the body point by the length of this along the normal of the piece.
            let pulled = pull_back(&at.inverse, p, &body.place, &cell.normal);
            let slope = 1.0 / pulled.norm();
            let (residual, normal) = (z * slope, pulled * slope);
            let excess = (residual.abs() / sigma - FULL_WEIGHT) / (NO_WEIGHT - FULL_WEIGHT);
            let weight = if excess <= 0.0 { 1.0 } else { (1.0 - (excess * excess).min(1.0)).powi(2) };
            sizes.push(residual.abs());
            if weight == 0.0 {
                continue;
            }
            // At the foot point: taken at the noisy one the product with the residual would have a mean.
            let foot = map_point(&at.flow, &(body.place - z * cell.normal));
            let velocities = normal_velocities(model, &foot, &normal);
            let mut row = SVector::<f64, MAX_PARAMETERS>::zeros();
            (0..k).for_each(|j| row[j] = (0..k).map(|i| velocities[i] * at.by_motion[i][j]).sum());
            let piece = Vector2::new(slope, slope * along);
            information += weight * row * row.transpose();
            right += weight * residual * row;
            coupling[number] += weight * row * piece.transpose();
            own[number] += weight * piece * piece.transpose();
            own_right[number] += weight * residual * piece;
        }
    }
    let inverses: Vec<Matrix2<f64>> = own
        .iter()
        .map(|m| {
            // A slope that its points do not tell stays as it is.
            let ridge = Matrix2::new(1e-9 * m.trace(), 0.0, 0.0, 1e-3 * m[(0, 0)] + 1e-30);
            (m + ridge).try_inverse().unwrap_or_else(Matrix2::zeros)
        })
        .collect();
    for ((coupling, inverse), own_right) in coupling.iter().zip(&inverses).zip(&own_right) {
        let carried = coupling * inverse;
        information -= carried * coupling.transpose();
        right -= carried * own_right;
    }
    let inner = DMatrix::from_fn(k, k, |i, j| information[(i, j)]);
    let unit_covariance = invert_positive_definite(&inner)?;
    let step = &unit_covariance * DVector::from_fn(k, |i, _| right[i]);
    if !step.iter().all(|e| e.is_finite()) {
        return None;
    }
    let mut whole_step = SVector::<f64, MAX_PARAMETERS>::zeros();
    (0..k).for_each(|j| whole_step[j] = step[j]);
    let solved = inverses
        .iter()
        .zip(&own_right)
        .zip(&coupling)
        .map(|((inverse, r), c)| inverse * (r - c.transpose() * whole_step));
    for (cell, shift) in cells.list.iter_mut().zip(solved) {
        cell.offset += shift.x;
        cell.slope += shift.y;
    }
    // What two numbers for each piece have taken from the residuals.
    let taken = (2 * own.iter().filter(|m| m.trace() > 0.0).count() + k) as f64 / sizes.len() as f64;
    let sigma = 1.4826 * median(&mut sizes)? / (1.0 - taken.min(0.9)).sqrt();
    Some(Step { motion: step, covariance: unit_covariance * (sigma * sigma), sigma })
}
