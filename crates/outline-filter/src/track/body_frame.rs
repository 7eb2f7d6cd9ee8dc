//! Where the body frame lies beside the outline of the first frame.
#[cfg(feature = "serde")]
use freeform_estimate::StateFormat;
use freeform_riccati::MAX_PARAMETERS;
use nalgebra::Matrix3;

use super::Track;
#[cfg(feature = "serde")]
use crate::tuning::statement::ROUNDING_OF_CORRELATION;
use crate::{
    belief::StateMatrix,
    dynamics::{DynamicsFilter, PoseMatrix},
    update::{hold, with_hold},
};

/// The first frame has shown the outline with an error that all of its cells have in common, and every pose with them. The information on the pose has it
/// as long as the object is followed, in what couples pose and cells. That is forgotten where the object is lost, and the error is not.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct BodyFrame {
    /// Of that error as far as it is no longer in the information on the pose: in the body frame, normalised.
    covariance: PoseMatrix,
}

impl Default for BodyFrame {
    fn default() -> Self {
        Self { covariance: PoseMatrix::zeros() }
    }
}

impl BodyFrame {
    pub(super) fn of(covariance: PoseMatrix) -> Self {
        Self { covariance }
    }

    pub(super) fn covariance(&self) -> PoseMatrix {
        self.covariance
    }
}

impl Track {
    /// Keeps the error that all cells have in common, before pose and motion are forgotten. Hypotheses of dynamics know it without the motion of a
    /// constant generator, which may have moved the outline.
    pub(crate) fn keep_common_error(&mut self, dynamics: Option<&DynamicsFilter>) {
        if let Some(of_dynamics) = dynamics.and_then(DynamicsFilter::common_error) {
            self.body_frame.covariance = of_dynamics;
        } else if let Some(common) = self.common_error() {
            self.body_frame.covariance += common;
        }
    }

    /// Its covariance as far as the information on the pose has it: what is not known of the pose, beyond what would not be if the outline were.
    fn common_error(&self) -> Option<PoseMatrix> {
        let belief = &self.belief;
        let null = self.map.null_directions(belief.model, &belief.pose);
        let hold = hold(belief, &self.map, &null);
        let of_pose = |information: &StateMatrix| {
            let covariance = self.summary_by(&with_hold(information, hold.as_ref()))?.covariance;
            Some(covariance.fixed_view::<MAX_PARAMETERS, MAX_PARAMETERS>(0, 0).into_owned())
        };
        let added = of_pose(&belief.marginal)? - of_pose(&belief.information.with_outline_given())?;
        let k = belief.parameter_count();
        let added =
            PoseMatrix::from_fn(|i, j| if i < k && j < k { 0.5 * (added[(i, j)] + added[(j, i)]) } else { 0.0 });
        let in_body = self.carried(&added, &belief.pose.try_inverse()?)?;
        // The difference of two that are nearly equal.
        let mut eigen = in_body.symmetric_eigen();
        eigen.eigenvalues.apply(|value| *value = value.max(0.0));
        Some(eigen.recompose())
    }

    /// Adds the common error that has been kept to a covariance of pose and motion in a pose.
    pub(super) fn add_kept_error(&self, covariance: &mut StateMatrix, pose: &Matrix3<f64>) {
        if self.body_frame.covariance == PoseMatrix::zeros() {
            return;
        }
        if let Some(in_image) = self.carried(&self.body_frame.covariance, pose) {
            let mut of_pose = covariance.fixed_view_mut::<MAX_PARAMETERS, MAX_PARAMETERS>(0, 0);
            of_pose += in_image;
        }
    }

    /// A covariance of errors of a frame as one in the coordinates that a map takes it to.
    pub(super) fn carried(&self, covariance: &PoseMatrix, map: &Matrix3<f64>) -> Option<PoseMatrix> {
        let (model, k) = (self.belief.model, self.belief.parameter_count());
        let change = model.adjoint(map, &map.try_inverse()?);
        let change = PoseMatrix::from_fn(|i, j| if i < k && j < k { change[i][j] } else { 0.0 });
        let carried = change * covariance * change.transpose();
        carried.iter().all(|entry| entry.is_finite()).then_some(carried)
    }
}

/// Whether a matrix is symmetric, without negative variances and in bounds, as one that was saved is.
#[cfg(feature = "serde")]
pub(super) fn is_covariance(matrix: &PoseMatrix) -> bool {
    let size = matrix.amax();
    size <= StateFormat::LARGEST_NUMBER
        && (matrix - matrix.transpose()).amax() <= ROUNDING_OF_CORRELATION * size
        && matrix.diagonal().iter().all(|variance| *variance >= 0.0)
}

#[cfg(feature = "serde")]
impl BodyFrame {
    /// Whether it may be a covariance.
    pub(super) fn is_valid(&self) -> bool {
        is_covariance(&self.covariance)
    }
}
