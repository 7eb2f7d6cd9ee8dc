use freeform_estimate::{MotionEstimate, PointVelocity};
use freeform_outline_filter::{Ambiguity, DynamicsWeights};
use freeform_riccati::MotionModel;

use super::settings::Method;
use crate::Warning;
use crate::rejection::FrameRejection;

/// The result for an object after all its frames so far.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectResult {
    /// Name of the object.
    pub object: String,
    /// The method of identification.
    pub method: Method,
    /// The motion model.
    pub motion: MotionModel,
    /// Number of frames, including rejected ones.
    pub frames: usize,
    /// Frames that were not used.
    pub frames_rejected: usize,
    /// Why the first rejected frame was not used.
    pub first_rejection: Option<FrameRejection>,
    /// The last known motion, in space if a camera scale is given. All numbers are finite. `None` if no motion was found.
    pub estimate: Option<MotionEstimate>,
    /// Velocity of the middle of the object in the last frame, in space if a camera scale is given (motion filter). It may be known while
    /// the angular velocity is not observable, as for a circle.
    pub velocity: Option<PointVelocity>,
    /// Turns between which the outlines do not decide (motion filter).
    pub ambiguity: Option<Ambiguity>,
    /// Other angular velocities, rad/s, that explain the outlines as well, because the outline has a symmetry (motion filter).
    pub aliases: Vec<f64>,
    /// Probabilities of the hypotheses of dynamics (motion filter, from the third frame on).
    pub dynamics: Option<DynamicsWeights>,
    /// Warnings on the result, causes before consequences.
    pub warnings: Vec<Warning>,
}
