//! Symmetries that show once more frames have been seen than the one that the object was searched for in.
use std::f64::consts::PI;

use freeform_curve_fit::Outline;

use super::motion_filter::MotionFilter;
use crate::{
    search::symmetry_order,
    track::Track,
    tuning::{registration::LARGEST_NEAR_SYMMETRY, symmetry as tuning},
};

impl MotionFilter {
    /// Asks again whether the outline is symmetric, when its map has been cut anew from several frames. Errors of the first two frames may pass for what
    /// tells the teeth of a gear apart, so that it is followed with a turn by any number of them: its map, in which all teeth have come to lie upon each
    /// other, is symmetric then, whatever the body is.
    pub(super) fn ask_again_for_symmetry(&mut self, outline: &Outline) {
        if !tuning::ASKED_AGAIN.contains(&self.counts.accepted_by_track) || self.search_memory.symmetry > 1 {
            return;
        }
        let Some(shortest) = self.repeated.shortest_step().map(|step| step / self.seconds_per_unit()) else { return };
        let Some(track) = self.track.as_ref().filter(|track: &&Track| !track.turn_is_unseen()) else { return };
        let (pose, turn) = (*track.body_pose(), track.turn_in(shortest));
        // No tooth less is a smaller turn.
        if turn.abs() < PI / LARGEST_NEAR_SYMMETRY as f64 {
            return;
        }
        let symmetry = symmetry_order(track, outline, &pose, &mut self.frame);
        if symmetry > 1 {
            self.search_memory.symmetry = symmetry;
            self.turn_hypotheses.name_symmetry(symmetry, turn, shortest);
        }
    }
}
