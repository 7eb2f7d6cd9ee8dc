//! How far a frame has moved the outline as a whole.
use freeform_riccati::MAX_PARAMETERS;
use nalgebra::{SMatrix, SVector};

use super::Track;
use crate::{measurement::Frame, tuning::map::UNSEEN_SHIFT};

impl Track {
    /// The motion of the body frame that moves the cells as the frame just taken has moved their offsets, by least squares; the points of
    /// the frame on each cell are its weight. `frame` has the cells as they were.
    pub(super) fn common_shift(&self, frame: &Frame) -> SVector<f64, MAX_PARAMETERS> {
        let (model, k) = (self.belief.model, self.belief.parameter_count());
        let (mut squares, mut right) =
            (SMatrix::<f64, MAX_PARAMETERS, MAX_PARAMETERS>::zeros(), SVector::<f64, MAX_PARAMETERS>::zeros());
        let [before, after] = [&frame.cells, &self.belief.information.cells].map(|cells| cells.own());
        for (number, cell) in self.map.cells().iter().enumerate() {
            let weight = after[number] - before[number];
            if weight <= 0.0 {
                continue;
            }
            let h = model.normal_velocities(&cell.centre, &cell.normal);
            for i in 0..k {
                right[i] += weight * h[i] * frame.shifts[number];
                (0..k).for_each(|j| squares[(i, j)] += weight * h[i] * h[j]);
            }
        }
        let largest = (0..k).map(|i| squares[(i, i)]).fold(f64::MIN_POSITIVE, f64::max);
        (0..MAX_PARAMETERS).for_each(|i| squares[(i, i)] += if i < k { UNSEEN_SHIFT * largest } else { 1.0 });
        squares.lu().solve(&right).unwrap_or_else(SVector::zeros)
    }
}
