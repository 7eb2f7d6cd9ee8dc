//! A pose brought onto the points of a frame from one that is near, by least squares of their distances from the outline.
use freeform_riccati::{MotionModel, is_affine, map_point, map_point_by};
use nalgebra::{Const, DimMin, Matrix3, Point2, SMatrix, SVector, Vector2};

use super::linearised::{Equations, Linearised, Rows, Seen, SideBySide};
use crate::{
    map::median,
    measurement::{Lies, View, hide_points},
    track::Track,
    tuning::{measurement::MEDIAN_TO_DEVIATION, registration as tuning},
    vectors::vectorised,
};

/// A pose that fits a frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RegisteredPose {
    /// Body to image, normalised coordinates.
    pub(crate) pose: Matrix3<f64>,
    /// Mean distance of the points from the map, normalised; those far off count as if they were [`tuning::FARTHEST`] away.
    pub(super) score: f64,
    /// Deviation of the points from the lines through their cells before the last step, normalised; no less than that of the noise.
    pub(super) spread: f64,
    /// Turn from the pose before, rad, anticlockwise where y points up.
    pub(crate) turn: f64,
}

impl RegisteredPose {
    /// Takes the score that it has by other points of the frame.
    pub(super) fn score_by(&mut self, track: &Track, points: &[Point2<f64>]) {
        if self.score.is_finite() {
            self.score = mean_distance(track, points, &self.pose, &mut vec![0; points.len()]);
        }
    }
}

/// How a start is followed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Steps {
    most: usize,
    /// Deviation of the residuals that the first step allows for, normalised. Where the median residual is small from the beginning, as on a
    /// disc with a pin, the points that tell the turn are those that are far off.
    widest: f64,
}

impl Steps {
    /// Of a search, until searches may have come together...
    pub(super) const FIRST: Self = Self { most: tuning::FIRST_STEPS, widest: tuning::WIDEST };
    /// ...and from there on.
    pub(super) const FURTHER: Self =
        Self { most: tuning::SEARCH_STEPS - tuning::FIRST_STEPS, widest: tuning::WIDEST_FURTHER };
    pub(super) const REFINEMENT: Self = Self { most: tuning::REFINEMENT_STEPS, widest: tuning::WIDEST_REFINED };
}

/// So few of the points of a frame that a search is soon made.
pub(super) fn few_of(points: &[Point2<f64>]) -> Vec<Point2<f64>> {
    let stride = (points.len() / tuning::FEW_POINTS).max(1);
    points.iter().step_by(stride).copied().collect()
}

/// Where the outline has its middle in the present pose, and the middle of the points of a frame: a search begins with one in the other.
pub(super) fn middles(track: &Track, points: &[Point2<f64>]) -> [Vector2<f64>; 2] {
    let (cells, pose) = (track.map().cells(), track.body_pose());
    let of_cells = cells.iter().map(|c| map_point(pose, &c.centre).coords / cells.len() as f64);
    [of_cells.sum(), points.iter().map(|p| p.coords / points.len() as f64).sum()]
}

/// Point-to-line steps with Tukey weights at a scale that shrinks with the residuals, at most so many.
pub(super) fn refined(
    track: &Track,
    points: &[Point2<f64>],
    model: MotionModel,
    start: &Matrix3<f64>,
    steps: Steps,
) -> RegisteredPose {
    let count = points.len();
    match model.parameter_count() {
        3 if !track.map().has_ends() && is_affine(start) => {
            refined_by::<3, SideBySide>(track, points, model, start, steps, SideBySide::default())
        }
        3 => refined_by(track, points, model, start, steps, Rows::<3>::new(model, count)),
        4 => refined_by(track, points, model, start, steps, Rows::<4>::new(model, count)),
        6 => refined_by(track, points, model, start, steps, Rows::<6>::new(model, count)),
        _ => refined_by(track, points, model, start, steps, Rows::<8>::new(model, count)),
    }
}

fn refined_by<const K: usize, L: Linearised<K>>(
    track: &Track,
    points: &[Point2<f64>],
    model: MotionModel,
    start: &Matrix3<f64>,
    steps: Steps,
    mut linearised: L,
) -> RegisteredPose
where
    Const<K>: DimMin<Const<K>, Output = Const<K>>,
{
    let View { map, belief, noise } = track.view();
    let mut pose = *start;
    let mut numbers = vec![0; points.len()];
    let mut sizes = Vec::with_capacity(points.len());
    let (mut widest, mut spread) = (steps.widest, f64::INFINITY);
    let mut shows_outline = true;
    for _ in 0..steps.most {
        let Some(inverse) = pose.try_inverse() else { break };
        let seen = Seen { points, inverse: &inverse, map, offsets: &belief.offsets };
        linearised.take(&seen, &mut numbers);
        if model == belief.model {
            map.null_directions(model, &pose).iter().for_each(|direction| linearised.leave_out(direction));
        }
        linearised.write_sizes(&mut sizes);
        shows_outline = sizes.len() as f64 >= tuning::FEWEST_ON_OUTLINE * points.len() as f64;
        spread = MEDIAN_TO_DEVIATION * median(&mut sizes).unwrap_or(0.0).max(noise.sigma);
        let scale = tuning::TUKEY * spread.max(widest);
        let is_narrow = widest <= spread;
        widest *= tuning::NARROWER;
        let Some(step) = step_of(linearised.equations(scale)) else { break };
        let next = model.flow(step.as_slice(), 1.0).into_inner() * pose;
        if !next.iter().all(|e| e.is_finite()) || next.determinant().abs() < tuning::SMALLEST_AREA {
            break;
        }
        pose = next;
        if is_narrow && step.amax() < tuning::SETTLED * noise.sigma {
            break;
        }
    }
    // Points that all lie beyond ends would fit anywhere.
    let score = if shows_outline { mean_distance(track, points, &pose, &mut numbers) } else { f64::INFINITY };
    let spread = if shows_outline { spread } else { f64::INFINITY };
    let turn = track.turn_to(&pose);
    RegisteredPose { pose, score, spread, turn }
}

/// The step that solves normal equations; `None` where numbers are not finite.
fn step_of<const K: usize>((gram, right): Equations<K>) -> Option<SVector<f64, K>>
where
    Const<K>: DimMin<Const<K>, Output = Const<K>>,
{
    let gram = SMatrix::<f64, K, K>::from_fn(|i, j| gram[i][j] + if i == j { tuning::DAMPING } else { 0.0 });
    Some(gram.cholesky()?.solve(&SVector::from(right)))
}

/// Distances that points count for at most in the score of a pose.
#[derive(Debug, Clone, Copy)]
struct MostDistance {
    /// Nearest to a known end of the outline, and beyond it.
    beyond_end: f64,
    elsewhere: f64,
}

impl Seen<'_> {
    #[inline(always)]
    fn mean_distance<const AFFINE: bool>(&self, most: MostDistance, numbers: &mut [u32]) -> f64 {
        let Self { points, inverse, map, offsets } = self;
        let places = points.iter().map(
            #[inline(always)]
            |p| map_point_by::<AFFINE>(inverse, p),
        );
        map.associate_all(places.clone(), numbers);
        let cells = map.cells();
        let mut sum = 0.0;
        if !map.has_ends() {
            for (q, number) in places.zip(numbers) {
                let (cell, offset) = (&cells[*number as usize], offsets[*number as usize]);
                sum += (q - (cell.centre + offset * cell.normal)).norm().min(most.elsewhere);
            }
            return sum / points.len() as f64;
        }
        let (mut unknown, mut lies) = (0, Vec::with_capacity(points.len()));
        for (q, number) in places.zip(numbers) {
            let (cell, offset) = (&cells[*number as usize], offsets[*number as usize]);
            let distance = (q - (cell.centre + offset * cell.normal)).norm();
            let is_beyond_end = map.lies_beyond_end(*number as usize, &q);
            sum += distance.min(if is_beyond_end { most.beyond_end } else { most.elsewhere });
            unknown += usize::from(is_beyond_end);
            lies.push(Lies::of(is_beyond_end, distance < most.elsewhere));
        }
        // All points are taken as one open piece: a run of them across the seam of a contour, or of two pieces, needs an end on one side only.
        let count = lies.len();
        hide_points(
            &mut lies[..],
            (count, false),
            |lies, i| lies[i],
            |lies, i| {
                lies[i] = Lies::BeyondEnd;
                sum -= most.elsewhere - most.beyond_end;
                unknown += 1;
            },
        );
        // Points that all lie beyond ends would fit anywhere.
        let are_enough = (points.len() - unknown) as f64 >= tuning::FEWEST_ON_OUTLINE * points.len() as f64;
        if are_enough { sum / points.len() as f64 } else { f64::INFINITY }
    }
}

/// Mean distances of points from the outline in several poses, as their scores are.
pub(super) fn distances_in(
    track: &Track,
    points: &[Point2<f64>],
    poses: impl Iterator<Item = Matrix3<f64>>,
) -> Vec<f64> {
    let mut numbers = vec![0; points.len()];
    poses.map(|pose| mean_distance(track, points, &pose, &mut numbers)).collect()
}

/// Mean distance of points from the cells of the outline in a pose, those far off as if they were [`tuning::FARTHEST`] away. Where the outline has
/// ends, points may lie in its gaps: beyond an end they count a little more than points on it, elsewhere some times as much. `numbers` has room
/// for one of each point.
fn mean_distance(track: &Track, points: &[Point2<f64>], pose: &Matrix3<f64>, numbers: &mut [u32]) -> f64 {
    let View { map, belief, noise } = track.view();
    let Some(inverse) = pose.try_inverse() else { return f64::INFINITY };
    if points.is_empty() || map.cells().is_empty() {
        return f64::INFINITY;
    }
    let seen = Seen { points, inverse: &inverse, map, offsets: &belief.offsets };
    let of_point = noise.sigma.hypot(tuning::FROM_CENTRE * map.spacing());
    let most = MostDistance {
        beyond_end: tuning::BEYOND_END * of_point,
        elsewhere: if map.has_ends() { tuning::FARTHEST.min(tuning::IN_GAP * of_point) } else { tuning::FARTHEST },
    };
    vectorised(
        #[inline(always)]
        || {
            if is_affine(&inverse) {
                seen.mean_distance::<true>(most, numbers)
            } else {
                seen.mean_distance::<false>(most, numbers)
            }
        },
    )
}
