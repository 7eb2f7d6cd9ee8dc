//! Turns that look like the one taken, named later than by the search that it was taken in.
use std::f64::consts::PI;

use freeform_curve_fit::Outline;

use super::{gates::Turns, motion_filter::MotionFilter};
use crate::{
    search::{TurnCentre, symmetry_order},
    tuning::{registration::LARGEST_NEAR_SYMMETRY, symmetry as tuning},
};

impl MotionFilter {
    /// In which turns the outline explains a frame. Others that are followed are not searched for nearby: the one that is would rule them out.
    pub(super) fn turns(&self) -> Turns {
        let is_followed_alone = self.turn_hypotheses.followed().next().is_none();
        match self.search_memory.symmetry {
            1 if self.turn_hypotheses.rival_turns().is_empty() => Turns::One,
            order if order > 1 && is_followed_alone && !self.turn_hypotheses.are_doubtful() => {
                Turns::Symmetric { order }
            }
            _ => Turns::Several,
        }
    }

    /// As [`turns`](Self::turns), of frames that have been taken once: where none of them needed a search nearby, cells cut anew must not make one
    /// necessary.
    pub(super) fn turns_of_kept(&self) -> Turns {
        if self.motion_changed || self.history.is_changing() { self.turns() } else { Turns::Several }
    }

    /// Asks again whether the outline is symmetric, when its map has been cut anew from several frames. Errors of the first two frames may pass for what
    /// tells the teeth of a gear apart, so that it is followed with a turn by any number of them: its map, in which all teeth have come to lie upon each
    /// other, is symmetric then, whatever the body is.
    pub(super) fn ask_again_for_symmetry(&mut self, outline: &Outline) {
        if !tuning::ASKED_AGAIN.contains(&self.counts.accepted_by_track) || self.search_memory.symmetry > 1 {
            return;
        }
        let Some((turn, shortest)) = self.turn_in_shortest_step() else { return };
        // A turn of less than half a tooth, of however many, is the smallest that looks like it.
        let Some(track) = self.track.as_ref().filter(|_| turn.abs() >= PI / LARGEST_NEAR_SYMMETRY as f64) else {
            return;
        };
        let pose = track.body_pose();
        let first = track.first_of_compared(outline, pose, &mut self.frame);
        let symmetry = symmetry_order(track, &first, (pose, TurnCentre::Found), &mut self.frame);
        if symmetry > 1 {
            self.search_memory.symmetry = symmetry;
            self.turn_hypotheses.name_symmetry(symmetry, turn, shortest);
        }
    }

    /// Of two turns that look alike the smaller is taken, so that no frames tell one of more than half a circle between them, or of half the angle of a
    /// symmetry.
    pub(super) fn doubt_large_turns(&mut self) {
        if let Some((turn, shortest)) = self.turn_in_shortest_step() {
            self.turn_hypotheses.doubt_more_than_half(turn, shortest);
        }
    }

    /// The turn that the motion makes in the shortest step between frames, rad, anticlockwise where y points up, and that step; `None` where the outline
    /// does not show its turn.
    fn turn_in_shortest_step(&self) -> Option<(f64, f64)> {
        let track = self.track.as_ref().filter(|track| !track.turn_is_unseen())?;
        let shortest = self.repeated.shortest_step()? / self.seconds_per_unit();
        Some((track.turn_in(shortest), shortest))
    }
}
