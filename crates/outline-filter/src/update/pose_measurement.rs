//! What a frame tells of the pose by itself, whatever motion was predicted.
use freeform_riccati::MAX_PARAMETERS;
use nalgebra::SVector;

use super::solve::Proposal;
use crate::{
    belief::{Belief, OffsetInformation, sum_of_outer_products},
    measurement::Frame,
    prediction::PoseMatrix,
    tuning::dynamics::LARGEST_VARIANCE,
    vectors::vectorised,
};

/// In normalised coordinates, of the error of the predicted pose, on the left; the outline taken as known before the frame.
///
/// What all poses have in common with the outline, such as the error of the first pose, is no part of it: it is the same in every frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PoseMeasurement {
    /// Information W on the pose, the offsets eliminated.
    pub(crate) information: PoseMatrix,
    /// W times the error that the frame asks for.
    pub(crate) pulled: SVector<f64, MAX_PARAMETERS>,
    /// The error that all that is known and the frame together ask for.
    pub(crate) solution: SVector<f64, MAX_PARAMETERS>,
    /// Factor, at least 1, of the variance of the pose for hypotheses of motions that change at random, (64a) in docs/motion-filter.md.
    pub(crate) noise_inflation: f64,
}

impl PoseMeasurement {
    /// Of a solved frame that has not been committed yet, in units of the noise: `frame.cells_with_frame` have the information with it, those of the
    /// belief without.
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
        let taken = taken_by_offsets::<K, S>([&frame.cells_with_frame, &before.cells], &frame.right);
        for i in 0..K {
            pulled[i] -= taken.pull[i];
            information[i].iter_mut().zip(&taken.information[i]).for_each(|(entry, taken)| *entry -= taken);
        }
        Self {
            information: PoseMatrix::from_fn(|i, j| {
                if i < K && j < K { 0.5 * (information[i][j] + information[j][i]) } else { 0.0 }
            }),
            pulled: SVector::from_fn(|i, _| if i < K { pulled[i] } else { 0.0 }),
            solution: SVector::from_fn(|i, _| if i < K { proposal.state[i] } else { 0.0 }),
            noise_inflation: 1.0,
        }
    }

    /// The error of the predicted pose that the frame asks for, divided by a variance, and its covariance. Along what the frame hardly shows the
    /// error is next to none.
    pub(crate) fn error(&self) -> Option<(SVector<f64, MAX_PARAMETERS>, PoseMatrix)> {
        let information = self.information + PoseMatrix::from_diagonal_element(1.0 / LARGEST_VARIANCE);
        let covariance = information.cholesky()?.inverse();
        Some((covariance * self.pulled, covariance))
    }

    /// Over the effective variance of the noise, with the factor of (64a).
    pub(crate) fn over(&self, variance: f64, noise_inflation: f64) -> Self {
        Self { information: self.information / variance, pulled: self.pulled / variance, noise_inflation, ..*self }
    }
}

/// Share of the variance of mean residuals that the offsets of a solved frame leave: 1 minus the mean leverage of what it adds to each. Half in the
/// second frame, all once the outline is known.
pub(crate) fn left_by_offsets(belief: &Belief, frame: &Frame) -> f64 {
    let count = frame.right.len();
    let own = frame.cells_with_frame.own()[..count].iter().zip(&belief.information.cells.own()[..count]);
    let [added, left] = own.filter(|(with, before)| with > before).fold([0.0, 0.0], |[added, left], (with, before)| {
        [added + (with - before), left + (with - before) * before / with]
    });
    if added > 0.0 { left / added } else { 1.0 }
}

/// What the offsets take off the information of a frame on the pose and off its pull.
struct Taken<const K: usize> {
    information: [[f64; K]; K],
    pull: [f64; K],
}

/// Of each cell, with the information that a frame has on it and that before, its part of the coupling that the frame has added.
fn taken_by_offsets<const K: usize, const S: usize>(
    [with, before]: [&OffsetInformation; 2],
    right: &[f64],
) -> Taken<K> {
    // The pull is a column beside those of the coupling; what is left of a vector stays empty.
    match K {
        3 => padded::<K, S, 4>([with, before], right),
        4 | 6 => padded::<K, S, 8>([with, before], right),
        _ => padded::<K, S, 12>([with, before], right),
    }
}

fn padded<const K: usize, const S: usize, const P: usize>(
    [with, before]: [&OffsetInformation; 2],
    right: &[f64],
) -> Taken<K> {
    let count = right.len();
    let (own, own_before, right) = (&with.own()[..count], &before.own()[..count], &right[..count]);
    let (coupling, coupling_before) = (&with.rows::<S>()[..count], &before.rows::<S>()[..count]);
    let sum = vectorised(
        #[inline(always)]
        || {
            sum_of_outer_products::<_, P>(
                count,
                #[inline(always)]
                |number| {
                    let (coupling, before) = (&coupling[number], &coupling_before[number]);
                    let mut added = [0.0; P];
                    for i in 0..K {
                        added[i] = coupling[i] - before[i];
                    }
                    added[K] = right[number];
                    let own = own[number];
                    (added, if own > own_before[number] { 1.0 / own } else { 0.0 })
                },
            )
        },
    );
    Taken {
        information: std::array::from_fn(|i| std::array::from_fn(|j| sum[i][j])),
        pull: std::array::from_fn(|i| sum[i][K]),
    }
}
