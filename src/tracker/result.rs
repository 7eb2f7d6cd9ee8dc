use freeform_estimate::{MotionEstimate, PointVelocity};
use freeform_outline_filter::Ambiguity;
use freeform_riccati::MotionModel;

use super::settings::Method;
use crate::Warning;
use crate::rejection::FrameRejection;

/// What is known of an object after all its frames so far.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectResult {
    /// Name of the object.
    pub object: String,
    /// How its motion was identified.
    pub method: Method,
    /// Which motions were looked for.
    pub motion: MotionModel,
    /// Frames taken, rejected ones included.
    pub frames: usize,
    /// Frames that were not used.
    pub frames_rejected: usize,
    /// Why the first of them was not.
    pub first_rejection: Option<FrameRejection>,
    /// The motion as it was last known, in space where a camera scale is given; all numbers are finite. `None` where none was found.
    pub estimate: Option<MotionEstimate>,
    /// Velocity of the object's middle at the last frame, in space where a camera scale is given (motion filter). It may be known where
    /// the angular velocity is not.
    pub velocity: Option<PointVelocity>,
    /// Turns that the outlines do not decide between (motion filter).
    pub ambiguity: Option<Ambiguity>,
    /// What a user should know of the result, the reason for others first.
    pub warnings: Vec<Warning>,
}
