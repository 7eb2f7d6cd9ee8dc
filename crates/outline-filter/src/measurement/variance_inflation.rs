//! Variance inflation: how much the points of a cell scatter beyond the noise, as at corners that straight cells do not follow.
use crate::tuning::noise as tuning;

/// Running mean square of a cell's residuals in units of the noise.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct VarianceInflation {
    mean_square: f64,
    points: f64,
    /// Variance that the points count with, in units of that of the noise; at least 1.
    pub(super) variance: f64,
}

impl VarianceInflation {
    pub(super) const NEW: Self = Self { mean_square: 1.0, points: tuning::INFLATION_PRIOR_POINTS, variance: 1.0 };

    /// The share of one of so many points, and the mean square that chance hardly makes of them.
    #[inline(always)]
    fn share_and_expected(points: f64) -> [f64; 2] {
        let of_all = 1.0 / points;
        [of_all, 1.0 + tuning::INFLATION_SIGNIFICANT * (2.0 * of_all).sqrt()]
    }

    /// Adds one squared residual in units of the noise of its point, which counts for a share of a good one.
    #[inline(always)]
    pub(super) fn add(&mut self, square: f64, share: f64) {
        self.points = (self.points + share).min(tuning::INFLATION_MEMORY);
        let square = square.min(tuning::INFLATION_CLIPPED * self.variance);
        // A root and a quotient take longer than all else here. Most cells remember as many points as they may, and of those both are constants.
        let [of_all, expected] = if self.points < tuning::INFLATION_MEMORY {
            Self::share_and_expected(self.points)
        } else {
            Self::share_and_expected(tuning::INFLATION_MEMORY)
        };
        self.mean_square += (square - self.mean_square) * (share * of_all);
        // Of few cells: a quotient takes long.
        self.variance = if self.mean_square > expected { self.mean_square / expected } else { 1.0 };
    }
}

#[cfg(feature = "serde")]
impl VarianceInflation {
    /// Whether its numbers can be worked with.
    pub(super) fn is_valid(&self) -> bool {
        let of_prior = tuning::INFLATION_PRIOR_POINTS;
        self.mean_square.is_finite()
            && self.mean_square >= 0.0
            && (of_prior..=tuning::INFLATION_MEMORY.max(of_prior)).contains(&self.points)
            && self.variance.is_finite()
            && self.variance >= 1.0
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng as _;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution as _, StandardNormal};

    use super::*;

    #[test]
    fn cells_whose_points_scatter_more_than_the_noise_count_for_less_once_that_is_sure() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let mut after = |deviation: f64, points: usize| {
            let mut inflation = VarianceInflation::NEW;
            (0..points).for_each(|_| {
                let residual: f64 = StandardNormal.sample(&mut rng);
                inflation.add((deviation * residual).powi(2), 1.0);
            });
            inflation.variance
        };
        let (usual, soon, later) = (after(1.0, 400), after(3.0, 4), after(3.0, 400));
        assert!(usual < 1.1, "{usual}");
        assert!(soon < 3.0, "{soon}");
        assert!((5.0..10.0).contains(&later), "{later}");
    }
}
