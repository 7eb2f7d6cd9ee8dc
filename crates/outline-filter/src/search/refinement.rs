//! A pose brought onto the points of a frame from one that is near, by least squares of their distances from the outline.
use freeform_riccati::{MAX_PARAMETERS, MotionModel, ParameterVector, is_affine, map_point_by, pull_back_by};
use nalgebra::{Const, DimMin, Matrix2, Matrix3, Point2, SMatrix, SVector, Vector2};

use crate::{
    map::{NullDirection, OutlineMap, median},
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
    /// Size of the change from the pose before, shifts left out: that of the turn; where shapes may be stretched the norm of what the linear part
    /// changes.
    pub(crate) change: f64,
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

/// Point-to-line steps with Tukey weights at a scale that shrinks with the residuals, at most so many.
pub(super) fn refined(
    track: &Track,
    points: &[Point2<f64>],
    model: MotionModel,
    start: &Matrix3<f64>,
    steps: Steps,
) -> RegisteredPose {
    match model.parameter_count() {
        3 => refined_sized::<3>(track, points, model, start, steps),
        4 => refined_sized::<4>(track, points, model, start, steps),
        6 => refined_sized::<6>(track, points, model, start, steps),
        _ => refined_sized::<8>(track, points, model, start, steps),
    }
}

/// Residual of a point, infinite where it has none, and how far a unit of each parameter of the motion moves the outline there.
type Row<const K: usize> = (f64, [f64; K]);

fn refined_sized<const K: usize>(
    track: &Track,
    points: &[Point2<f64>],
    model: MotionModel,
    start: &Matrix3<f64>,
    steps: Steps,
) -> RegisteredPose
where
    Const<K>: DimMin<Const<K>, Output = Const<K>>,
{
    let View { map, belief, noise } = track.view();
    let mut pose = *start;
    let mut numbers = vec![0; points.len()];
    let mut rows: Vec<Row<K>> = vec![(0.0, [0.0; K]); points.len()];
    let mut sizes = Vec::with_capacity(points.len());
    let (mut widest, mut spread) = (steps.widest, f64::INFINITY);
    let mut shows_outline = true;
    for _ in 0..steps.most {
        let Some(inverse) = pose.try_inverse() else { break };
        let seen = Seen { points, inverse: &inverse, map, offsets: &belief.offsets };
        seen.linearise_by(model, &mut numbers, &mut rows);
        if model == belief.model {
            map.null_directions(model, &pose).iter().for_each(|direction| leave_out(direction, &mut rows));
        }
        sizes.clear();
        sizes.extend(rows.iter().map(|(residual, _)| residual.abs()).filter(|size| size.is_finite()));
        shows_outline = sizes.len() as f64 >= tuning::FEWEST_ON_OUTLINE * rows.len() as f64;
        spread = MEDIAN_TO_DEVIATION * median(&mut sizes).unwrap_or(0.0).max(noise.sigma);
        let scale = tuning::TUKEY * spread.max(widest);
        let is_narrow = widest <= spread;
        widest *= tuning::NARROWER;
        let Some(step) = weighted_step(&rows, scale) else { break };
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
    let turn = turn_of(&pose, track.body_pose());
    RegisteredPose { pose, score, spread, turn, change: turn.abs() }
}

/// Keeps steps off a direction that the outline does not show.
fn leave_out<const K: usize>(direction: &NullDirection, rows: &mut [Row<K>]) {
    for (_, row) in rows {
        let mut jacobian = [0.0; MAX_PARAMETERS];
        jacobian[..K].copy_from_slice(row);
        direction.project_out(&mut jacobian);
        row.copy_from_slice(&jacobian[..K]);
    }
}

/// The step by least squares with Tukey's weights, which are zero from `scale` on; `None` where numbers are not finite.
fn weighted_step<const K: usize>(rows: &[Row<K>], scale: f64) -> Option<SVector<f64, K>>
where
    Const<K>: DimMin<Const<K>, Output = Const<K>>,
{
    let (gram, right) = vectorised(
        #[inline(always)]
        || weighted_sums(rows, 1.0 / scale),
    );
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

/// Points as they are seen in a pose, given by its inverse, and the outline that they are brought onto.
struct Seen<'a> {
    points: &'a [Point2<f64>],
    inverse: &'a Matrix3<f64>,
    map: &'a OutlineMap,
    offsets: &'a [f64],
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

    /// Residuals of all points and their derivatives for a model.
    fn linearise_by<const K: usize>(&self, model: MotionModel, numbers: &mut [u32], rows: &mut [Row<K>]) {
        vectorised(
            #[inline(always)]
            || match (model, is_affine(self.inverse)) {
                (MotionModel::Rigid, true) => {
                    self.linearise::<true, K>(numbers, rows, |p, n| MotionModel::Rigid.normal_velocities(p, n));
                }
                (_, true) => self.linearise::<true, K>(numbers, rows, |p, n| model.normal_velocities(p, n)),
                (_, false) => self.linearise::<false, K>(numbers, rows, |p, n| model.normal_velocities(p, n)),
            },
        );
    }

    /// Those derivatives by what `velocities` tell.
    #[inline(always)]
    fn linearise<const AFFINE: bool, const K: usize>(
        &self,
        numbers: &mut [u32],
        rows: &mut [Row<K>],
        velocities: impl Fn(&Point2<f64>, &Vector2<f64>) -> ParameterVector,
    ) {
        let Self { points, inverse, map, offsets } = self;
        map.associate_all(
            points.iter().map(
                #[inline(always)]
                |p| map_point_by::<AFFINE>(inverse, p),
            ),
            numbers,
        );
        let cells = map.cells();
        for ((p, number), row) in points.iter().zip(numbers).zip(rows) {
            let q = map_point_by::<AFFINE>(inverse, p);
            let (cell, offset) = (&cells[*number as usize], offsets[*number as usize]);
            let distance = cell.normal.x * (q.x - cell.centre.x) + cell.normal.y * (q.y - cell.centre.y) - offset;
            let pulled = pull_back_by::<AFFINE>(inverse, p, &q, &cell.normal);
            let slope = 1.0 / (pulled.x * pulled.x + pulled.y * pulled.y).sqrt();
            let (residual, normal) = (distance * slope, pulled * slope);
            let along = velocities(&(p - residual * normal), &normal);
            // Beyond a known end nothing says where a point should lie.
            row.0 = if map.lies_beyond_end(*number as usize, &q) { f64::INFINITY } else { residual };
            row.1.copy_from_slice(&along[..K]);
        }
    }
}

/// Normal equations with Tukey's weights, for the inverse of their scale.
#[inline(always)]
fn weighted_sums<const K: usize>(rows: &[Row<K>], scale: f64) -> ([[f64; K]; K], [f64; K]) {
    let (mut gram, mut right) = ([[0.0; K]; K], [0.0; K]);
    for (residual, row) in rows {
        let u = residual * scale;
        let kept = 1.0 - u * u;
        // Points that do not count are left out: their rows may be no numbers, which nothing multiplied by zero takes back.
        if kept.is_nan() || kept <= 0.0 {
            continue;
        }
        let weight = kept * kept;
        for i in 0..K {
            let weighted = weight * row[i];
            right[i] += residual * weighted;
            for j in 0..K {
                gram[i][j] += weighted * row[j];
            }
        }
    }
    (gram, right)
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

/// Turn of a pose from the one before.
pub(super) fn turn_of(pose: &Matrix3<f64>, before: &Matrix3<f64>) -> f64 {
    let step = before.try_inverse().map_or_else(Matrix3::identity, |inverse| pose * inverse);
    (step[(1, 0)] - step[(0, 1)]).atan2(step[(0, 0)] + step[(1, 1)])
}

/// Size of the change from one pose to another, shifts left out.
pub(super) fn change_of(model: MotionModel, pose: &Matrix3<f64>, before: &Matrix3<f64>) -> f64 {
    if model <= MotionModel::Similarity {
        return turn_of(pose, before).abs();
    }
    let step = before.try_inverse().map_or_else(Matrix3::identity, |inverse| pose * inverse);
    (step.fixed_view::<2, 2>(0, 0) - Matrix2::identity()).norm()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_that_do_not_count_add_nothing_even_where_they_are_no_numbers() {
        let good = [(0.1, [1.0, 0.5, -0.2]), (-0.3, [0.4, 1.0, 0.7])];
        let sums = weighted_sums(&good, 1.0);
        for bad in [(f64::NAN, [1.0; 3]), (f64::INFINITY, [1.0; 3]), (2.0, [f64::NAN; 3]), (1.0, [f64::INFINITY; 3])] {
            assert_eq!(weighted_sums(&[good[0], bad, good[1]], 1.0), sums, "{bad:?}");
        }
        assert!(sums.1.iter().all(|sum| *sum != 0.0), "{sums:?}");
    }
}
