//! Frames that repeat the one before them are passed over.
use super::{
    motion_filter::{MotionFilter, Phase},
    repeated_frames::BeforeRepeated,
    tracking::predict,
};
use crate::{dynamics::DynamicsFilter, track::Track};

impl MotionFilter {
    /// Whether a frame that repeats the one before it need not show where the object is now: nothing says that it is at rest, as where it turns round.
    pub(super) fn may_have_moved(&self) -> bool {
        let changes = self.history.dynamics.as_ref().is_some_and(DynamicsFilter::changes_at_random);
        self.phase != Phase::Tracking || changes || !self.track.as_ref().is_some_and(Track::is_known_to_rest)
    }

    /// Moves on to the time of a frame that repeats the one before it.
    pub(super) fn pass_over(&mut self, time: f64) {
        self.clock.last_frame = time;
        let Some(track) = self.track.as_ref().filter(|_| self.phase == Phase::Tracking) else { return };
        if self.before_repeated.is_none() {
            let (track, history) = (track.clone(), self.history.clone());
            self.before_repeated = Some(Box::new(BeforeRepeated { track, history, time: self.clock.of_track }));
        }
        if !self.move_on(time) {
            self.phase = Phase::Lost;
        }
    }

    /// Moves the track on to a time whose frame is not measured; whether it can be predicted.
    pub(super) fn move_on(&mut self, time: f64) -> bool {
        let Some(track) = self.track.as_mut() else { return false };
        let is_predicted = predict(&self.settings, track, &mut self.history, time - self.clock.of_track);
        if is_predicted {
            self.clock.of_track = time;
            self.history.end_step();
        }
        is_predicted
    }

    /// Goes back to the last frame that was looked at.
    pub(super) fn go_back_before_repeated(&mut self) {
        if let Some(before) = self.before_repeated.take() {
            let BeforeRepeated { track, history, time } = *before;
            (self.track, self.history, self.clock.of_track) = (Some(track), history, time);
            // It was tracked then, also where it could not be predicted since.
            self.phase = Phase::Tracking;
        }
    }
}
