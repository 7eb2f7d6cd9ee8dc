//! What a frame tells of the pose by itself, for whoever expects the object where it likes.
use freeform_riccati::MAX_PARAMETERS;
use nalgebra::{SMatrix, SVector};

use super::solve::Proposal;
use crate::{
    belief::{Belief, OffsetInformation},
    measurement::Frame,
    tuning::dynamics::LARGEST_VARIANCE,
    vectors::vectorised,
};

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
    /// Of a solved frame that has not been taken yet, in units of the noise: `frame.cells` have the information with it, those of the belief
    /// without.
    pub(crate) fn of(belief: &Belief, proposal: &Proposal, frame: &Frame) -> Self {
        match belief.parameter_count() {
            3 => Self::sized::<3, 6>(belief, proposal, frame),
            4 => Self::sized::<4, 8>(belief, proposal, frame),
            6 => Self::sized::<6, 12>(belief, proposal, frame),
            _ => Self::sized::<8, 16>(belief, proposal, frame),
        }
    }

    fn sized<const K: usize, const S: usize>(belief: &Belief, proposal: &Proposal, frame: &Frame) -> Self {
        let before = &belief.information;
        let mut information = [[0.0; K]; K];
        let mut pulled = [0.0; K];
        for i in 0..K {
            pulled[i] = proposal.right[i];
            (0..K).for_each(|j| information[i][j] = proposal.dense[i][j] - before.dense[i][j]);
        }
        let [own, own_before] = [&frame.cells, &before.cells].map(OffsetInformation::own);
        let [coupling, coupling_before] = [&frame.cells, &before.cells].map(OffsetInformation::rows::<S>);
        vectorised(
            #[inline(always)]
            || {
                let of_cells = own.iter().zip(own_before).zip(coupling.iter().zip(coupling_before));
                for (((own, own_before), (coupling, coupling_before)), right) in of_cells.zip(&frame.right) {
                    if own <= own_before {
                        continue;
                    }
                    let inverse = 1.0 / own;
                    let mut added = [0.0; K];
                    for i in 0..K {
                        added[i] = coupling[i] - coupling_before[i];
                    }
                    for i in 0..K {
                        let factor = added[i] * inverse;
                        pulled[i] -= factor * right;
                        for j in 0..K {
                            information[i][j] -= factor * added[j];
                        }
                    }
                }
            },
        );
        Self {
            information: SMatrix::from_fn(|i, j| {
                if i < K && j < K { 0.5 * (information[i][j] + information[j][i]) } else { 0.0 }
            }),
            pulled: SVector::from_fn(|i, _| if i < K { pulled[i] } else { 0.0 }),
        }
    }

    /// The error of the predicted pose that the frame asks for, divided by a variance: next to none along what it hardly shows.
    pub(crate) fn error(&self) -> Option<SVector<f64, MAX_PARAMETERS>> {
        let before = SMatrix::from_diagonal_element(1.0 / LARGEST_VARIANCE);
        (self.information + before).lu().solve(&self.pulled)
    }

    /// In units of a variance of the noise.
    pub(crate) fn over(&self, variance: f64) -> Self {
        Self { information: self.information / variance, pulled: self.pulled / variance }
    }
}
