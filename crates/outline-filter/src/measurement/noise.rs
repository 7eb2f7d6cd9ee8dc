//! Noise of the points: how much there is, whether it is correlated along the contour, and how much more of it corners have.
use std::f64::consts::{PI, SQRT_2};

#[cfg(feature = "serde")]
use freeform_estimate::StateFormat;

use super::{
    Columns, Frame, PlaceOnLattice,
    correlation::{Correlation, ShownCorrelation},
    variance_inflation::VarianceInflation,
};
use crate::{
    map::{median, median_about},
    tuning::{measurement::MEDIAN_TO_DEVIATION, noise as tuning, statement::ROUNDING},
    vectors::vectorised,
};

/// Whether a frame may show more noise than the contour of the first, none having been compared yet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum Tolerance {
    /// No more than by comparison with frames seen.
    Known,
    /// The contour of one frame may hide errors that are smooth along it and change from frame to frame.
    Relaxed,
}

/// Whether points have counted by deviations of their own, so that some cells may be known far less than by one good point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum Counted {
    Alike,
    ByDeviation,
}

/// Where frames that have been compared show the object. In one place errors that stay there, of pixels or of the ground beside an edge, are the same
/// in all of them, and pass for the outline.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
enum SeenIn {
    OnePlace,
    SeveralPlaces,
}

/// Deviation of the noise on the points, normalised, and what goes with it.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct NoiseModel {
    pub(crate) sigma: f64,
    /// Frames that its estimate is worth.
    weight: f64,
    /// What bent cells alone would leave of the residuals, or the rounding of the points.
    floor: f64,
    rounding: Rounding,
    pub(crate) tolerance: Tolerance,
    pub(crate) counted: Counted,
    seen_in: SeenIn,
    level: NoiseLevel,
    correlation: Correlation,
    /// Of each cell.
    inflation: Vec<VarianceInflation>,
}

/// What points are off that were rounded to pixels, or interpolated between them. Where the object does not move it is the same in all frames,
/// and does not show.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Rounding {
    /// Size of a pixel, normalised.
    pixel: f64,
    /// How large the errors are in units of those of a mask.
    share: f64,
    /// Points beside each other that are off together, at least 1.
    shared_by: f64,
}

impl Rounding {
    pub(crate) const NONE: Self = Self { pixel: 0.0, share: 0.0, shared_by: 1.0 };

    /// Of an outline of masks whose pixels have a size, normalised as the length of the outline is.
    pub(crate) fn of_mask(pixel: f64, (length, points): (f64, usize)) -> Self {
        Self::with_share(pixel, 1.0, (length, points))
    }

    /// Of points on a lattice of pixels that scatter by `scatter` about their smoothed contour; lengths are normalised.
    pub(crate) fn on_lattice(pixel: f64, place: PlaceOnLattice, scatter: f64, (length, points): (f64, usize)) -> Self {
        let scatter = scatter / pixel;
        let share = match place {
            PlaceOnLattice::Chain | PlaceOnLattice::LinesOfMask => 1.0,
            // Noise before the rounding makes its errors noise as well: the mean of a rounded Gaussian number (B. Widrow and I. Kollar,
            // Quantization Noise, 2008).
            PlaceOnLattice::Nodes => (-2.0 * (PI * scatter).powi(2) + 2.0 * (PI * ROUNDING).powi(2)).min(0.0).exp(),
            // How ragged a contour is that was smoothed or interpolated tells what it keeps of the pixels.
            PlaceOnLattice::Lines => (scatter / tuning::RAGGED_MASK).clamp(tuning::INTERPOLATED, 1.0),
        };
        Self::with_share(pixel, share, (length, points))
    }

    fn with_share(pixel: f64, share: f64, (length, points): (f64, usize)) -> Self {
        let together = tuning::ROUNDED_TOGETHER * points as f64 / (length / pixel).max(1.0);
        Self { pixel, share, shared_by: 1.0 + (together - 1.0).max(0.0) * share * share }
    }

    /// Size of a pixel, normalised; 0 where points are not rounded.
    pub(crate) fn pixel(&self) -> f64 {
        self.pixel
    }

    /// Deviation of a point, normalised.
    pub(crate) fn of_point(&self) -> f64 {
        tuning::ROUNDED_POINT * self.share * self.pixel
    }

    /// Deviation of a side along the rows or columns, whose points are off together, normalised.
    pub(crate) fn of_side(&self) -> f64 {
        ROUNDING * self.share * self.pixel
    }

    /// Deviation of the place of such a side in one frame from that in another: an object that hardly moves shows the same pixels for a while, and
    /// then whole sides go on by a pixel at once, or by what is left of it.
    fn of_step(&self) -> f64 {
        SQRT_2 * self.of_side()
    }
}

/// Spread of the last frames, good ones and bad ones.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct NoiseLevel {
    frames: [f64; tuning::FRAMES],
    count: usize,
}

impl NoiseLevel {
    const NONE: Self = Self { frames: [0.0; tuning::FRAMES], count: 0 };
}

impl NoiseModel {
    /// Of contours with noise of deviation `sigma`, cut into cells with a sagitta and a spacing.
    pub(crate) fn new(sigma: f64) -> Self {
        Self {
            sigma,
            weight: tuning::FIRST_WEIGHT,
            floor: tuning::SMALLEST,
            rounding: Rounding::NONE,
            tolerance: Tolerance::Known,
            counted: Counted::Alike,
            seen_in: SeenIn::OnePlace,
            level: NoiseLevel::NONE,
            correlation: Correlation::NONE,
            inflation: Vec::new(),
        }
    }

    /// Sets a floor of the noise for what straight cells leave of a bent outline.
    pub(crate) fn allow_for_cells(&mut self, sagitta: f64, spacing: f64) {
        self.floor = self.floor.max(tuning::SAGITTA_LEFT * sagitta).max(tuning::CELL_ERROR * spacing);
        self.sigma = self.sigma.max(2.0 * tuning::SAGITTA_LEFT * sagitta).max(self.floor);
    }

    /// Sets a floor of the noise for the rounding of points to pixels.
    pub(crate) fn allow_for_rounding(&mut self, rounding: Rounding) {
        self.rounding = rounding;
        self.floor = self.floor.max(rounding.of_point());
        self.sigma = self.sigma.max(self.floor);
    }

    pub(crate) fn rounding(&self) -> Rounding {
        self.rounding
    }

    /// Adopts what frames have shown so far from another model.
    pub(crate) fn adopt_level_of(&mut self, other: &Self) {
        (self.level, self.correlation, self.tolerance) = (other.level, other.correlation, other.tolerance);
        (self.counted, self.seen_in) = (other.counted, other.seen_in);
    }

    /// Whether several frames have been compared, and show the object in one place.
    fn is_of_rest(&self) -> bool {
        self.is_seen_in_one_place() && self.weight > tuning::RESTED
    }

    /// Whether all frames that have been compared show the object in one place.
    pub(crate) fn is_seen_in_one_place(&self) -> bool {
        self.seen_in == SeenIn::OnePlace
    }

    /// Takes the object to be seen in another place than where it was. What frames say that show it at rest counts for one then, as they are alike.
    pub(crate) fn see_elsewhere(&mut self) {
        if self.is_of_rest() {
            (self.weight, self.level) = (1.0, NoiseLevel::NONE);
        }
        self.seen_in = SeenIn::SeveralPlaces;
    }

    /// Makes room for so many cells.
    pub(crate) fn resize(&mut self, cells: usize) {
        self.inflation.resize(cells, VarianceInflation::NEW);
    }

    /// Updates the running mean by a frame's estimate of the noise, the frame counting for a share of one of good points.
    pub(crate) fn update(&mut self, sigma: f64, share: f64) {
        let weight = self.weight;
        self.sigma = (self.sigma * weight + sigma * share) / (weight + share);
        self.sigma = self.sigma.max(self.floor);
        self.weight = (weight + share).min(tuning::MEMORY);
    }

    /// Records the spread of a frame, used or not.
    pub(crate) fn record_spread(&mut self, spread: f64) {
        self.level.frames[self.level.count % tuning::FRAMES] = spread.min(tuning::LARGEST_REMEMBERED * tuning::LARGEST);
        self.level.count += 1;
    }

    /// Adds a squared residual of a cell in units of the noise of its point, which counts for a share of a good one.
    #[inline(always)]
    pub(crate) fn add_residual(&mut self, cell: usize, square: f64, share: f64) {
        self.inflation[cell].add(square, share);
    }

    /// Takes in what a frame shows of the correlation, which counts for a share of one of good points.
    pub(crate) fn update_correlation(&mut self, shown: &ShownCorrelation, share: f64) {
        self.correlation.add(shown, share);
    }

    /// Variance that the points of a cell count with, in units of that of the noise; at least 1.
    #[inline(always)]
    pub(crate) fn inflation(&self, cell: usize) -> f64 {
        self.inflation[cell].variance
    }

    /// As [`inflation`](Self::inflation), of all cells.
    #[inline(always)]
    pub(super) fn inflations(&self) -> impl ExactSizeIterator<Item = f64> {
        self.inflation.iter().map(
            #[inline(always)]
            |inflation| inflation.variance,
        )
    }

    /// Most noise that a frame may have: by comparison with what most frames have shown, once there are any, and as much as sides along the pixels go
    /// on by at once.
    pub(crate) fn tolerated(&self) -> f64 {
        self.tolerated_where(self.tolerance)
    }

    /// As [`tolerated`](Self::tolerated), with a tolerance given.
    pub(crate) fn tolerated_where(&self, tolerance: Tolerance) -> f64 {
        let known = self.sigma;
        let mut frames = self.level.frames;
        let seen = &mut frames[..self.level.count.min(tuning::FRAMES)];
        let typical = median(seen);
        let at_first = match tolerance {
            Tolerance::Relaxed => tuning::LARGEST_AT_FIRST,
            Tolerance::Known => 0.0,
        };
        let of_frames = typical.map(|typical| (tuning::LARGEST_RATIO * typical.max(known)).min(tuning::LARGEST));
        let most = of_frames.map_or(at_first, |most| if self.is_of_rest() { most.max(at_first) } else { most });
        most.max(tuning::LARGEST_RATIO * known).max(self.rounding.of_step().min(tuning::LARGEST))
    }

    /// Points that tell as much as one with independent errors would, at least 1.
    pub(crate) fn correlation(&self) -> f64 {
        self.correlation.of_residuals().max(self.rounding.shared_by)
    }

    /// As [`correlation`](Self::correlation), with what pose and offsets have taken off the residuals, and errors that reach beyond a stretch: (50b)
    /// in docs/motion-filter.md.
    pub(crate) fn stated_correlation(&self) -> f64 {
        self.correlation.ratio().max(self.correlation())
    }

    /// Whether enough frames have been seen to tell, and the errors of points beside each other have not been found to depend on each other.
    pub(crate) fn is_found_independent(&self) -> bool {
        self.correlation.is_told() && self.correlation() <= 1.0
    }

    /// Variance of the noise times the points that tell no more than one, since their errors are correlated.
    pub(crate) fn effective_variance(&self) -> f64 {
        self.sigma * self.sigma * self.correlation()
    }

    /// As [`effective_variance`](Self::effective_variance), by the best estimate of the correlation: that of what is stated, and of poses that
    /// hypotheses of dynamics are judged by.
    pub(crate) fn stated_variance(&self) -> f64 {
        self.sigma * self.sigma * self.stated_correlation()
    }
}

/// Robust deviation of all residuals, as if all points were good ones, which is expected to be `noise`; infinite where there are none.
pub(crate) fn spread(frame: &mut Frame, noise: f64) -> f64 {
    let Frame { columns, values, deviations, shifts, .. } = frame;
    let Columns { numbers, residuals, .. } = columns;
    values.resize(numbers.len(), 0.0);
    let (values, cells) = (values.as_mut_slice(), shifts.len() as u32);
    let mut known = 0;
    match deviations.ratios() {
        None => {
            let is_known = vectorised(
                #[inline(always)]
                || {
                    for (value, residual) in values.iter_mut().zip(residuals.iter()) {
                        *value = residual.abs();
                    }
                    numbers.iter().fold(true, |all, number| all & (*number < cells))
                },
            );
            if is_known {
                known = numbers.len();
            } else {
                for (i, number) in numbers.iter().enumerate() {
                    values[known] = values[i];
                    known += usize::from(*number < cells);
                }
            }
        }
        Some(ratios) => {
            for ((residual, number), ratio) in residuals.iter().zip(numbers.iter()).zip(ratios) {
                values[known] = residual.abs() / ratio;
                known += usize::from(*number < cells);
            }
        }
    }
    median_about(noise / MEDIAN_TO_DEVIATION, &mut values[..known]).map_or(f64::INFINITY, |m| MEDIAN_TO_DEVIATION * m)
}

#[cfg(feature = "serde")]
impl NoiseModel {
    /// Whether it is that of a map with so many cells, and all its numbers can be worked with.
    pub(crate) fn is_valid(&self, cells: usize) -> bool {
        let positive = |number: f64| number.is_finite() && number > 0.0;
        positive(self.sigma)
            && [self.weight, self.floor, self.rounding.pixel, self.rounding.share, self.rounding.shared_by]
                .iter()
                .all(|number| number.is_finite() && *number >= 0.0)
            && self.correlation.is_valid()
            && self.level.count < StateFormat::MOST_COUNTED
            && !self.level.frames.iter().any(|spread| spread.is_nan())
            && self.inflation.len() == cells
            && self.inflation.iter().all(VarianceInflation::is_valid)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_of_masks_may_scatter_as_sides_that_go_on_by_a_pixel_do_and_others_may_not() {
        let tolerated = |rounding: Rounding| {
            let mut noise = NoiseModel::new(1e-4);
            noise.allow_for_rounding(rounding);
            (0..9).for_each(|_| noise.record_spread(1e-4));
            noise.tolerated()
        };
        let extent = (6.0, 400);
        assert!((tolerated(Rounding::of_mask(0.02, extent)) / (0.02 * (1.0_f64 / 6.0).sqrt()) - 1.0).abs() < 0.01);
        let interpolated = Rounding::on_lattice(0.02, PlaceOnLattice::Lines, 0.0, extent);
        assert!(tolerated(interpolated) < 0.02 * 0.289);
    }

    #[test]
    fn an_object_seen_at_rest_may_scatter_more_where_it_is_looked_for_and_its_noise_is_learnt_anew_once_it_moves() {
        let mut noise = NoiseModel::new(1e-3);
        for _ in 0..20 {
            noise.update(1e-3, 1.0);
            noise.record_spread(1e-3);
        }
        let tolerates = |noise: &NoiseModel, expected: [f64; 2]| {
            let found = [Tolerance::Known, Tolerance::Relaxed].map(|tolerance| noise.tolerated_where(tolerance));
            found.iter().zip(expected).all(|(found, expected)| (found / expected - 1.0).abs() < 1e-9)
        };
        assert!(tolerates(&noise, [tuning::LARGEST_RATIO * 1e-3, tuning::LARGEST_AT_FIRST]));
        noise.see_elsewhere();
        noise.update(3e-3, 1.0);
        noise.record_spread(3e-3);
        assert!((noise.sigma / 2e-3 - 1.0).abs() < 1e-9 && tolerates(&noise, [tuning::LARGEST_RATIO * 3e-3; 2]));
        // Only once.
        (0..20).for_each(|_| noise.update(2e-3, 1.0));
        noise.see_elsewhere();
        noise.update(4e-3, 1.0);
        assert!(noise.sigma < 2.1e-3, "{}", noise.sigma);
    }

    #[test]
    fn errors_are_independent_only_once_enough_frames_have_told_so() {
        let seen = |frames: usize, ratio: f64| {
            let mut noise = NoiseModel::new(1.0);
            let shown = ShownCorrelation { residuals: ratio, near: None, far: None };
            (0..frames).for_each(|_| noise.update_correlation(&shown, 1.0));
            noise
        };
        assert!(!seen(15, 1.0).is_found_independent());
        assert!(seen(16, 1.0).is_found_independent() && seen(16, 1.1).is_found_independent());
        assert!(!seen(16, 1.2).is_found_independent() && !seen(1000, 1.1).is_found_independent());
        let mut of_mask = seen(50, 1.0);
        of_mask.allow_for_rounding(Rounding::of_mask(0.1, (6.0, 400)));
        assert!(!of_mask.is_found_independent());
    }
}
