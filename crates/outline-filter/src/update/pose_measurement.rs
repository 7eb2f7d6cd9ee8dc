//! What a frame tells of the pose by itself, whatever motion was predicted.
use freeform_riccati::MAX_PARAMETERS;
use nalgebra::{SMatrix, SVector};

use super::solve::Proposal;
use crate::{
    belief::{Belief, OffsetInformation},
    measurement::Frame,
    tuning::dynamics::LARGEST_VARIANCE,
    vectors::{LANES, Lanes, add_product, in_lanes, vectorised},
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
    /// Of a solved frame that has not been committed yet, in units of the noise: `frame.cells_with_frame` have the information with it, those of the belief
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
            information[i].copy_from_slice(&proposal.added[i][..K]);
        }
        let [own, own_before] = [&frame.cells_with_frame, &before.cells].map(OffsetInformation::own);
        let [coupling, coupling_before] = [&frame.cells_with_frame, &before.cells].map(OffsetInformation::rows::<S>);
        let (taken, taken_pull) = vectorised(
            #[inline(always)]
            || {
                let mut taken = ([[[0.0; LANES]; K]; K], [[0.0; LANES]; K]);
                for start in (0..own.len()).step_by(LANES) {
                    add_eliminated(start, (own, own_before), (coupling, coupling_before), &frame.right, &mut taken);
                }
                taken
            },
        );
        for i in 0..K {
            pulled[i] -= taken_pull[i].iter().sum::<f64>();
            for j in 0..=i {
                let sum: f64 = taken[i][j].iter().sum();
                information[i][j] -= sum;
                information[j][i] -= if i == j { 0.0 } else { sum };
            }
        }
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

/// Adds, in lanes, what the offsets of the cells from `start` on take off the information of a frame on the pose, its lower half, and off its
/// pull: of each cell its part of the coupling that the frame has added.
#[inline(always)]
fn add_eliminated<const K: usize, const S: usize>(
    start: usize,
    (own, own_before): (&[f64], &[f64]),
    (coupling, coupling_before): (&[[f64; S]], &[[f64; S]]),
    right: &[f64],
    (taken, taken_pull): &mut ([[Lanes; K]; K], [Lanes; K]),
) {
    let count = LANES.min(own.len() - start);
    let (mut added, mut inverse, mut of_offset) = ([[0.0; K]; LANES], [0.0; LANES], [0.0; LANES]);
    for lane in 0..count {
        let at = start + lane;
        let (with, before) = (&coupling[at], &coupling_before[at]);
        (0..K).for_each(|i| added[lane][i] = with[i] - before[i]);
        inverse[lane] = if own[at] > own_before[at] { 1.0 / own[at] } else { 0.0 };
        of_offset[lane] = right[at];
    }
    let added = in_lanes(&added);
    for i in 0..K {
        let mut factor = [0.0; LANES];
        add_product(&mut factor, &added[i], &inverse);
        add_product(&mut taken_pull[i], &factor, &of_offset);
        for j in 0..=i {
            add_product(&mut taken[i][j], &factor, &added[j]);
        }
    }
}
