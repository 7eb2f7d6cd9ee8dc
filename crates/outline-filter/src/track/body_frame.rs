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
    dynamics::DynamicsFilter,
    map::NullDirection,
    prediction::{PoseMatrix, moved_covariance},
};

/// The first frame has shown the outline with an error that all of its cells have in common, and every pose with them. The information on the pose has it
/// as long as the object is followed, in what couples pose and cells. That is forgotten where the object is lost, and the error is not.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct BodyFrame {
    /// Of that error as far as it is no longer in the information on the pose: in the body frame, normalised.
    covariance: PoseMatrix,
    /// What the cells that the map has grown by have not in common with the first: how far the outline had gone meanwhile along what it did not show. The
    /// information on the pose has that as well, hypotheses of dynamics do not.
    forgotten: PoseMatrix,
}

impl Default for BodyFrame {
    fn default() -> Self {
        Self { covariance: PoseMatrix::zeros(), forgotten: PoseMatrix::zeros() }
    }
}

impl BodyFrame {
    /// Of a covariance that rounding may have left with negative variances.
    pub(super) fn of(covariance: &PoseMatrix) -> Self {
        let mut eigen = (0.5 * (covariance + covariance.transpose())).symmetric_eigen();
        eigen.eigenvalues.apply(|value| *value = value.max(0.0));
        Self { covariance: eigen.recompose(), ..Self::default() }
    }

    /// Takes nothing to be known along directions in the body frame that the outline did not show so far.
    pub(super) fn forget(&mut self, directions: &[NullDirection]) {
        self.forgotten += directions.iter().map(NullDirection::square).sum::<PoseMatrix>();
    }
}

impl Track {
    /// Keeps the error that all cells have in common, before pose and motion are forgotten. Hypotheses of dynamics know it without the motion of a
    /// constant generator, which may have moved the outline.
    pub(crate) fn keep_common_error(&mut self, dynamics: Option<&DynamicsFilter>) {
        if let Some(of_dynamics) = dynamics.and_then(DynamicsFilter::common_error) {
            self.body_frame = BodyFrame::of(&(self.body_frame.covariance + of_dynamics + self.body_frame.forgotten));
        } else if let Some(common) = self.common_error() {
            self.body_frame = BodyFrame::of(&(self.body_frame.covariance + common));
        }
    }

    /// Its covariance as far as the information on the pose has it: what is not known of the pose, beyond what would not be if the outline were.
    fn common_error(&self) -> Option<PoseMatrix> {
        let [believed, given_outline] = self.held_summaries(&self.null_directions())?;
        self.in_body_frame(&(of_pose(&believed.covariance) - of_pose(&given_outline.covariance)))
    }

    /// The covariance of an error of the pose that it is in, on the left, as one in the body frame.
    pub(super) fn in_body_frame(&self, covariance: &PoseMatrix) -> Option<PoseMatrix> {
        moved_covariance(self.model(), covariance, &self.belief.pose.try_inverse()?)
    }

    /// How far such an error moves the cells at most, root mean square, in the body frame.
    pub(super) fn farthest_displacement(&self, covariance: &PoseMatrix) -> Option<f64> {
        self.map.farthest_displacement(self.model(), &self.in_body_frame(covariance)?)
    }

    /// The common error that has been kept, as one of a pose, on the left; `None` where numbers do not allow to say it.
    pub(crate) fn kept_error(&self, pose: &Matrix3<f64>) -> Option<PoseMatrix> {
        if self.body_frame.covariance == PoseMatrix::zeros() {
            return Some(PoseMatrix::zeros());
        }
        moved_covariance(self.model(), &self.body_frame.covariance, pose)
    }
}

/// That of the pose out of a covariance of pose and motion. What lies beyond the parameters of the model says nothing.
pub(crate) fn of_pose(covariance: &StateMatrix) -> PoseMatrix {
    covariance.fixed_view::<MAX_PARAMETERS, MAX_PARAMETERS>(0, 0).into_owned()
}

/// A covariance of pose and motion that has that of a pose alone.
pub(crate) fn of_pose_alone(covariance: &PoseMatrix) -> StateMatrix {
    let mut of_both = StateMatrix::zeros();
    of_both.fixed_view_mut::<MAX_PARAMETERS, MAX_PARAMETERS>(0, 0).copy_from(covariance);
    of_both
}

#[cfg(feature = "serde")]
impl BodyFrame {
    /// Whether it may be a covariance: symmetric, without negative variances and in bounds.
    pub(super) fn is_valid(&self) -> bool {
        [self.covariance, self.forgotten].iter().all(|covariance| {
            let size = covariance.amax();
            size <= StateFormat::LARGEST_NUMBER
                && (covariance - covariance.transpose()).amax() <= ROUNDING_OF_CORRELATION * size
                && covariance.diagonal().iter().all(|variance| *variance >= 0.0)
        })
    }
}
