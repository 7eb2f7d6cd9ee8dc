//! Objects that have gone unseen over a gap between frames.
use freeform_curve_fit::Outline;

use super::{
    gates::gate_of_all,
    motion_filter::{MotionFilter, Phase},
    tracking::predict,
};
use crate::{track::Outcome, tuning::supervisor::UNSEEN_STEPS};

impl MotionFilter {
    /// Takes an object to be lost that has gone unseen for so long that nobody knows how far it has turned: linearisations would lead to any number
    /// of whole turns, and the motion with them.
    pub(super) fn lose_if_turn_is_unknown(&mut self, time: f64) {
        if !self.has_gone_unseen(time) {
            return;
        }
        let Some(track) = &self.track else { return };
        let (mut expected, mut history) = (track.clone(), self.history.clone());
        let seconds = time - self.clock.of_track;
        if predict(&self.settings, &mut expected, &mut history, seconds) && !expected.knows_turn() {
            self.phase = Phase::Lost;
        }
    }

    /// Follows the object to a frame, as [`follow`](Self::follow) does. One that has gone unseen and is not where it was expected has moved on as
    /// nobody has seen: it is lost, and looked for elsewhere. What it was expected to do says nothing of it any more.
    pub(super) fn follow_or_lose(&mut self, time: f64, outline: &Outline) -> Option<Outcome> {
        let before = (self.counts.rejected_in_a_row == 0 && self.has_gone_unseen(time)).then(|| self.clone());
        let outcome = self.follow(time, outline);
        let Some(mut lost) = before.filter(|_| !outcome.as_ref().is_some_and(Outcome::is_accepted)) else {
            return outcome.map(|outcome| self.look_elsewhere(outcome, time, outline));
        };
        lost.phase = Phase::Lost;
        // One frame alone says that the motion has changed: it must show all of the object.
        let found = lost.acquire(time, outline).filter(|found| found.is_accepted() && lost.shows_all(found));
        if found.is_some() {
            lost.motion_changed |= lost.phase == Phase::Acquiring;
            *self = lost;
            return found;
        }
        self.search_memory.budget = lost.search_memory.budget;
        self.phase = Phase::Lost;
        outcome
    }

    /// Whether a frame shows all of the object that it is usual to show.
    fn shows_all(&self, found: &Outcome) -> bool {
        let least = self.track.as_ref().map(|track| gate_of_all(&self.settings, track).smallest_agreement);
        least.is_some_and(|least| found.measurement.agreement >= least)
    }

    /// Whether the step to a frame of the object that is tracked is much longer than the one before, as where frames are missing.
    pub(super) fn has_gone_unseen(&self, time: f64) -> bool {
        let seconds = time - self.clock.of_track;
        self.phase == Phase::Tracking
            && self.track.as_ref().is_some_and(|track| seconds > UNSEEN_STEPS * track.belief().memory.step)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{drawn_curves::turning, supervisor::settings::FilterSettings};

    #[test]
    fn an_object_is_lost_once_it_has_gone_unseen_for_so_long_that_its_turn_is_unknown() {
        let egg = |t: f64| 1.0 + 0.2 * t.cos() + 0.1 * (3.0 * t).sin();
        let mut filter = MotionFilter::new(FilterSettings::default()).expect("settings");
        for frame in 0..2 {
            let step = filter.step(f64::from(frame) / 30.0, &turning(frame, 400, egg)).expect("increasing times");
            assert!(step.is_accepted(), "frame {frame}");
        }
        // In steps, which are about one unit of time: of two frames the turn in a step is known to a thousandth or so.
        let step = filter.track.as_ref().expect("a track").belief().memory.step;
        for (steps, phase) in [(1.0, Phase::Tracking), (10.0, Phase::Tracking), (1e5, Phase::Lost)] {
            let mut later = filter.clone();
            later.lose_if_turn_is_unknown(filter.clock.of_track + steps * step);
            assert_eq!(later.phase, phase, "{steps} steps");
        }
    }
}
