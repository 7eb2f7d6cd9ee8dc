//! What the cells of a frame say of motions that the model leaves out.
use freeform_riccati::MAX_PARAMETERS;
use nalgebra::SMatrix;

use super::{
    pose_measurement::PoseMeasurement,
    unmodelled_displacement::{UNMODELLED, UnmodelledMatrix, UnmodelledVector},
};
use crate::{tuning::family as tuning, vectors::LANES};

/// What one frame says of the motions that are left out, its pose taken to be unknown.
#[derive(Debug, Clone, Copy)]
pub(crate) struct UnmodelledScore {
    /// In units of the noise.
    pub(crate) information: UnmodelledMatrix,
    /// Information times the sizes that the frame asks for.
    pub(crate) score: UnmodelledVector,
    /// Sum of the weights of points on known cells.
    pub(crate) weight: f64,
}

/// What is known of a cell with a frame and without it, and what the frame adds: the information `own`, its right-hand side, and K entries
/// of the coupling.
pub(super) struct OfCell<'a, const K: usize, const S: usize> {
    pub(super) with: f64,
    pub(super) before: f64,
    pub(super) own: f64,
    pub(super) right: f64,
    pub(super) coupling: &'a [f64; S],
    pub(super) added: &'a [f64; K],
}

/// Sums over the cells of a frame, the offsets eliminated.
pub(super) struct Sums<const K: usize, const S: usize> {
    /// Up to the diagonal; of what is beyond it not all is summed up.
    information: [[f64; UNMODELLED]; UNMODELLED],
    score: [f64; UNMODELLED],
    /// Squares of the displacements with what pose and outline have taken in.
    whole: [f64; UNMODELLED],
    /// With the pose.
    with_pose: [[f64; UNMODELLED]; K],
    weight: f64,
    /// What pose and motion are moved by.
    pub(super) right: [[f64; UNMODELLED]; S],
}

impl<const K: usize, const S: usize> Sums<K, S> {
    pub(super) const NOTHING: Self = Self {
        information: [[0.0; UNMODELLED]; UNMODELLED],
        score: [0.0; UNMODELLED],
        whole: [0.0; UNMODELLED],
        with_pose: [[0.0; UNMODELLED]; K],
        weight: 0.0,
        right: [[0.0; UNMODELLED]; S],
    };

    /// Adds a cell that is displaced by `whole`, of which its offset and the pose have taken some in; returns what is left.
    #[inline(always)]
    pub(super) fn add(
        &mut self,
        whole: &[f64; UNMODELLED],
        taken_in: &[f64],
        of_pose: &[[f64; UNMODELLED]; K],
        cell: &OfCell<'_, K, S>,
    ) -> [f64; UNMODELLED] {
        let OfCell { with, before, own, right, coupling, added } = *cell;
        let mut left = [0.0; UNMODELLED];
        for l in 0..UNMODELLED {
            left[l] = whole[l] - taken_in[l];
        }
        let inverse = 1.0 / own;
        for (i, row) in of_pose.iter().enumerate() {
            let factor = added[i] * inverse;
            for l in 0..UNMODELLED {
                left[l] -= factor * row[l];
            }
        }
        let by_known = own / with;
        for (i, row) in self.right.iter_mut().enumerate() {
            let direct = if i < K { added[i] } else { 0.0 };
            let factor = direct - coupling[i] * by_known;
            for l in 0..UNMODELLED {
                row[l] += factor * left[l];
            }
        }
        if before > 0.0 {
            // Only what was known before can be compared with.
            let share = before / with;
            let shared = left.map(|left| share * left);
            for (m, row) in self.information.iter_mut().enumerate() {
                let of_own = shared[m] * own;
                // Up to the diagonal, in whole vectors.
                for l in 0..UNMODELLED.min((m / LANES + 1) * LANES) {
                    row[l] += of_own * left[l];
                }
            }
            for (i, row) in self.with_pose.iter_mut().enumerate() {
                for l in 0..UNMODELLED {
                    row[l] += shared[l] * added[i];
                }
            }
            for l in 0..UNMODELLED {
                self.score[l] += shared[l] * right;
                self.whole[l] += share * own * whole[l] * whole[l];
            }
            self.weight += own;
        }
        left
    }

    /// The pose eliminated. A motion that has no more than a share of its squared displacement left says nothing.
    pub(super) fn score(&self, pose: &PoseMeasurement, share: f64) -> Option<UnmodelledScore> {
        let known = SMatrix::<f64, MAX_PARAMETERS, MAX_PARAMETERS>::from_fn(|i, j| {
            if i < K && j < K { pose.information[(i, j)] } else { f64::from(u8::from(i == j)) }
        });
        let jitter = (0..K).map(|i| known[(i, i)]).fold(0.0, f64::max) * tuning::SINGULAR;
        let with_pose =
            SMatrix::<f64, MAX_PARAMETERS, UNMODELLED>::from_fn(|i, l| if i < K { self.with_pose[i][l] } else { 0.0 });
        let explained = (known + SMatrix::identity() * jitter).cholesky()?.solve(&with_pose);
        let mut information = UnmodelledMatrix::from_fn(|a, b| {
            self.information[a.max(b)][a.min(b)] - with_pose.column(a).dot(&explained.column(b))
        });
        let mut score = UnmodelledVector::from(self.score) - explained.transpose() * pose.pulled;
        for l in 0..UNMODELLED {
            if information[(l, l)] > share * self.whole[l] {
                continue;
            }
            information.row_mut(l).fill(0.0);
            information.column_mut(l).fill(0.0);
            score[l] = 0.0;
        }
        let found = UnmodelledScore { information, score, weight: self.weight };
        (self.weight > 0.0 && information.iter().chain(&score).all(|e| e.is_finite())).then_some(found)
    }
}
