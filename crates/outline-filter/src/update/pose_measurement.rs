//! What a frame tells of the pose by itself, for whoever expects the object where it likes.
use freeform_riccati::MAX_PARAMETERS;
use nalgebra::{SMatrix, SVector};

use crate::belief::{Arrowhead, CellInformation, StateVector};

/// In normalised coordinates, of the error of the predicted pose, on the left; the outline taken as known before the frame.
///
/// What all poses have in common with the outline, such as the error of the first pose, is no part of it: it is the same in every frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PoseMeasurement {
    /// Information W on the pose, the offsets eliminated.
    pub(crate) information: SMatrix<f64, MAX_PARAMETERS, MAX_PARAMETERS>,
    /// W times the error that the frame asks for.
    pub(crate) pulled: SVector<f64, MAX_PARAMETERS>,
}

impl PoseMeasurement {
    /// From the information before a frame and with it, and the right-hand sides that it has added, those of the cells apart.
    pub(super) fn of(before: &Arrowhead, with: &Arrowhead, right: &StateVector, right_of_cells: &[f64]) -> Self {
        match before.k {
            3 => Self::sized::<3>(before, with, right, right_of_cells),
            4 => Self::sized::<4>(before, with, right, right_of_cells),
            6 => Self::sized::<6>(before, with, right, right_of_cells),
            _ => Self::sized::<8>(before, with, right, right_of_cells),
        }
    }

    fn sized<const K: usize>(
        before: &Arrowhead,
        with: &Arrowhead,
        right: &StateVector,
        right_of_cells: &[f64],
    ) -> Self {
        let mut information = [[0.0; K]; K];
        let mut pulled = [0.0; K];
        for i in 0..K {
            pulled[i] = right[i];
            (0..K).for_each(|j| information[i][j] = with.dense[i][j] - before.dense[i][j]);
        }
        let nothing = CellInformation::NOTHING;
        for (number, (cell, right)) in with.cells.iter().zip(right_of_cells).enumerate() {
            let known = before.cells.get(number).unwrap_or(&nothing);
            if cell.own <= known.own {
                continue;
            }
            let inverse = 1.0 / cell.own;
            let mut added = [0.0; K];
            (0..K).for_each(|i| added[i] = cell.coupling[i] - known.coupling[i]);
            for i in 0..K {
                let factor = added[i] * inverse;
                pulled[i] -= factor * right;
                (0..K).for_each(|j| information[i][j] -= factor * added[j]);
            }
        }
        Self {
            information: SMatrix::from_fn(|i, j| {
                if i < K && j < K { 0.5 * (information[i][j] + information[j][i]) } else { 0.0 }
            }),
            pulled: SVector::from_fn(|i, _| if i < K { pulled[i] } else { 0.0 }),
        }
    }

    /// In units of a variance of the noise.
    pub(crate) fn over(&self, variance: f64) -> Self {
        Self { information: self.information / variance, pulled: self.pulled / variance }
    }
}
