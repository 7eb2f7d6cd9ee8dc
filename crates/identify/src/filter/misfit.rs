//! How badly a pose explains a frame, for comparison with other poses.
use nalgebra::Matrix3;

use super::{
    map_update::Scratch,
    outline_map::OutlineMap,
    reading::{CELL_ERROR, NO_CELL},
};

/// Residuals of more standard deviations are no worse: they may be outliers.
const LARGEST: f64 = 4.0;
/// Square that stands for a point beyond the known ends of the outline.
const UNKNOWN: f64 = 2.0;
/// Variance of the difference of a point's squared residuals from two parts of an outline: the noise of the point is in both, that of
/// the map is not (2 + 2 - 2 / 2).
const VARIANCE: f64 = 3.0;
/// Standard deviations of the difference by which one of many poses must be worse.
const SIGNIFICANT: f64 = 5.0;

/// Twice the negative logarithm of a likelihood, but for a constant, and how much chance there is in it.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Misfit {
    pub(crate) squares: f64,
    points: f64,
    /// The same, those with correlated errors counting for more.
    weighted: f64,
}

impl Misfit {
    /// Whether the difference is more than what noise makes of two poses that are wrong alike, or right alike: a test of models of which
    /// neither holds the other (Q. Vuong 1989, Likelihood ratio tests for model selection and non-nested hypotheses), the variance taken
    /// from the noise. Noise is what the other leaves, if that is more than was known of.
    pub(crate) fn is_worse_than(&self, other: &Self) -> bool {
        let unit = (other.squares / other.points).max(1.0);
        self.squares - other.squares > SIGNIFICANT * unit * (VARIANCE * other.weighted).sqrt()
    }

    pub(crate) fn add(&mut self, other: &Self) {
        self.squares += other.squares;
        self.points += other.points;
        self.weighted += other.weighted;
    }
}

impl OutlineMap {
    /// Of the points as they have been read, before the information of their frame has been taken.
    pub(crate) fn misfit(&self, scratch: &Scratch) -> Misfit {
        let scale = if self.noise_level.relaxed { self.noise_level.tolerated(self.sigma) } else { self.sigma };
        let unit = 1.0 / scale.max(CELL_ERROR * self.spacing).powi(2);
        let squares = scratch.readings.iter().map(|r| {
            if r.cell == NO_CELL || self.information.cells[r.cell].own <= 0.0 {
                return UNKNOWN;
            }
            // From the outline as it was known.
            let innovation = r.residual + r.slope * scratch.shifts[r.cell];
            let variance = 1.0 + r.slope * r.slope / self.information.cells[r.cell].own;
            (innovation * innovation * unit / variance).min(LARGEST * LARGEST)
        });
        let squares = squares.sum::<f64>();
        let points = scratch.readings.len() as f64;
        Misfit { squares, points, weighted: points * self.noise_level.correlation() }
    }

    /// Of the loaded points in a pose.
    pub(crate) fn misfit_in(&self, scratch: &mut Scratch, pose: &Matrix3<f64>) -> Misfit {
        scratch.shifts.clear();
        scratch.shifts.resize(self.cells.len(), 0.0);
        self.read_points(scratch, pose, &[], true);
        self.misfit(scratch)
    }
}
