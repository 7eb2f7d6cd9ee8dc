use std::fmt;

use freeform_curve_fit::Fit;
use freeform_estimate::{ExpectedState, MotionEstimate, MotionState, ParameterEstimate, PlaneEstimate, PointVelocity};
use freeform_outline_filter::{Ambiguity, KnownOutline, Phase, PlaneAmbiguity};

use super::result::parameters_of;

use crate::rejection::FrameRejection;
use crate::{AdaptiveProgress, Warning};

/// The result of one frame of one object.
#[derive(Debug, Clone, PartialEq)]
pub struct Observation {
    /// Name of the object.
    pub object: String,
    /// Number of the frame.
    pub frame: u64,
    /// Time in seconds; `None` if the points are not an outline.
    pub time: Option<f64>,
    /// State of the method after the frame; `None` if the frame was not passed to the method.
    pub phase: Option<ObjectPhase>,
    /// The motion estimated after the frame, in space if a camera scale is given. All numbers are finite. `None` if it is not known.
    pub estimate: Option<MotionEstimate>,
    /// Names of the parameters that the outlines do not show, as far as that is known after the frame. Others that are not stated are not known well
    /// enough, or [ambiguous](Self::ambiguity).
    pub hidden: Vec<&'static str>,
    /// Velocity of the middle of the object, as [`ObjectResult::velocity`](super::ObjectResult::velocity), as known after the frame.
    pub velocity: Option<PointVelocity>,
    /// As [`ObjectResult::hides_velocity`](super::ObjectResult::hides_velocity), as known after the frame.
    pub hides_velocity: bool,
    /// The motion of a plane in space as known after the frame.
    pub plane: Option<Box<PlaneEstimate>>,
    /// Pose and motion with their joint covariance, in the image (motion filter). The state is the last one known: while the object is lost,
    /// its time is before that of the frame.
    pub state: Option<MotionState>,
    /// What was expected of the object before the frame was looked at, in the image, for the objects of a tracker that
    /// [records it](super::Tracker::record_expected_states) (motion filter).
    pub expected: Option<Box<ExpectedState>>,
    /// The curve fitted to the outline (adaptive method).
    pub fit: Option<Fit>,
    /// What the adaptive law is doing (adaptive method).
    pub progress: Option<AdaptiveProgress>,
    /// Adaptive method: root mean square distance of the points from the curve. Motion filter: noise of this frame. In image lengths.
    pub residual: Option<f64>,
    /// Normalised innovation squared (NIS): the squared Mahalanobis norm of the innovation of the pose by its predicted covariance (motion filter).
    #[doc(alias = "NIS")]
    pub innovation: Option<f64>,
    /// Turns between which the outlines so far do not decide (motion filter).
    pub ambiguity: Option<Ambiguity>,
    /// Two motions of a plane in space that the outlines so far do not decide between.
    pub plane_ambiguity: Option<Box<PlaneAmbiguity>>,
    /// As [`ObjectResult::aliases`](super::ObjectResult::aliases), as known after the frame.
    pub aliases: Vec<f64>,
    /// The outline as far as it is known, in the image, for the objects of [`Tracker::with_known_outlines`](super::Tracker::with_known_outlines)
    /// (motion filter).
    pub known_outline: Option<Box<KnownOutline>>,
    /// Why the frame was not used; `None` where it was.
    pub rejection: Option<FrameRejection>,
    /// As [`TrajectoryRow::segment`](super::TrajectoryRow::segment).
    pub segment: usize,
    /// An immediate warning: [`Warning::PointsOutOfOrder`], in the first such frame of an object.
    pub warning: Option<Warning>,
}

impl Observation {
    /// Whether the frame was used.
    #[must_use]
    pub fn is_accepted(&self) -> bool {
        self.rejection.is_none()
    }

    /// The state at the time of the frame; `None` where it is only that at which a lost object was seen last.
    #[must_use]
    pub fn present_state(&self) -> Option<&MotionState> {
        self.state.as_ref().filter(|state| self.time == Some(state.time()))
    }

    /// The parameters of the motion, whichever family it is of.
    #[must_use]
    pub fn parameters(&self) -> Option<Vec<ParameterEstimate>> {
        parameters_of(self.estimate.as_ref(), self.plane.as_deref())
    }
}

/// The state of a method with an object.
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
