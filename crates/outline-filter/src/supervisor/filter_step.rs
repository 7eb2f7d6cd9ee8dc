//! What became of one frame.
use super::motion_filter::{MotionFilter, Phase};
use crate::update::{FrameMeasurement, Rejection};

/// The result of one frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FilterStep {
    /// Time of the frame in seconds.
    pub time: f64,
    /// Phase after the frame.
    pub phase: Phase,
    /// Comparison with the known outline in the pose that was tried last; of a lost object that only a part of all turns has been searched for, where
    /// it was expected. `None` if there was no outline or no pose to compare with, or the frame was not searched.
    pub measurement: Option<FrameMeasurement>,
    /// Why the frame was not used; `None` if it was used.
    pub rejection: Option<Rejection>,
}

impl FilterStep {
    /// Whether the frame was used.
    #[must_use]
    pub fn is_accepted(&self) -> bool {
        self.rejection.is_none()
    }
}

impl MotionFilter {
    /// The step of a frame that a map was begun with.
    pub(super) fn begun(&mut self, seconds: f64) -> FilterStep {
        self.counts.accepted_in_recording += 1;
        self.step_unmeasured(seconds, None)
    }

    /// The step of a frame that was compared with nothing.
    pub(super) fn step_unmeasured(&self, seconds: f64, rejection: Option<Rejection>) -> FilterStep {
        FilterStep { time: seconds, phase: self.phase, measurement: None, rejection }
    }
}
