//! How far errors depend on each other along the contour.
#[cfg(feature = "serde")]
use freeform_estimate::StateFormat;

use super::Frame;
use crate::{
    tuning::noise as tuning,
    vectors::{LANES, vectorised},
};

/// How many times the variance of a mean along the contour is what independent errors give, on average over frames.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Correlation {
    /// Of residuals as they are.
    residuals: Average,
    near: Average,
    far: Average,
}

/// A ratio on average.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Average {
    mean: f64,
    frames: f64,
    /// Variance of the ratio of one frame, if errors are independent, on average.
    variance: f64,
}

/// What a frame shows of the correlation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ShownCorrelation {
    /// How many times the variance of the mean residual over one stretch is what independent errors give, pose and offsets having taken their part.
    pub(crate) residuals: f64,
    /// The same with what pose and offsets have taken, and the variance of that if errors are independent; `None` where it cannot be told.
    pub(crate) near: Option<[f64; 2]>,
    /// The same of a stretch without end, by what two in a row show beside one.
    pub(crate) far: Option<[f64; 2]>,
}

impl Correlation {
    pub(super) const NONE: Self = {
        let average = Average { mean: 1.0, frames: 0.0, variance: 2.0 / tuning::STRETCHES as f64 };
        Self { residuals: average, near: average, far: average }
    };

    /// Takes in a frame that counts for a share of one of good points.
    pub(super) fn add(&mut self, shown: &ShownCorrelation, share: f64) {
        self.residuals.add([shown.residuals, Self::NONE.residuals.variance], share);
        for (average, shown) in [(&mut self.near, shown.near), (&mut self.far, shown.far)] {
            if let Some(shown) = shown {
                average.add(shown, share);
            }
        }
    }

    /// Points that tell as much as one with independent errors would, as far as residuals over a stretch show it beyond chance; may be below 1.
    pub(super) fn of_residuals(&self) -> f64 {
        self.residuals.mean / self.residuals.by_chance()
    }

    /// Points that tell as much as one with independent errors would, at least 1.
    pub(super) fn ratio(&self) -> f64 {
        self.near.beyond_chance().max(self.far.beyond_chance())
    }

    /// Whether enough frames have been seen to tell.
    pub(super) fn is_told(&self) -> bool {
        self.residuals.frames >= tuning::CORRELATION_TOLD
    }

    #[cfg(feature = "serde")]
    pub(super) fn is_valid(&self) -> bool {
        let is_in_bounds = |number: &f64| number.abs() <= StateFormat::LARGEST_NUMBER;
        let are_valid = |average: &Average| {
            let Average { mean, frames, variance } = average;
            is_in_bounds(mean) && is_in_bounds(variance) && is_in_bounds(frames) && *frames >= 0.0 && *variance > 0.0
        };
        [&self.residuals, &self.near, &self.far].into_iter().all(are_valid)
    }
}

impl Average {
    fn add(&mut self, [ratio, variance]: [f64; 2], share: f64) {
        if !ratio.is_finite() {
            return;
        }
        self.frames = (self.frames + share).min(tuning::CORRELATION_MEMORY);
        self.mean += (ratio - self.mean) * share / self.frames;
        self.variance += (variance - self.variance) * share / self.frames;
    }

    /// The largest ratio that chance explains.
    fn by_chance(&self) -> f64 {
        1.0 + tuning::CORRELATION_SIGNIFICANT * (self.variance / self.frames.max(1.0)).sqrt()
    }

    /// The ratio, at least 1: none that chance explains, and all of one that is as many times that as that is of 1.
    fn beyond_chance(&self) -> f64 {
        let beyond = self.mean / self.by_chance();
        if beyond <= 1.0 { 1.0 } else { (beyond * beyond).min(self.mean) }
    }
}

/// What the solution of a frame has taken off its residuals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TakenOff {
    /// Degrees of freedom by the pose.
    pub(crate) by_pose: f64,
    /// Share of the variance of a mean over a stretch that the offsets have left, above 0.
    pub(crate) left_by_offsets: f64,
}

/// What the residuals of a frame show, of deviation `noise` for a good point; `None` where it cannot be told. Stretches count by the information that
/// they have.
pub(crate) fn correlation_of(frame: &Frame, noise: Option<f64>, taken: TakenOff) -> Option<ShownCorrelation> {
    let Frame { columns, deviations, .. } = frame;
    let length = columns.len() / tuning::STRETCHES;
    let noise = noise.filter(|noise| *noise > 0.0 && length >= tuning::FEWEST_IN_STRETCH)?;
    let expected = noise * noise * taken.left_by_offsets;
    let mut totals = [Total::NONE; tuning::STRETCHES];
    let all = columns.residuals.chunks_exact(length).zip(columns.weights.chunks_exact(length));
    for ((stretch, (residuals, weights)), total) in all.enumerate().zip(&mut totals) {
        *total = match deviations.ratios() {
            None => alike(residuals, weights),
            Some(ratios) => by_deviations(residuals, weights, &ratios[stretch * length..]),
        };
    }
    let of_one = ratio_over(totals.iter().copied(), length)?;
    let residuals = of_one.0 / (noise * noise);
    let over = |ratio: (f64, f64)| left_by_pose(ratio, expected, taken.by_pose);
    let Some((near, ones)) = over(of_one).filter(|_| taken.left_by_offsets >= tuning::LEAST_LEFT) else {
        return Some(ShownCorrelation { residuals, near: None, far: None });
    };
    let pairs = totals.as_chunks::<2>().0.iter().map(|[one, next]| one.and(next));
    // The covariance of both ratios is the variance of that of single stretches. The ratio of a long stretch falls short of that of one without end by a
    // share that is inverse to its length.
    let far = ratio_over(pairs, 2 * length).and_then(over);
    let far = far.map(|(of_two, twos)| [2.0 * of_two - near, 8.0 / twos - 6.0 / ones]);
    Some(ShownCorrelation { residuals, near: Some([near, 2.0 / ones]), far })
}

/// The ratio over a number of stretches, in units of what is expected of independent errors, and the degrees of freedom that the pose has left; `None`
/// where they are less than those that it has taken.
fn left_by_pose((square, stretches): (f64, f64), expected: f64, taken: f64) -> Option<(f64, f64)> {
    let left = stretches - taken;
    (left >= taken && left > 0.0).then(|| (square / expected * stretches / left, left))
}

/// The mean over stretches of the square of the mean residual in units of what one point of a deviation of one gives; `None` where most of the
/// contour does not count. With the number of stretches that do. All have `length` points.
fn ratio_over(totals: impl Iterator<Item = Total>, length: usize) -> Option<(f64, f64)> {
    let (mut sum, mut count, mut stretches, mut all) = (0.0, 0.0, 0.0, 0.0);
    for total in totals {
        all += 1.0;
        if tuning::ONE_IN_COUNTS * total.number > length as f64 {
            sum += total.residuals * total.residuals / total.number;
            count += total.weights / total.number;
            stretches += 1.0;
        }
    }
    (tuning::ONE_IN_COUNTS * stretches > all).then(|| (sum / count, stretches))
}

/// Sums over a stretch of the contour: of residuals and of weights by the deviations that points state, and the number of points that count.
#[derive(Debug, Clone, Copy)]
struct Total {
    residuals: f64,
    weights: f64,
    number: f64,
}

impl Total {
    const NONE: Self = Self { residuals: 0.0, weights: 0.0, number: 0.0 };

    fn and(&self, next: &Self) -> Self {
        let Self { residuals, weights, number } = *next;
        Self { residuals: self.residuals + residuals, weights: self.weights + weights, number: self.number + number }
    }
}

/// Of points that state deviations, over that of a good one.
fn by_deviations(residuals: &[f64], weights: &[f64], ratios: &[f64]) -> Total {
    let mut total = Total::NONE;
    for ((residual, _), ratio) in residuals.iter().zip(weights).zip(ratios).filter(|((_, weight), _)| **weight > 0.0) {
        let weight = (ratio * ratio).recip();
        total.residuals += residual * weight;
        total.weights += weight;
        total.number += 1.0;
    }
    total
}

/// Of good points.
fn alike(residuals: &[f64], weights: &[f64]) -> Total {
    let (residuals, last_residuals) = residuals.as_chunks::<LANES>();
    let (weights, last_weights) = weights.as_chunks::<LANES>();
    let [sums, counts] = vectorised(
        #[inline(always)]
        || {
            let mut sums = [[0.0; LANES]; 2];
            for (residuals, weights) in residuals.iter().zip(weights) {
                for lane in 0..LANES {
                    let counts = if weights[lane] > 0.0 { 1.0 } else { 0.0 };
                    sums[0][lane] += counts * residuals[lane];
                    sums[1][lane] += counts;
                }
            }
            sums
        },
    );
    let mut total = Total { residuals: sums.iter().sum(), weights: 0.0, number: counts.iter().sum() };
    for (residual, _) in last_residuals.iter().zip(last_weights).filter(|(_, weight)| **weight > 0.0) {
        total.residuals += residual;
        total.number += 1.0;
    }
    total.weights = total.number;
    total
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An average over so many frames that show the same.
    fn shown(ratio: f64, frames: usize) -> Correlation {
        let mut correlation = Correlation::NONE;
        (0..frames).for_each(|_| {
            correlation.add(
                &ShownCorrelation { residuals: ratio, near: Some([ratio, 2.0 / tuning::STRETCHES as f64]), far: None },
                1.0,
            );
        });
        correlation
    }

    #[test]
    fn what_chance_explains_counts_for_nothing_and_what_is_far_beyond_it_counts_wholly() {
        let by_chance = 1.0 + tuning::CORRELATION_SIGNIFICANT * (2.0 / tuning::STRETCHES as f64).sqrt();
        assert_eq!(shown(0.99 * by_chance, 1).ratio(), 1.0);
        let [a_little, more] = [1.1, 1.2].map(|factor| shown(factor * by_chance, 1).ratio());
        assert!(1.0 < a_little && a_little < more && more < 1.2 * by_chance);
        assert_eq!(shown(by_chance * by_chance, 1).ratio(), by_chance * by_chance);
        assert!((shown(1.2, 50).ratio() - 1.2).abs() < 0.02, "more frames leave less to chance");
    }

    #[test]
    fn what_reaches_beyond_a_stretch_counts_as_well() {
        let mut correlation = Correlation::NONE;
        correlation.add(&ShownCorrelation { residuals: 7.0, near: Some([8.0, 0.1]), far: Some([30.0, 0.5]) }, 1.0);
        assert_eq!(correlation.ratio(), 30.0);
        // What is told too seldom stays what was told.
        correlation.add(&ShownCorrelation { residuals: 7.0, near: None, far: None }, 1.0);
        assert_eq!(correlation.ratio(), 30.0);
    }
}
