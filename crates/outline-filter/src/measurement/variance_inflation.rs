//! Variance inflation: how much the points of a cell scatter beyond the noise, as at corners that straight cells do not follow.
use crate::tuning::noise as tuning;

/// Running mean square of a cell's residuals in units of the noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct VarianceInflation {
    mean_square: f64,
    points: f64,
    /// Variance that the points count with, in units of that of the noise; at least 1.
    pub(super) variance: f64,
}

impl VarianceInflation {
    pub(super) const NEW: Self = Self { mean_square: 1.0, points: tuning::INFLATION_PRIOR_POINTS, variance: 1.0 };

    /// Takes one squared residual in units of the noise.
    pub(super) fn take(&mut self, square: f64) {
        self.points = (self.points + 1.0).min(tuning::INFLATION_MEMORY);
        let square = square.min(tuning::INFLATION_CLIPPED * self.variance);
        let share = 1.0 / self.points;
        self.mean_square += (square - self.mean_square) * share;
        let uncertainty = (2.0 * share).sqrt();
        self.variance = (self.mean_square / (1.0 + tuning::INFLATION_SIGNIFICANT * uncertainty)).max(1.0);
    }
}
