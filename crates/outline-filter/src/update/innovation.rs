//! What a frame says of the pose beyond what was predicted, and what that says of how fast the motion changes.
use freeform_riccati::MAX_PARAMETERS;
use nalgebra::{Point2, SMatrix, SVector};

use crate::{
    belief::{Belief, StateMatrix, StateVector},
    prediction::{ByKind, centred_change, kind_index},
};

type PoseMatrix = SMatrix<f64, MAX_PARAMETERS, MAX_PARAMETERS>;
type PoseVector = SVector<f64, MAX_PARAMETERS>;

/// Innovation of the pose in one frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct PoseInnovation {
    /// Squared, in units of its covariance: chi-squared with one degree of freedom per parameter.
    pub(crate) squared: f64,
    /// Derivatives of the log-likelihood by the variances of the motion's change per second, in normalised units.
    pub(crate) gradient: ByKind,
    /// Fisher information of each, and of one variance for both.
    pub(crate) fisher: ByKind,
    pub(crate) fisher_of_both: f64,
}

impl Belief {
    /// From the marginal information before and after a frame and the step that it made; `middle` is the
    /// object's in the body frame, `variance` that of the noise, with its correlation. The covariance of the pose step is `P - P+`; with `A = P^-1` of the pose alone the innovation v obeys
    /// `S^-1 v = A step` and `S^-1 = A (P - P+) A`.
    pub(crate) fn pose_innovation(
        &self,
        [before, after]: [&StateMatrix; 2],
        state: &StateVector,
        middle: &Point2<f64>,
        variance: f64,
    ) -> PoseInnovation {
        let k = self.information.k;
        let innovation = || {
            let (before, after) = (pose_information(before, k)?, pose_information(after, k)?);
            let (p, p_after) = (inverse(&before)?, inverse(&after)?);
            let step = PoseVector::from_fn(|i, _| if i < k { state[i] } else { 0.0 });
            let gained = p - p_after;
            // Directions that the frame does not show have no step either.
            let regular = gained + PoseMatrix::from_diagonal(&(p.diagonal() * 1e-9));
            let squared = step.dot(&(inverse(&regular)? * step)) / variance;
            let weighted = before * step / variance.sqrt();
            let by_change = centred_change(self.model, &self.pose, middle)?;
            // Of the pose by unit changes of the motion, over the last step.
            let (slope, curvature) =
                (by_change.transpose() * weighted, by_change.transpose() * before * gained * before * by_change);
            let growth = self.memory.step.powi(3) / variance;
            let mut all = PoseInnovation { squared, ..PoseInnovation::default() };
            let kinds = || self.model.parameter_kinds().iter().map(|kind| kind_index(*kind)).enumerate();
            for (i, of_i) in kinds() {
                all.gradient[of_i] += 0.5 * growth * (slope[i] * slope[i] - curvature[(i, i)]);
                for (j, of_j) in kinds() {
                    let fisher = 0.5 * growth * growth * curvature[(i, j)] * curvature[(i, j)];
                    all.fisher_of_both += fisher;
                    all.fisher[of_i] += if of_i == of_j { fisher } else { 0.0 };
                }
            }
            let is_finite = all.gradient.iter().chain(&all.fisher).all(|e| e.is_finite());
            (squared >= 0.0 && is_finite && all.fisher.iter().all(|f| *f > 0.0)).then_some(all)
        };
        innovation().unwrap_or_default()
    }
}

/// Information of the pose with the motion eliminated; unit diagonal beyond the parameters.
fn pose_information(marginal: &StateMatrix, k: usize) -> Option<PoseMatrix> {
    let block = |r: usize, c: usize| {
        PoseMatrix::from_fn(|i, j| {
            if i < k && j < k { marginal[(r + i, c + j)] } else { f64::from(u8::from(i == j && r == c)) }
        })
    };
    let (pose, cross, motion) = (block(0, 0), block(0, k), block(k, k));
    let cross = PoseMatrix::from_fn(|i, j| if i < k && j < k { cross[(i, j)] } else { 0.0 });
    Some(pose - cross * inverse(&motion)? * cross.transpose())
}

/// Inverse of a positive definite matrix, scaled to unit diagonal on the way.
fn inverse(matrix: &PoseMatrix) -> Option<PoseMatrix> {
    let scale = matrix.diagonal().map(|d| if d > 0.0 { 1.0 / d.sqrt() } else { 1.0 });
    let scaled = PoseMatrix::from_fn(|i, j| matrix[(i, j)] * scale[i] * scale[j]);
    let inverse = (scaled + PoseMatrix::identity() * 1e-12).cholesky()?.inverse();
    Some(PoseMatrix::from_fn(|i, j| inverse[(i, j)] * scale[i] * scale[j]))
}
