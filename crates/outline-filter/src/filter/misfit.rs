//! How badly a pose explains a frame, for comparison with other poses.
use nalgebra::Matrix3;

use super::{
    contour::median,
    map_update::Scratch,
    outline_map::OutlineMap,
    reading::{CELL_ERROR, NO_CELL, Reading},
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
    /// Smallest noise that poses are compared by.
    pub(crate) fn comparable_noise(&self) -> f64 {
        self.sigma.max(CELL_ERROR * self.spacing)
    }

    /// Of the points as they have been read, before the information of their frame has been taken.
    pub(crate) fn misfit(&self, scratch: &Scratch) -> Misfit {
        let scale = self.comparable_noise();
        let innovations = scratch.readings.iter().map(|r| self.innovation_of(r, &scratch.shifts));
        misfit(innovations, scale, self.noise_level.correlation())
    }

    /// Of the loaded points in several poses. Where the map leaves more than the noise in the best of them, as one of few points does,
    /// that is what they are compared by.
    pub(crate) fn misfits_in(&self, scratch: &mut Scratch, poses: &[Matrix3<f64>]) -> Vec<Misfit> {
        scratch.shifts.clear();
        scratch.shifts.resize(self.cells.len(), 0.0);
        let mut scale = f64::INFINITY;
        let mut all: Vec<Vec<Option<f64>>> = Vec::with_capacity(poses.len());
        for pose in poses {
            self.read_points(scratch, pose, &[], true);
            let list: Vec<_> = scratch.readings.iter().map(|r| self.innovation_of(r, &scratch.shifts)).collect();
            let mut sizes: Vec<f64> = list.iter().flatten().map(|innovation| innovation.abs()).collect();
            scale = scale.min(median(&mut sizes).map_or(f64::INFINITY, |m| 1.4826 * m));
            all.push(list);
        }
        let scale = if scale.is_finite() { scale.max(self.comparable_noise()) } else { self.comparable_noise() };
        let correlation = self.noise_level.correlation();
        all.into_iter().map(|list| misfit(list.into_iter(), scale, correlation)).collect()
    }

    /// Distance of a point from the outline as it was known, as if that were exact; `None` where nothing was known.
    fn innovation_of(&self, r: &Reading, shifts: &[f64]) -> Option<f64> {
        if r.cell == NO_CELL || self.information.cells[r.cell].own <= 0.0 {
            return None;
        }
        let variance = 1.0 + r.slope * r.slope / self.information.cells[r.cell].own;
        Some((r.residual + r.slope * shifts[r.cell]) / variance.sqrt())
    }
}

fn misfit(innovations: impl ExactSizeIterator<Item = Option<f64>>, scale: f64, correlation: f64) -> Misfit {
    let points = innovations.len() as f64;
    let square = |innovation: f64| (innovation / scale).powi(2).min(LARGEST * LARGEST);
    let squares = innovations.map(|innovation| innovation.map_or(UNKNOWN, square)).sum();
    Misfit { squares, points, weighted: points * correlation }
}
