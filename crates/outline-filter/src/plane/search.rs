//! The motions of a plane that explain a sequence of poses: least squares from many starts.
use freeform_riccati::{PlaneMotion, PlaneSolutions, logarithm};
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use super::scenery::{Matrix8, Scenery, Vector8, adjoint, error_between, moved};
use crate::tuning::plane as tuning;

/// Where a frame shows the outline, and how well it does.
#[derive(Debug, Clone, Copy)]
pub(super) struct SeenPose {
    /// Since the first frame.
    pub(super) seconds: f64,
    /// Body to image, normalised.
    pub(super) pose: Matrix3<f64>,
    /// In units of the noise.
    pub(super) information: Matrix8,
}

/// A least sum of squares, in units of the noise.
#[derive(Debug, Clone, Copy)]
pub(super) struct Minimum {
    pub(super) motion: PlaneMotion,
    pub(super) squares: f64,
}

/// Motion, and the error of the pose in the first frame, which all poses share by way of the outline.
type State = SVector<f64, 16>;
type StateMatrix = SMatrix<f64, 16, 16>;

/// The motions that explain the poses, best first, different ones alone. `known` are motions to begin with beside all others.
pub(super) fn minima(scenery: &Scenery, poses: &[SeenPose], known: &[PlaneMotion]) -> Vec<Minimum> {
    let mut starts = starts(scenery, poses);
    starts.extend_from_slice(known);
    let mut found: Vec<Minimum> = Vec::new();
    for start in starts {
        let Some(minimum) = minimum(scenery, poses, start) else { continue };
        if !is_seen(scenery, &minimum.motion, poses) {
            continue;
        }
        match found.iter_mut().find(|other| are_alike(&other.motion, &minimum.motion, poses)) {
            Some(other) if minimum.squares < other.squares => *other = minimum,
            Some(_) => {}
            None => found.push(minimum),
        }
    }
    found.sort_by(|a, b| a.squares.total_cmp(&b.squares));
    found
}

/// Whether the camera sees the outline in every frame.
fn is_seen(scenery: &Scenery, motion: &PlaneMotion, poses: &[SeenPose]) -> bool {
    motion.parameters().iter().all(|value| value.is_finite())
        && poses.iter().all(|seen| scenery.shows(motion, seen.seconds))
}

/// Whether two motions are one that was found twice.
fn are_alike(a: &PlaneMotion, b: &PlaneMotion, poses: &[SeenPose]) -> bool {
    let span = poses.last().map_or(1.0, |last| last.seconds);
    let apart = (a.normal - b.normal).amax().max(span * (a.angular_velocity - b.angular_velocity).amax());
    apart.max(span * (a.velocity - b.velocity).amax()) < tuning::ALIKE
}

/// Motions from the mean generator of an early stretch: its two solutions, and the best with each of some normals.
fn starts(scenery: &Scenery, poses: &[SeenPose]) -> Vec<PlaneMotion> {
    let Some((generator, middle)) = early_generator(scenery, poses) else { return Vec::new() };
    let mut starts = Vec::new();
    let solutions = match PlaneMotion::of_generator(&generator) {
        PlaneSolutions::Two(both) => both.to_vec(),
        PlaneSolutions::One(one) => vec![one],
        PlaneSolutions::Turn { angular_velocity } => {
            vec![PlaneMotion { angular_velocity, velocity: Vector3::zeros(), normal: Vector3::z() }]
        }
    };
    // They hold in the middle of the stretch.
    starts.extend(solutions.iter().filter_map(|solution| solution.after(-middle).scaled_to_axis()));
    for ring in tuning::STARTING_TILTS {
        let count = if ring == 0.0 { 1 } else { tuning::STARTS_PER_RING };
        for i in 0..count {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / f64::from(count)).sin_cos();
            let normal = Vector3::new(ring * cos, ring * sin, 1.0);
            starts.extend(with_normal(&generator, normal).and_then(|start| start.after(-middle).scaled_to_axis()));
        }
    }
    starts
}

/// Generator of normalised image points that has led from the first pose to one of about a third of the time, and half of that time.
fn early_generator(scenery: &Scenery, poses: &[SeenPose]) -> Option<(Matrix3<f64>, f64)> {
    let (first, last) = (poses.first()?, poses.last()?);
    let later = poses.iter().skip(1).find(|seen| seen.seconds >= tuning::EARLY * last.seconds)?;
    let flow = scenery.in_camera(&(later.pose * first.pose.try_inverse()?))?;
    let generator = logarithm(&(flow / flow.determinant().cbrt()))? / later.seconds;
    generator.iter().all(|entry| entry.is_finite()).then_some((generator, 0.5 * later.seconds))
}

/// The motion with a normal whose generator is nearest to one, a multiple of the identity being free.
fn with_normal(generator: &Matrix3<f64>, normal: Vector3<f64>) -> Option<PlaneMotion> {
    let mut columns = Vec::with_capacity(7);
    for i in 0..3 {
        columns.push(Vector3::ith(i, 1.0).cross_matrix());
    }
    for i in 0..3 {
        columns.push(Vector3::ith(i, 1.0) * normal.transpose());
    }
    columns.push(Matrix3::identity());
    let flat = |matrix: &Matrix3<f64>| SVector::<f64, 9>::from_column_slice(matrix.as_slice());
    let columns: Vec<_> = columns.iter().map(flat).collect();
    let columns = SMatrix::<f64, 9, 7>::from_columns(&columns);
    let normal_matrix: SMatrix<f64, 7, 7> = columns.transpose() * columns;
    let solution = normal_matrix.cholesky()?.solve(&(columns.transpose() * flat(generator)));
    Some(PlaneMotion {
        angular_velocity: solution.fixed_rows::<3>(0).into_owned(),
        velocity: solution.fixed_rows::<3>(3).into_owned(),
        normal,
    })
}

/// Levenberg and Marquardt from one start.
fn minimum(scenery: &Scenery, poses: &[SeenPose], start: PlaneMotion) -> Option<Minimum> {
    let first = poses.first()?;
    let (mut motion, mut pose) = (start, first.pose);
    let sigma = scenery.sigma();
    let mut damping = tuning::FIRST_DAMPING;
    let (mut matrix, mut right, mut squares) = linearised(scenery, poses, &motion, &pose)?;
    for _ in 0..tuning::MOST_SEARCH_STEPS {
        let mut damped = matrix;
        (0..16).for_each(|i| damped[(i, i)] *= 1.0 + damping);
        let Some(step) = freeform_estimate::scaled_solution(&damped, &right) else { break };
        let by_motion: Vector8 = step.fixed_rows::<8>(0).into_owned();
        let next = PlaneMotion::of_parameters((Vector8::from(motion.parameters()) + by_motion).into());
        let next_pose = moved(&pose, &step.fixed_rows::<8>(8).into_owned());
        let expected = step.dot(&right) / (sigma * sigma);
        match next_pose.and_then(|pose| Some((pose, linearised(scenery, poses, &next, &pose)?))) {
            Some((next_pose, (next_matrix, next_right, next_squares))) if next_squares < squares => {
                (motion, pose) = (next, next_pose);
                let fallen = squares - next_squares;
                (matrix, right, squares) = (next_matrix, next_right, next_squares);
                damping *= tuning::LESS_DAMPING;
                if fallen < tuning::FALLEN_ENOUGH && expected < tuning::FALLEN_ENOUGH {
                    break;
                }
            }
            _ => {
                damping *= tuning::MORE_DAMPING;
                if damping > tuning::MOST_DAMPING || expected < tuning::FALLEN_ENOUGH {
                    break;
                }
            }
        }
    }
    Some(Minimum { motion, squares })
}

/// Normal equations over motion and first pose, and the sum of squares.
fn linearised(
    scenery: &Scenery,
    poses: &[SeenPose],
    motion: &PlaneMotion,
    first: &Matrix3<f64>,
) -> Option<(StateMatrix, State, f64)> {
    let (mut matrix, mut right, mut squares) = (StateMatrix::zeros(), State::zeros(), 0.0);
    for seen in poses {
        let flow = scenery.flow(motion, seen.seconds);
        let error = error_between(&(flow * first), &seen.pose)?;
        let (by_motion, by_first) = (scenery.sensitivity(motion, seen.seconds)?, adjoint(&flow)?);
        let mut rows = SMatrix::<f64, 8, 16>::zeros();
        rows.fixed_view_mut::<8, 8>(0, 0).copy_from(&by_motion);
        rows.fixed_view_mut::<8, 8>(0, 8).copy_from(&by_first);
        let weighted = seen.information * rows;
        matrix += rows.transpose() * weighted;
        right += weighted.transpose() * error;
        squares += error.dot(&(seen.information * error));
    }
    let prior = super::solution::prior(scenery, poses.last()?.seconds);
    (0..8).for_each(|i| matrix[(i, i)] += prior[i]);
    let parameters = Vector8::from(motion.parameters());
    right.fixed_rows_mut::<8>(0).axpy(-1.0, &prior.component_mul(&parameters), 1.0);
    squares += parameters.dot(&prior.component_mul(&parameters));
    let squares = squares / scenery.sigma().powi(2);
    squares.is_finite().then_some((matrix, right, squares))
}
