//! Maps begun from a frame, and begun again where that frame did not show the object.
use freeform_curve_fit::Outline;

use super::{
    counts::Counts,
    error::FilterError,
    motion_change::MotionHistory,
    motion_filter::{MotionFilter, Phase},
    settings::FilterSettings,
    sparse_frames::SparseFrames,
    turn_hypotheses::TurnHypotheses,
    window::InitialisationWindow,
};
use crate::{
    track::Track,
    tuning::{map::FEWEST_POINTS, supervisor as tuning},
};

impl MotionFilter {
    /// Begins a track with a first frame.
    pub(super) fn start(&mut self, time: f64, outline: &Outline) -> Result<(), FilterError> {
        let too_few = FilterError::TooFewPoints { found: outline.point_count(), needed: FEWEST_POINTS };
        let FilterSettings { model, mask_pixel, .. } = self.settings;
        let mut track = Track::begin(model, outline, mask_pixel, &mut self.frame).ok_or(too_few)?;
        track.set_time_unit(self.seconds_per_unit());
        self.search_memory.begin(outline);
        self.begin_window(time, outline, &track);
        self.replace(track, MotionHistory::default(), time, Phase::Acquiring);
        self.clock.last_frame = time;
        (self.counts.rejected_in_a_row, self.counts.hidden_in_a_row) = (0, 0);
        self.search_memory.sparse = SparseFrames::begin(model, self.segment(), (time, outline));
        Ok(())
    }

    /// Forgets what was known of hypotheses and changes, and keeps a frame as the first of a new track.
    pub(super) fn begin_window(&mut self, time: f64, outline: &Outline, track: &Track) {
        self.window = InitialisationWindow::begin(time, outline, track);
        self.turn_hypotheses = TurnHypotheses::default();
        self.motion_changed = false;
        self.counts.begin_track();
    }

    /// Whether all that is known rests on one step between two frames that show parts of the outline: such parts may fit in a wrong pose, and no third
    /// frame has confirmed it.
    pub(super) fn rests_on_two_parts(&self) -> bool {
        let shows_part = self.track.as_ref().is_some_and(Track::was_begun_with_part);
        shows_part && self.counts.accepted_by_track <= tuning::UNCONFIRMED
    }

    /// Whether a frame shows enough to confirm such a step, or to contradict it: as much as a track is begun with.
    pub(super) fn shows_enough(&self, outline: &Outline) -> bool {
        outline.point_count() >= FEWEST_POINTS || !self.rests_on_two_parts()
    }

    /// Begins again with a frame in which the object was found elsewhere than expected, where nothing has [confirmed](Self::rests_on_two_parts) the step
    /// before.
    pub(super) fn begin_unrelated(&mut self, time: f64, outline: &Outline) {
        self.counts.add_rejected();
        if self.start(time, outline).is_ok() {
            self.counts.restarts += 1;
        } else {
            self.phase = Phase::Lost;
        }
    }

    /// Begins anew with a second frame that shows far more of the object than the first, which showed a part of it that was not found on the second: what
    /// comes in over the edge of the picture shows a corner first. Where that part was is all that the first frame has told. Whether it begins so.
    pub(super) fn begin_with_more(&mut self, time: f64, outline: &Outline) -> bool {
        let Counts { accepted_by_track, rejected_by_track, .. } = self.counts;
        let is_second = self.phase == Phase::Acquiring && (accepted_by_track, rejected_by_track) == (1, 0);
        if !is_second || !self.track.as_ref().is_some_and(Track::was_begun_with_part) {
            return false;
        }
        let part = self.window.first().map(Outline::length);
        let is_begun =
            part.is_some_and(|part| outline.length() > tuning::FAR_MORE * part) && self.start(time, outline).is_ok();
        if is_begun {
            self.counts.begun_with_more += 1;
            self.counts.accepted_in_recording += 1;
        }
        is_begun
    }

    /// After a rejected frame: look elsewhere, or begin again.
    pub(super) fn fall_back(&mut self, time: f64, outline: &Outline) {
        let Counts { rejected_in_a_row, accepted_by_track, rejected_by_track, .. } = self.counts;
        // Few frames that more speak against than for did not show the object.
        let is_outvoted = rejected_in_a_row >= self.settings.patience
            && accepted_by_track <= tuning::FEW_FRAMES
            && rejected_by_track > accepted_by_track;
        let give_up = match self.phase {
            Phase::Acquiring => rejected_in_a_row >= tuning::FALSE_START && self.may_search(),
            _ => rejected_in_a_row >= tuning::GIVEN_UP || is_outvoted,
        };
        let is_alone = self.phase == Phase::Acquiring && accepted_by_track == 1;
        if is_alone && !give_up && rejected_in_a_row < tuning::FALSE_START {
            self.search_memory.unfound.push((time, outline.clone()));
        }
        // Any frame may be wrong, as the first was: then the next one is waited for.
        let is_wrong = is_alone && rejected_in_a_row == tuning::FALSE_START && self.shows_another(time, outline);
        if give_up && !is_wrong && self.start(time, outline).is_ok() {
            self.counts.restarts += 1;
            self.counts.fruitless_starts += 1;
        } else if self.phase == Phase::Tracking && rejected_in_a_row >= self.settings.patience {
            self.phase = Phase::Lost;
        }
    }

    /// Whether the next frame is searched for the object. A start is worth a few searches, or none.
    pub(super) fn may_search(&self) -> bool {
        let is_start_over = self.phase == Phase::Acquiring && self.counts.rejected_in_a_row >= tuning::FALSE_START;
        self.search_memory.budget.has(if is_start_over { tuning::FALSE_START } else { 1 })
    }

    /// Whether a frame shows something else than those before it in which the object of the first has not been found: they agree with each
    /// other and not with it, so that it is no frame to begin again with. Where nothing is found again and again, that is not looked into.
    fn shows_another(&mut self, time: f64, outline: &Outline) -> bool {
        if self.counts.fruitless_starts >= tuning::MOST_FRUITLESS || !self.search_memory.budget.has(tuning::FALSE_START)
        {
            return false;
        }
        // One that begins anew with a frame is not of the same object either.
        let takes = |begun: &mut Self, time: f64, outline: &Outline| {
            begun.process(time, outline).1.is_none() && begun.counts.accepted_by_track > 1
        };
        let mut do_others_agree = false;
        let unfound = self.search_memory.unfound.clone();
        for (number, (begun_at, first)) in unfound.iter().enumerate() {
            let mut begun = self.clone();
            if begun.start(*begun_at, first).is_err() {
                continue;
            }
            for (time, outline) in &unfound[number + 1..] {
                self.search_memory.budget.spend();
                do_others_agree |= takes(&mut begun, *time, outline);
            }
            self.search_memory.budget.spend();
            if takes(&mut begun, time, outline) {
                return false;
            }
        }
        do_others_agree
    }
}

#[cfg(feature = "serde")]
impl MotionFilter {
    /// Whether the frames that the object has not been found in are no more than are kept, and came one after the other, after the first.
    pub(super) fn unfound_are_valid(&self) -> bool {
        (self.search_memory.unfound.is_empty() || self.phase == Phase::Acquiring && self.clock.unit.is_some())
            && self.search_memory.unfound.len() < tuning::FALSE_START
            && self.search_memory.unfound.iter().all(|(time, _)| time.is_finite() && *time <= self.clock.last_frame)
            && self.search_memory.unfound.is_sorted_by(|(a, _), (b, _)| a < b)
    }
}
