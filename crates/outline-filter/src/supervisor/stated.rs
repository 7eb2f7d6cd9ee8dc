//! What is known of a motion when it is stated.
use crate::dynamics::{Summary, WrongFamily};

/// Pose and motion with their covariance, the hypotheses of dynamics taken together.
#[derive(Debug, Clone, Copy)]
pub(super) struct Statement {
    /// With the random part of the errors alone.
    pub(super) random: Summary,
    /// With the random and the systematic part.
    pub(super) all: Summary,
    /// What the model leaves out, beyond doubt.
    pub(super) family: Option<WrongFamily>,
}
