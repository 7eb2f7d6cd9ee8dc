//! How far a frame has moved the outline as a whole.
use freeform_riccati::MAX_PARAMETERS;
use nalgebra::{SMatrix, SVector};

use super::Track;
use crate::{measurement::Frame, tuning::map::UNSEEN_SHIFT};

impl Track {
    /// The motion of the body frame that moves the outline as the frame just taken has moved the offsets of its cells, by least squares; what
    /// is known of a cell is its weight, so that what frames move here and there adds up to what it is all together.
    pub(super) fn common_shift(&self, frame: &Frame) -> SVector<f64, MAX_PARAMETERS> {
        self.motion_of_outline(self.belief.information.cells.own(), &frame.shifts)
    }

    /// The motion of the body frame that moves the outline as offsets of its cells have changed, by least squares with weights.
    pub(super) fn motion_of_outline(&self, weights: &[f64], moved: &[f64]) -> SVector<f64, MAX_PARAMETERS> {
        let (model, k) = (self.belief.model, self.belief.parameter_count());
        let (mut squares, mut right) =
            (SMatrix::<f64, MAX_PARAMETERS, MAX_PARAMETERS>::zeros(), SVector::<f64, MAX_PARAMETERS>::zeros());
        for ((cell, weight), moved) in self.map.cells().iter().zip(weights).zip(moved) {
            let h = model.normal_velocities(&cell.centre, &cell.normal);
            for i in 0..k {
                right[i] += weight * h[i] * moved;
                (0..k).for_each(|j| squares[(i, j)] += weight * h[i] * h[j]);
            }
        }
        let largest = (0..k).map(|i| squares[(i, i)]).fold(f64::MIN_POSITIVE, f64::max);
        (0..MAX_PARAMETERS).for_each(|i| squares[(i, i)] += if i < k { UNSEEN_SHIFT * largest } else { 1.0 });
        squares.lu().solve(&right).unwrap_or_else(SVector::zeros)
    }
}
