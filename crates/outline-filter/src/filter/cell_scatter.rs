//! How much the points of a cell scatter beyond the noise, as at corners that straight cells do not follow.

/// Points that the assumption of the usual noise is worth.
const PRIOR_POINTS: f64 = 8.0;
/// Standard deviations of its estimate by which a scatter must be larger than the noise.
const SIGNIFICANT: f64 = 2.0;
/// Squared residual, in units of the scatter known, beyond which a point may be an outlier and counts no more than that.
const CLIPPED: f64 = 9.0;
/// Points that are remembered.
const MEMORY: f64 = 400.0;

/// Running mean square of a cell's residuals in units of the noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scatter {
    mean_square: f64,
    points: f64,
    /// Variance that the points count with, in units of that of the noise; at least 1.
    pub(crate) variance: f64,
}

impl Scatter {
    pub(crate) const NEW: Self = Self { mean_square: 1.0, points: PRIOR_POINTS, variance: 1.0 };

    /// Takes one squared residual in units of the noise.
    pub(crate) fn take(&mut self, square: f64) {
        self.points = (self.points + 1.0).min(MEMORY);
        let square = square.min(CLIPPED * self.variance);
        let share = 1.0 / self.points;
        self.mean_square += (square - self.mean_square) * share;
        let uncertainty = (2.0 * share).sqrt();
        self.variance = (self.mean_square / (1.0 + SIGNIFICANT * uncertainty)).max(1.0);
    }
}
