//! What is expected of the object at the time of a frame that has not been looked at.
use freeform_estimate::ExpectedState;

use super::motion_filter::{MotionFilter, Phase};

impl MotionFilter {
    /// Pose and motion as they are expected at a later time, in seconds, from the frames so far: what a smoother compares the
    /// [state](Self::state) after a frame of that time with. `None` where the object is not followed or has gone unseen for long, where no
    /// [state](Self::state) is known, and where the time is not later. It copies the filter.
    #[must_use]
    pub fn expected_state(&self, time: f64) -> Option<ExpectedState> {
        let time = time / self.seconds_per_unit();
        // After a gap nobody knows by how many whole turns.
        if self.phase != Phase::Tracking || self.has_gone_unseen(time) || time <= self.clock.of_track {
            return None;
        }
        let mut ahead = self.clone();
        ahead.stated.take();
        if !ahead.move_on(time) {
            return None;
        }
        // Hypotheses that do not lead yet leave the prediction to a constant generator.
        let leading = ahead.history.dynamics.as_ref().filter(|dynamics| dynamics.leads());
        let turning_velocity = leading.map_or(1.0, |dynamics| dynamics.weights().generator);
        Some(ExpectedState { state: ahead.state()?, turning_velocity })
    }
}
