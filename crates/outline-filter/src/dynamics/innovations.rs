//! Standardised innovations over time: how much wider than the model's an error of the estimate is.
//!
//! If points have independent errors, innovations are white with unit variance. Errors that are smooth along the contour or slow in time
//! make them larger, or dependent. The variance of a weighted mean of a stationary series is its long-run variance, over the number of
//! its members; it is estimated by prewhitening and equal-weighted cosines (E. Lazarus, D. Lewis, J. Stock and M. Watson, HAR inference:
//! Recommendations for practice, 2018).
use std::ops::Range;

use nalgebra::SVector;

use crate::tuning::innovations as tuning;
#[cfg(feature = "serde")]
use freeform_estimate::StateFormat;

/// Sums over frames of standardised innovations, in constant memory: means over blocks of frames that double.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct InnovationSeries<const N: usize> {
    frames: usize,
    last: SVector<f64, N>,
    squares: SVector<f64, N>,
    /// Products of neighbours in time.
    products: SVector<f64, N>,
    /// Sums over blocks.
    blocks: Vec<SVector<f64, N>>,
    /// Frames of each block, and in the last one.
    length: usize,
    filled: usize,
}

impl<const N: usize> Default for InnovationSeries<N> {
    fn default() -> Self {
        Self {
            frames: 0,
            last: SVector::zeros(),
            squares: SVector::zeros(),
            products: SVector::zeros(),
            blocks: Vec::with_capacity(tuning::BLOCKS),
            length: 1,
            filled: 0,
        }
    }
}

impl<const N: usize> InnovationSeries<N> {
    /// Adds the innovation of a frame, in its standard deviations.
    pub(crate) fn add(&mut self, innovation: &SVector<f64, N>, k: usize) {
        let e = innovation.map(|e| e.clamp(-tuning::CLIPPED, tuning::CLIPPED));
        for j in 0..k.min(N) {
            self.squares[j] += e[j] * e[j];
            self.products[j] += e[j] * self.last[j];
        }
        self.last = e;
        self.frames += 1;
        if self.filled == self.length || self.blocks.is_empty() {
            if self.blocks.len() == tuning::BLOCKS {
                for i in 0..tuning::BLOCKS / 2 {
                    self.blocks[i] = self.blocks[2 * i] + self.blocks[2 * i + 1];
                }
                self.blocks.truncate(tuning::BLOCKS / 2);
                self.length *= 2;
            }
            // A copy has no room for more.
            self.blocks.reserve_exact(tuning::BLOCKS - self.blocks.len());
            self.blocks.push(SVector::zeros());
            self.filled = 0;
        }
        if let Some(block) = self.blocks.last_mut() {
            *block += e;
        }
        self.filled += 1;
    }

    /// Frames taken.
    pub(crate) fn frames(&self) -> usize {
        self.frames
    }

    /// Factors, at least 1, by which the deviations of k parameters about the centroid are to be widened.
    pub(crate) fn spread(&self, k: usize) -> SVector<f64, N> {
        let mut factors = SVector::from_element(1.0);
        let n = self.frames as f64;
        if self.frames >= tuning::FEWEST_FRAMES {
            let correlation = self.correlation(k);
            let is_dependent = self.is_dependent(correlation, k);
            let long_run = is_dependent.then(|| self.long_run_variances(correlation, 1));
            for j in 0..k {
                let variance = (tuning::PRIOR_FRAMES + self.squares[j]) / (tuning::PRIOR_FRAMES + n);
                let mut factor = variance.sqrt();
                if let Some(long_run) = &long_run {
                    factor = factor.max(tuning::STUDENT * long_run[j].sqrt());
                }
                factors[j] = factor.max(1.0);
            }
        }
        factors
    }

    /// Mean square of one component.
    pub(crate) fn mean_square(&self, j: usize) -> f64 {
        if self.frames > 0 { self.squares[j] / self.frames as f64 } else { 0.0 }
    }

    /// How much larger the variance of the mean of each component is than that of independent frames, at least 1. What drifts is in the
    /// mean and in the first cosines, which are left out.
    pub(crate) fn dependence(&self) -> SVector<f64, N> {
        let count = self.blocks.len();
        let none = SVector::from_element(1.0);
        if self.frames < tuning::FEWEST_CORRELATED || count <= tuning::SLOW {
            return none;
        }
        let drift = self.slow_squares(0..0) / self.frames as f64;
        let squares: f64 = (0..N).map(|i| (self.squares[i] - drift[i]).max(0.0)).sum();
        let correlation = if squares > 0.0 { (self.products - drift).sum() / squares } else { 0.0 };
        if !self.is_dependent(correlation, N) {
            return none;
        }
        let long_run = self.long_run_variances(correlation, tuning::SLOW + 1);
        long_run.map(|variance| (tuning::STUDENT.powi(2) * variance).max(1.0))
    }

    /// Squares of the sums of the components, and of their first cosines; some of the blocks left out.
    fn slow_squares(&self, left_out: Range<usize>) -> SVector<f64, N> {
        let blocks = || {
            let of_block = |(i, block): (usize, &SVector<f64, N>)| {
                if left_out.contains(&i) { SVector::zeros() } else { *block }
            };
            self.blocks.iter().enumerate().map(of_block)
        };
        let mean: SVector<f64, N> = blocks().sum();
        let slow = cosine_projections(blocks(), self.blocks.len(), 1);
        let squares = slow[..tuning::SLOW].iter().map(|p| 2.0 * p.component_mul(p));
        squares.fold(mean.component_mul(&mean), |sum, square| sum + square)
    }

    /// Variance of each component that is white, or changes fast besides changing slowly: half of the mean square of its changes from frame to frame
    /// (J. von Neumann, Distribution of the ratio of the mean square successive difference to the variance, 1941).
    pub(crate) fn fast_variance(&self) -> SVector<f64, N> {
        (self.squares - self.products).map(|sum| sum.max(0.0) / self.frames.max(1) as f64)
    }

    /// How much larger the slow part of each component is than that of a white series of a variance, in deviations: of the sum of the
    /// squares of its mean and first cosines, by Fisher's approximation of the chi-square distribution.
    pub(crate) fn slow_part(&self, variance: &SVector<f64, N>) -> SVector<f64, N> {
        self.slow_part_without(0..0, variance)
    }

    /// As [`slow_part`](Self::slow_part), were any one stretch as the others are: what follows from a map that was learnt in wrong poses, before
    /// the motion was known or after a sudden change of it, is in one alone.
    pub(crate) fn lasting_slow_part(&self, variance: &SVector<f64, N>) -> SVector<f64, N> {
        let count = self.blocks.len();
        let stretch = count.div_ceil(tuning::STRETCHES).max(1);
        let stretches = (0..count).step_by(stretch).map(|from| from..(from + stretch).min(count));
        let without = stretches.map(|stretch| self.slow_part_without(stretch, variance));
        without.fold(self.slow_part(variance), |least, part| least.inf(&part))
    }

    fn slow_part_without(&self, left_out: Range<usize>, variance: &SVector<f64, N>) -> SVector<f64, N> {
        let count = self.blocks.len();
        if self.frames < tuning::FEWEST_CORRELATED || count <= tuning::SLOW {
            return SVector::zeros();
        }
        let by_chance = (2.0 * (tuning::SLOW + 1) as f64 - 1.0).sqrt();
        let kept = 1.0 - left_out.len() as f64 / count as f64;
        let frames = self.frames as f64;
        // Were the stretch as the others are, sums over all frames would be those over the kept ones divided by the share of these, and their squares
        // by its square.
        let squares = self.slow_squares(left_out) / (kept * kept * frames);
        squares.zip_map(variance, |sum, variance| (2.0 * sum / variance).sqrt() - by_chance)
    }

    /// Correlation of neighbours in time, over k components.
    fn correlation(&self, k: usize) -> f64 {
        let (squares, products): (f64, f64) =
            (0..k).fold((0.0, 0.0), |(s, p), j| (s + self.squares[j], p + self.products[j]));
        if squares > 0.0 { products / squares } else { 0.0 }
    }

    fn is_dependent(&self, correlation: f64, k: usize) -> bool {
        let deviation = 1.0 / (k as f64 * self.frames as f64).sqrt();
        self.frames >= tuning::FEWEST_CORRELATED && correlation > tuning::CORRELATED * deviation
    }

    /// Long-run variance of each component, by prewhitening with a correlation of neighbours and cosines from a `first` one on.
    fn long_run_variances(&self, correlation: f64, first: usize) -> SVector<f64, N> {
        let n = self.frames as f64;
        let rho = correlation.clamp(0.0, tuning::LARGEST_CORRELATION);
        let corrected = (rho + (1.0 + 3.0 * rho) / n).min(tuning::LARGEST_CORRELATION);
        // Over blocks of L frames the correlation of neighbours is rho^L.
        let count = self.blocks.len();
        let of_block = rho.powi(self.length as i32);
        let whitened =
            (0..count).map(|t| if t > 0 { self.blocks[t] - of_block * self.blocks[t - 1] } else { self.blocks[t] });
        let cosines = tuning::COSINES.min(count.saturating_sub(first)).max(1);
        let projected = cosine_projections(whitened, count, first);
        let squares = projected[..cosines].iter().map(|p| 2.0 * p.component_mul(p) / count as f64);
        let sum = squares.fold(SVector::zeros(), |sum: SVector<f64, N>, square| sum + square);
        // Sums over blocks have the variance of so many frames.
        let per_frame = sum / (cosines as f64 * self.length as f64);
        let recoloured = 1.0 - corrected.powi(self.length as i32);
        per_frame / (recoloured * recoloured)
    }
}

/// Projections of so many terms onto cosines of whole half waves, from a `first` number of them on, at least 1.
fn cosine_projections<const N: usize>(
    terms: impl Iterator<Item = SVector<f64, N>>,
    count: usize,
    first: usize,
) -> [SVector<f64, N>; tuning::COSINES] {
    let mut projected = [SVector::zeros(); tuning::COSINES];
    for (t, x) in terms.enumerate() {
        // cos((c + 1) u) = 2 cos(u) cos(c u) - cos((c - 1) u)
        let step = (std::f64::consts::PI * (t as f64 + 0.5) / count as f64).cos();
        let (mut before, mut cosine) = (1.0, step);
        for _ in 1..first {
            (before, cosine) = (cosine, 2.0 * step * cosine - before);
        }
        for sum in &mut projected {
            *sum += x * cosine;
            (before, cosine) = (cosine, 2.0 * step * cosine - before);
        }
    }
    projected
}

#[cfg(feature = "serde")]
impl<const N: usize> InnovationSeries<N> {
    /// Whether the blocks are those of so many frames; numbers that are not finite say nothing.
    pub(super) fn is_valid(&self) -> bool {
        let Self { frames, blocks, length, filled, .. } = self;
        let full = blocks.len().saturating_sub(1);
        let counted = full.checked_mul(*length).and_then(|before| before.checked_add(*filled));
        blocks.len() <= tuning::BLOCKS
            && *frames < StateFormat::MOST_COUNTED
            && length.is_power_of_two()
            && *length < StateFormat::MOST_COUNTED
            && filled <= length
            && counted == Some(*frames)
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng as _;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution as _, StandardNormal};

    use super::*;
    use nalgebra::SVector;

    /// Factors for autoregressive series of unit variance, over many runs: their root mean square.
    fn factor(correlation: f64, frames: usize) -> f64 {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let runs = 200;
        let mut sum = 0.0;
        for _ in 0..runs {
            let mut series = InnovationSeries::<3>::default();
            let mut x = SVector::<f64, 3>::from_fn(|_, _| normal());
            for _ in 0..frames {
                x = correlation * x
                    + (1.0 - correlation * correlation).sqrt() * SVector::<f64, 3>::from_fn(|_, _| normal());
                series.add(&x, 3);
            }
            sum += series.spread(3)[0].powi(2);
        }
        (sum / f64::from(runs)).sqrt()
    }

    #[test]
    fn white_innovations_hardly_widen_deviations() {
        for frames in [30, 120, 500] {
            let factor = factor(0.0, frames);
            assert!((1.0..1.12).contains(&factor), "{frames}: {factor}");
        }
    }

    #[test]
    fn slow_innovations_widen_deviations_as_their_long_run_variance_does() {
        for (correlation, frames) in [(0.5, 200), (0.9, 200), (0.9, 1000)] {
            let expected = ((1.0 + correlation) / (1.0_f64 - correlation)).sqrt();
            let found = factor(correlation, frames);
            assert!((0.8..2.0).contains(&(found / expected)), "{correlation} {frames}: {found} {expected}");
        }
    }

    #[test]
    fn a_slow_part_lasts_that_is_not_in_one_stretch_alone() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        for (shown_in, lasts) in [(0..120, true), (0..15, false), (60..75, false), (0..0, false)] {
            let mut series = InnovationSeries::<1>::default();
            let size = if shown_in.len() > 60 { 1.2 } else { 4.0 };
            for t in 0..120 {
                let noise: f64 = StandardNormal.sample(&mut rng);
                let slow = if shown_in.contains(&t) { size * (0.05 * f64::from(t)).cos() } else { 0.0 };
                series.add(&SVector::from([noise + slow]), 1);
            }
            let unit = SVector::from([1.0]);
            let [slow, lasting] = [series.slow_part(&unit)[0], series.lasting_slow_part(&unit)[0]];
            assert_eq!(slow > 5.0, !shown_in.is_empty(), "{shown_in:?}: {slow}");
            assert_eq!(lasting > 5.0, lasts, "{shown_in:?}: {lasting}");
            assert!((0.6..1.6).contains(&series.fast_variance()[0]), "{shown_in:?}: {}", series.fast_variance());
        }
    }
}
