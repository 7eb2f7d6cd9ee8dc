//! What is known of a motion when it is stated.
use crate::{
    dynamics::{Summary, WrongFamily},
    prediction::PoseMatrix,
};

/// Pose and motion with their covariance, the hypotheses of dynamics taken together.
#[derive(Debug, Clone, Copy)]
pub(super) struct Statement {
    /// With the random part of the errors alone, counted from the body frame.
    pub(super) random: Summary,
    /// With the random and the systematic part.
    pub(super) all: Summary,
    /// Covariance of where the body frame lies beside the outline, as an error of the pose on the left; `None` where numbers do not allow to say that.
    pub(super) body_frame: Option<PoseMatrix>,
    /// What the model leaves out, beyond doubt.
    pub(super) family: Option<WrongFamily>,
}
