//! How badly a pose explains a frame, for comparison with other poses.
use freeform_riccati::{is_affine, map_point_by};
use nalgebra::{Matrix3, Point2};

use super::{Frame, Pass, Piece, PointOnCell, View};
use crate::{
    map::median,
    tuning::{likelihood as tuning, measurement::MEDIAN_TO_DEVIATION},
    vectors::vectorised,
};

/// Twice the negative logarithm of a likelihood, but for a constant, and how much chance there is in it.
#[derive(Debug, Clone, Copy, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct NegativeLogLikelihood {
    pub(crate) squares: f64,
    /// What the path adds to that: how far poses were from where they had been expected.
    pub(crate) of_path: f64,
    points: f64,
    /// Number of points, with a larger weight for points with correlated errors.
    weighted: f64,
}

impl NegativeLogLikelihood {
    /// Whether the difference is more than what noise makes of two poses that are wrong alike, or right alike: a test of models of which
    /// neither holds the other (Q. Vuong 1989, Likelihood ratio tests for model selection and non-nested hypotheses), the variance taken
    /// from the noise. Noise is what the other leaves, if that is more than was known of.
    pub(crate) fn is_worse_than(&self, other: &Self) -> bool {
        self.is_worse_by(tuning::SIGNIFICANT, other)
    }

    /// Whether the difference is more than so many of its deviations: see [`is_worse_than`](Self::is_worse_than).
    pub(crate) fn is_worse_by(&self, deviations: f64, other: &Self) -> bool {
        self.all() - other.all() > deviations * other.mean_square() * Self::deviation(other.weighted)
    }

    /// Whether the difference is more than so many squares of the noise: a test of models of which the other has a parameter more
    /// (S. S. Wilks 1938, The large-sample distribution of the likelihood ratio for testing composite hypotheses), told by few of the points.
    pub(crate) fn is_worse_by_fit(&self, squares: f64, other: &Self) -> bool {
        self.all() - other.all() > squares * (other.mean_square() * (other.weighted / other.points).max(1.0))
    }

    /// That of the points alone, whatever the path.
    pub(crate) fn of_points(self) -> Self {
        Self { of_path: 0.0, ..self }
    }

    /// Of the difference of squares between two poses, for so many points that count for one each.
    fn deviation(weighted: f64) -> f64 {
        (tuning::VARIANCE * weighted).sqrt()
    }

    /// Mean square of the innovations, which is noise at least.
    fn mean_square(&self) -> f64 {
        (self.squares / self.points).max(1.0)
    }

    /// Of points and path.
    pub(crate) fn all(&self) -> f64 {
        self.squares + self.of_path
    }

    /// Whether the mean square of the innovations is no more than so many times that of another, which is noise at least.
    pub(crate) fn is_within(&self, times: f64, other: &Self) -> bool {
        self.mean_square_over(other) <= times
    }

    /// Mean square of the innovations over that of another, which is noise at least; infinite where there are no points.
    pub(crate) fn mean_square_over(&self, other: &Self) -> f64 {
        if self.points > 0.0 { self.squares / self.points / other.mean_square() } else { f64::INFINITY }
    }

    /// The difference of squares that is significant between two poses, for so many points that count for one each: see
    /// [`is_worse_than`](Self::is_worse_than).
    pub(crate) fn significant(weighted: f64) -> f64 {
        tuning::SIGNIFICANT * Self::deviation(weighted)
    }

    /// Keeps a share of what has been added, and adds another.
    pub(crate) fn add_to_faded(&mut self, kept: f64, other: &Self) {
        for number in [&mut self.squares, &mut self.of_path, &mut self.points, &mut self.weighted] {
            *number *= kept;
        }
        self.add(other);
    }

    pub(crate) fn add(&mut self, other: &Self) {
        self.squares += other.squares;
        self.of_path += other.of_path;
        self.points += other.points;
        self.weighted += other.weighted;
    }
}

impl View<'_> {
    /// Smallest noise that poses are compared by.
    pub(crate) fn comparable_noise(&self) -> f64 {
        self.noise.sigma.max(tuning::CELL_ERROR * self.map.spacing())
    }

    /// Of the points as they have been measured, before the information of their frame has been taken; in the pose and motion found, which are so
    /// far from where they were expected. What was known of the outline is what was known of it in that pose: an offset that was seen from a pose
    /// which is corrected now moves with it.
    pub(crate) fn negative_log_likelihood(&self, frame: &mut Frame, state: &[f64]) -> NegativeLogLikelihood {
        let mut shifts = std::mem::take(&mut frame.values);
        let expected = self.belief.information.cells.expected_with(state);
        shifts.clear();
        shifts.extend(frame.shifts.iter().zip(expected).map(|(shift, expected)| shift - expected));
        let mut sums = Sums::by_scale(self.comparable_noise());
        self.for_each_innovation(frame, &shifts, |innovation| sums.add(innovation));
        frame.values = shifts;
        sums.likelihood(self.noise.correlation())
    }

    /// Of the loaded points in several poses. Where the map leaves more than the noise in the best of them, as one of few points does,
    /// that is what they are compared by.
    pub(crate) fn negative_log_likelihoods(
        &self,
        frame: &mut Frame,
        poses: &[Matrix3<f64>],
    ) -> Vec<NegativeLogLikelihood> {
        let all: Vec<_> = poses.iter().map(|pose| self.innovations_in(frame, pose)).collect();
        self.of_all(&all.iter().collect::<Vec<_>>())
    }

    /// Innovations of the loaded points in a pose.
    fn innovations_in(&self, frame: &mut Frame, pose: &Matrix3<f64>) -> Innovations {
        frame.clear_shifts(self.map.cells().len());
        self.measure_by_columns(frame, pose, &[], Pass::First);
        let mut of_points = Vec::with_capacity(frame.points.len());
        self.for_each_innovation(frame, &frame.shifts, |innovation| of_points.push(innovation));
        let mut sizes: Vec<f64> = of_points.iter().flatten().map(|innovation| innovation.abs()).collect();
        let scale = median(&mut sizes).map_or(f64::INFINITY, |m| MEDIAN_TO_DEVIATION * m);
        Innovations { of_points, scale }
    }

    /// Of innovations in several poses, by what the best of them leaves.
    fn of_all(&self, all: &[&Innovations]) -> Vec<NegativeLogLikelihood> {
        let scale = all.iter().map(|innovations| innovations.scale).fold(f64::INFINITY, f64::min);
        let scale = if scale.is_finite() { scale.max(self.comparable_noise()) } else { self.comparable_noise() };
        let correlation = self.noise.correlation();
        all.iter().map(|list| Sums::of(&list.of_points, scale).likelihood(correlation)).collect()
    }

    /// What other poses are compared with, of the loaded points.
    pub(crate) fn look_at_first(&self, frame: &mut Frame, pose: &Matrix3<f64>) -> FirstPose {
        let look = FirstLook::at(frame);
        let mut numbers = vec![0; look.points.len()];
        let mean_square = self.rough_mean_square(&look, pose, f64::INFINITY, &mut numbers);
        FirstPose { look, mean_square, innovations: self.innovations_in(frame, pose) }
    }

    /// As [`negative_log_likelihoods`](Self::negative_log_likelihoods), of one pose alone.
    pub(crate) fn negative_log_likelihood_of_first(&self, first: &FirstPose) -> NegativeLogLikelihood {
        self.of_all(&[&first.innovations])[0]
    }

    /// As [`negative_log_likelihoods`](Self::negative_log_likelihoods), of a pose and those that are compared with it, of the points that it has been
    /// looked at by. What a first look finds so many times worse than that, which is most of many poses, is not measured: its squares are those of
    /// the first look.
    pub(crate) fn negative_log_likelihoods_beside_first(
        &self,
        frame: &mut Frame,
        first: &FirstPose,
        others: &[Matrix3<f64>],
        far_worse: f64,
    ) -> Vec<NegativeLogLikelihood> {
        let mut numbers = vec![0; first.look.points.len()];
        let limit = far_worse * first.mean_square.max(1.0);
        let rough_in = |pose| self.rough_mean_square(&first.look, pose, limit, &mut numbers);
        let rough: Vec<_> = others.iter().map(rough_in).collect();
        let near = others.iter().zip(&rough).filter(|(_, square)| **square <= limit);
        let near: Vec<_> = near.map(|(pose, _)| self.innovations_in(frame, pose)).collect();
        let all: Vec<_> = std::iter::once(&first.innovations).chain(&near).collect();
        let mut measured = self.of_all(&all).into_iter();
        let Some(of_first) = measured.next() else { return Vec::new() };
        let far = |square: f64| NegativeLogLikelihood { squares: square * of_first.points, ..of_first };
        let others = rough
            .into_iter()
            .map(|square| if square > limit { far(square) } else { measured.next().unwrap_or_else(|| far(square)) });
        std::iter::once(of_first).chain(others).collect()
    }

    /// Mean square of the distances of points from the cells nearest to them in a pose, in units of the noise: all of it up to a
    /// limit, and what is beyond that where some of the points say so. `numbers` has room for one of each.
    fn rough_mean_square(&self, look: &FirstLook, pose: &Matrix3<f64>, limit: f64, numbers: &mut [u32]) -> f64 {
        let inverse = pose.try_inverse().unwrap_or_else(Matrix3::identity);
        let length = pose.fixed_view::<2, 2>(0, 0).determinant().abs().sqrt();
        let scale = length / self.comparable_noise();
        vectorised(
            #[inline(always)]
            || {
                if is_affine(&inverse) {
                    self.rough_mean_square_by::<true>(look, &inverse, (scale, limit), numbers)
                } else {
                    self.rough_mean_square_by::<false>(look, &inverse, (scale, limit), numbers)
                }
            },
        )
    }

    #[inline(always)]
    fn rough_mean_square_by<const AFFINE: bool>(
        &self,
        look: &FirstLook,
        inverse: &Matrix3<f64>,
        (scale, limit): (f64, f64),
        numbers: &mut [u32],
    ) -> f64 {
        let (map, offsets) = (self.map, self.belief.offsets.as_slice());
        let count = look.points.len() as f64;
        let (cells, spacing) = (map.cells(), map.spacing());
        let (mut sum, mut unknown) = (0.0, 0.0);
        let at_once = tuning::LOOKED_AT_ONCE;
        let parts = look.points.chunks(at_once).zip(look.ratios.chunks(at_once)).zip(numbers.chunks_mut(at_once));
        for ((points, ratios), numbers) in parts {
            map.associate(
                points.iter().map(
                    #[inline(always)]
                    |p| map_point_by::<AFFINE>(inverse, p),
                ),
                numbers,
            );
            for ((p, ratio), number) in points.iter().zip(ratios).zip(numbers) {
                let Some(cell) = cells.get(*number as usize) else {
                    unknown += 1.0;
                    continue;
                };
                let q = map_point_by::<AFFINE>(inverse, p);
                let from = q - cell.centre;
                // The nearest cell is one that lies beside the point, or the point is far from all of them.
                let is_beside = cell.normal.perp(&from).abs() < spacing;
                let distance = if is_beside { cell.normal.dot(&from) - offsets[*number as usize] } else { from.norm() };
                let size = scale * distance / ratio;
                sum += (size * size).min(tuning::LARGEST * tuning::LARGEST);
            }
            if sum > limit * count {
                break;
            }
        }
        (sum + of_unknown(unknown, count * self.noise.correlation())) / count
    }

    /// Visits the points one after the other, with offsets moved by these from where they were known.
    #[inline(always)]
    fn for_each_innovation(&self, frame: &Frame, shifts: &[f64], mut visit: impl FnMut(Option<f64>)) {
        let Frame { columns, deviations, pieces, .. } = frame;
        let ratios = deviations.ratios();
        // A pose in which no piece shows any of the outline explains nothing.
        let is_shown = pieces.iter().any(|piece| !self.lies_apart(frame, piece));
        let mut points = columns.points();
        for piece in pieces {
            let lies_apart = is_shown && self.lies_apart(frame, piece);
            for (i, point) in piece.range().zip(&mut points) {
                let ratio = ratios.map_or(1.0, |ratios| ratios[i]);
                visit(if lies_apart { None } else { self.innovation_of(&point, ratio, shifts) });
            }
        }
    }

    /// Whether an open piece of a contour shows nothing of an outline that has ends: it may be a part of it that has been hidden so far.
    fn lies_apart(&self, frame: &Frame, piece: &Piece) -> bool {
        self.map.has_ends() && !piece.closed && frame.columns.weights[piece.range()].iter().all(|weight| *weight == 0.0)
    }

    /// Distance of a point from the outline as it was known, as if that were exact and the point a good one; `None` where nothing was
    /// known. `ratio` is its deviation over that of a good point.
    #[inline(always)]
    fn innovation_of(&self, m: &PointOnCell, ratio: f64, shifts: &[f64]) -> Option<f64> {
        let own = self.belief.information.cells.own().get(m.cell).copied().filter(|own| *own > 0.0)?;
        let variance = ratio * ratio + m.by_offset * m.by_offset / own;
        Some((m.residual + m.by_offset * shifts[m.cell]) / variance.sqrt())
    }
}

/// Innovations of the points of a frame in a pose; none where nothing was known.
struct Innovations {
    of_points: Vec<Option<f64>>,
    /// Their deviation, by their median; infinite where there is none.
    scale: f64,
}

/// A pose that others are compared with, as points of a frame are explained by it.
pub(crate) struct FirstPose {
    look: FirstLook,
    mean_square: f64,
    innovations: Innovations,
}

/// Some of the points of a frame, and what each states of its deviation, in that of a good point.
struct FirstLook {
    points: Vec<Point2<f64>>,
    ratios: Vec<f64>,
}

impl FirstLook {
    fn at(frame: &Frame) -> Self {
        let stride = frame.points.len().div_ceil(tuning::ROUGHLY).max(1);
        let points: Vec<_> = frame.points.iter().step_by(stride).copied().collect();
        let ratios = match frame.deviations.ratios() {
            Some(ratios) => ratios.iter().step_by(stride).copied().collect(),
            None => vec![1.0; points.len()],
        };
        Self { points, ratios }
    }
}

/// Sums over the innovations of the points of a frame.
pub(super) struct Sums {
    scale: f64,
    points: f64,
    /// Squares in this scale.
    known: f64,
    unknown: f64,
}

impl Sums {
    /// Over none.
    fn by_scale(scale: f64) -> Self {
        Self { scale, points: 0.0, known: 0.0, unknown: 0.0 }
    }

    pub(super) fn of(innovations: &[Option<f64>], scale: f64) -> Self {
        let mut sums = Self::by_scale(scale);
        innovations.iter().for_each(|innovation| sums.add(*innovation));
        sums
    }

    #[inline(always)]
    fn add(&mut self, innovation: Option<f64>) {
        self.points += 1.0;
        match innovation {
            Some(innovation) => self.known += (innovation / self.scale).powi(2).min(tuning::LARGEST * tuning::LARGEST),
            None => self.unknown += 1.0,
        }
    }

    pub(super) fn likelihood(&self, correlation: f64) -> NegativeLogLikelihood {
        let Self { points, known, unknown, .. } = *self;
        let weighted = points * correlation;
        let squares = known + of_unknown(unknown, weighted);
        NegativeLogLikelihood { squares, of_path: 0.0, points, weighted }
    }
}

/// Squares that stand for so many points where nothing is known, of points that count for so many. Each counts as one on the outline does, and for
/// as much again because it need not have been hidden; but what is hidden is hidden in one piece, so that all together speak no more against a pose
/// than half of what rules it out.
fn of_unknown(unknown: f64, weighted: f64) -> f64 {
    let against = unknown * (tuning::UNKNOWN - 1.0);
    unknown + against.min(tuning::MOST_AGAINST * NegativeLogLikelihood::significant(weighted))
}

#[cfg(test)]
impl NegativeLogLikelihood {
    /// Of independent points with such a sum of squares.
    pub(crate) fn of_squares(squares: f64, points: f64) -> Self {
        Self { squares, of_path: 0.0, points, weighted: points }
    }
}

#[cfg(feature = "serde")]
impl NegativeLogLikelihood {
    /// Whether no number is NaN.
    pub(crate) fn is_valid(&self) -> bool {
        ![self.squares, self.of_path, self.points, self.weighted].iter().any(|number| number.is_nan())
    }
}
