use std::fmt;

use freeform_curve_fit::Fit;
use freeform_estimate::{MotionEstimate, MotionState};
use freeform_outline_filter::{Ambiguity, Phase};

use crate::Warning;
use crate::rejection::FrameRejection;

/// What one frame of one object gave.
#[derive(Debug, Clone, PartialEq)]
pub struct Observation {
    /// Name of the object.
    pub object: String,
    /// Number of the frame.
    pub frame: u64,
    /// Time in seconds; `None` where the points are no outline.
    pub time: Option<f64>,
    /// What the method was doing after the frame; `None` where it could not take the frame at all.
    pub phase: Option<ObjectPhase>,
    /// The motion as known after the frame, in space where a camera scale is given; all numbers are finite. `None` where it is not known.
    pub estimate: Option<MotionEstimate>,
    /// Pose and motion with their joint covariance, in the image (motion filter). It stands at the time when they were last known, which is
    /// before that of the frame while the object is lost.
    pub state: Option<MotionState>,
    /// The curve fitted to the outline (adaptive method).
    pub fit: Option<Fit>,
    /// Root mean square distance of the points from the curve, or the noise of this frame (motion filter), in image lengths.
    pub residual: Option<f64>,
    /// Squared innovation of pose and motion in units of its predicted covariance (motion filter).
    pub innovation: Option<f64>,
    /// Turns that the outlines so far do not decide between (motion filter).
    pub ambiguity: Option<Ambiguity>,
    /// Why the frame was not used; `None` where it was.
    pub rejection: Option<FrameRejection>,
    /// What a user should know at once: [`Warning::PointsOutOfOrder`], with the first frame of an object that shows it.
    pub warning: Option<Warning>,
}

impl Observation {
    /// Whether the frame was used.
    #[must_use]
    pub fn is_accepted(&self) -> bool {
        self.rejection.is_none()
    }
}

/// What a method is doing with an object.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ObjectPhase {
    /// Motion filter: no frame yet.
    Waiting,
    /// Motion filter: the outline is known, its motion is not.
    Acquiring,
    /// Motion filter: outline and motion are known and predict the next frame.
    Tracking,
    /// Motion filter: frames have not shown the object for a while.
    Lost,
    /// Adaptive method: no motion yet.
    Start,
    /// Adaptive method: the parameters adapt.
    Adapt,
}

impl ObjectPhase {
    /// Its name: `waiting`, `acquiring`, `tracking`, `lost`, `start` or `adapt`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Waiting => "waiting",
            Self::Acquiring => "acquiring",
            Self::Tracking => "tracking",
            Self::Lost => "lost",
            Self::Start => "start",
            Self::Adapt => "adapt",
        }
    }
}

impl From<Phase> for ObjectPhase {
    fn from(phase: Phase) -> Self {
        match phase {
            Phase::Waiting => Self::Waiting,
            Phase::Acquiring => Self::Acquiring,
            Phase::Tracking => Self::Tracking,
            Phase::Lost => Self::Lost,
        }
    }
}

impl fmt::Display for ObjectPhase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
