//! Normal equations over the motion of a plane and the offsets of its outline.
use nalgebra::DVector;

use super::scenery::{Matrix8, Vector8};
use crate::{
    measurement::{Frame, Measurement, NO_CELL},
    tuning::plane as tuning,
};

/// What the offset of one cell has to do with the motion.
#[derive(Debug, Clone, Copy)]
struct CellSums {
    coupling: Vector8,
    own: f64,
    right: f64,
}

/// Sums over points, in units of the noise: an arrowhead, dense over the motion and diagonal over the offsets. All of it is constant, so
/// that frames add up in any order.
#[derive(Debug, Clone)]
pub(super) struct Information {
    dense: Matrix8,
    right: Vector8,
    cells: Vec<CellSums>,
}

/// A solution of the normal equations.
#[derive(Debug, Clone)]
pub(super) struct Step {
    pub(super) motion: Vector8,
    pub(super) offsets: DVector<f64>,
    /// By how much the sum of squares falls.
    pub(super) fall: f64,
    /// Information on the motion with the offsets eliminated.
    pub(super) marginal: Matrix8,
}

impl Information {
    /// None, of so many cells.
    pub(super) fn none(cells: usize) -> Self {
        let cell = CellSums { coupling: Vector8::zeros(), own: 0.0, right: 0.0 };
        Self { dense: Matrix8::zeros(), right: Vector8::zeros(), cells: vec![cell; cells] }
    }

    /// Adds a frame that was measured in a pose which depends on the motion by `sensitivity`.
    pub(super) fn add(&mut self, measurements: &[Measurement], sensitivity: &Matrix8) {
        let by_motion = sensitivity.transpose();
        for m in measurements.iter().filter(|m| m.cell != NO_CELL && m.weight > 0.0) {
            let row = by_motion * Vector8::from(m.jacobian);
            self.dense.ger(m.weight, &row, &row, 1.0);
            self.right.axpy(m.weight * m.residual, &row, 1.0);
            let cell = &mut self.cells[m.cell];
            cell.coupling.axpy(m.weight * m.by_offset, &row, 1.0);
            cell.own += m.weight * m.by_offset * m.by_offset;
            cell.right += m.weight * m.by_offset * m.residual;
        }
    }

    /// Adds other sums, taken about a place that this is further on by `motion` and `offsets`.
    pub(super) fn add_about(&mut self, other: &Self, motion: &Vector8, offsets: &[f64]) {
        self.dense += other.dense;
        self.right += other.right - other.dense * motion;
        for ((cell, other), offset) in self.cells.iter_mut().zip(&other.cells).zip(offsets) {
            self.right.axpy(-offset, &other.coupling, 1.0);
            cell.coupling += other.coupling;
            cell.own += other.own;
            cell.right += other.right - other.coupling.dot(motion) - other.own * offset;
        }
    }

    /// By how much the sum of squares falls to a place that is further on by `motion` and `offsets`.
    pub(super) fn fall_to(&self, motion: &Vector8, offsets: &[f64]) -> f64 {
        let mut fall = motion.dot(&(2.0 * self.right - self.dense * motion));
        for (cell, offset) in self.cells.iter().zip(offsets) {
            fall += offset * (2.0 * (cell.right - cell.coupling.dot(motion)) - cell.own * offset);
        }
        fall
    }

    /// The least sum of squares, with a little known beforehand of the motion. `None` where there is none.
    pub(super) fn solve(&self, prior: &Vector8) -> Option<Step> {
        let (mut marginal, mut right) = (self.dense, self.right);
        let mut fall = 0.0;
        for cell in self.cells.iter().filter(|cell| cell.own > 0.0) {
            marginal.ger(-1.0 / cell.own, &cell.coupling, &cell.coupling, 1.0);
            right.axpy(-cell.right / cell.own, &cell.coupling, 1.0);
            fall += cell.right * cell.right / cell.own;
        }
        marginal = 0.5 * (marginal + marginal.transpose());
        let motion = freeform_estimate::scaled_solution(&(marginal + Matrix8::from_diagonal(prior)), &right)?;
        fall += motion.dot(&right);
        let offset = |cell: &CellSums| {
            if cell.own > 0.0 { (cell.right - cell.coupling.dot(&motion)) / cell.own } else { 0.0 }
        };
        let offsets = DVector::from_iterator(self.cells.len(), self.cells.iter().map(offset));
        let is_finite = motion.iter().chain(&offsets).all(|entry| entry.is_finite());
        is_finite.then_some(Step { motion, offsets, fall, marginal })
    }

    /// Median of the information on the offset of a cell; at least that of one point.
    pub(super) fn typical_own(&self) -> f64 {
        let mut own: Vec<f64> = self.cells.iter().map(|cell| cell.own).collect();
        crate::map::median(&mut own).unwrap_or(1.0).max(1.0)
    }

    /// Re-centres the equations at their solution: the right-hand sides become zero.
    pub(super) fn settle(&mut self) {
        self.right.fill(0.0);
        self.cells.iter_mut().for_each(|cell| cell.right = 0.0);
    }

    /// Information that a frame adds to that of its pose, the offsets being known as well as they are, and its right-hand side.
    pub(super) fn of_pose(&self, measurements: &[Measurement]) -> (Matrix8, Vector8) {
        let (mut information, mut right) = (Matrix8::zeros(), Vector8::zeros());
        let mut sums = Self::none(self.cells.len());
        sums.add(measurements, &Matrix8::identity());
        information += sums.dense;
        right += sums.right;
        for (seen, known) in sums.cells.iter().zip(&self.cells) {
            let own = seen.own + known.own;
            if seen.own > 0.0 {
                information.ger(-1.0 / own, &seen.coupling, &seen.coupling, 1.0);
                right.axpy(-seen.right / own, &seen.coupling, 1.0);
            }
        }
        (information, right)
    }
}

/// Sum of squares of the residuals of a measured frame in units of the noise of their points, those of outliers limited.
pub(super) fn squares(frame: &Frame, sigma: f64) -> f64 {
    let ratios = frame.deviations.ratios();
    let square = |(i, m): (usize, &Measurement)| {
        if m.cell == NO_CELL {
            tuning::LARGEST_SQUARE
        } else {
            (m.residual / (sigma * ratios.map_or(1.0, |ratios| ratios[i]))).powi(2).min(tuning::LARGEST_SQUARE)
        }
    };
    frame.measurements.iter().enumerate().map(square).sum()
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng as _;
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::dense_filter::random_measurements;

    const CELLS: usize = 5;

    fn sums(measurements: &[Measurement]) -> Information {
        let mut sums = Information::none(CELLS);
        sums.add(measurements, &Matrix8::identity());
        sums
    }

    #[test]
    fn sums_of_frames_that_are_no_longer_kept_say_the_same_from_anywhere() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let [old, new] = [(); 2].map(|()| random_measurements(&mut rng, 8, 0..CELLS, 60));
        let weak = Vector8::repeat(1e-12);
        let together: Vec<_> = old.iter().chain(&new).copied().collect();
        let all = sums(&together).solve(&weak).expect("a solution");
        // What is further on lies that much less off.
        let (motion, offsets) = (Vector8::from_fn(|i, _| 0.1 * i as f64 - 0.3), [0.2, -0.1, 0.0, 0.3, -0.2]);
        let moved = |m: &Measurement| Measurement {
            residual: m.residual - Vector8::from(m.jacobian).dot(&motion) - m.by_offset * offsets[m.cell],
            ..*m
        };
        let mut further = sums(&new.iter().map(moved).collect::<Vec<_>>());
        further.add_about(&sums(&old), &motion, &offsets);
        let step = further.solve(&weak).expect("a solution");
        assert!((step.motion + motion - all.motion).amax() < 1e-9, "{}", step.motion);
        for ((step, offset), all) in step.offsets.iter().zip(offsets).zip(&all.offsets) {
            assert!((step + offset - all).abs() < 1e-9);
        }
        // The sum of squares falls by as much on the way there and on, as all the way.
        let fallen = sums(&together).fall_to(&motion, &offsets) + step.fall;
        assert!((fallen - all.fall).abs() < 1e-9 * all.fall, "{fallen} {}", all.fall);
    }
}
