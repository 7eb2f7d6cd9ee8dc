//! Frames of a window taken one by one on a map cut anew.
use super::{
    gates::Turns,
    settings::FilterSettings,
    tracking::advance_again,
    window::{InitialisationWindow, Remapped},
};
use crate::{
    map::CellsInCommon,
    measurement::Frame,
    track::{PlacedFrame, Track},
};

/// Cuts maps anew from the frames of a window.
#[derive(Clone, Copy)]
pub(super) struct Remapper<'a> {
    pub(super) settings: &'a FilterSettings,
    pub(super) window: &'a InitialisationWindow,
    pub(super) turns: Turns,
}

impl Remapper<'_> {
    /// A rival of a track that was begun anew, at the first frame on the same cells: each of its own would be as many times the work, and a finer
    /// one would win by that alone. Where they have not begun alike it has cells of its own all the same.
    pub(super) fn on_map_of(
        &self,
        begun: &Track,
        (rival, in_common): (&Track, CellsInCommon),
        buffers: &mut Frame,
    ) -> Option<Remapped> {
        let frames = self.window.by_motion(rival);
        let begun = begun.with_motion_of(rival).or_else(|| {
            let (mut begun, _) = rival.recut(&frames, (1, in_common), buffers)?;
            begun.begin_as(rival, frames.first()?.outline, buffers);
            Some(begun)
        })?;
        Some(Remapped::at_first(begun))
    }

    /// One after the next of the frames kept.
    pub(super) fn taken_next(
        &self,
        remapped: Remapped,
        frames: &[PlacedFrame<'_>],
        buffers: &mut Frame,
    ) -> Option<Remapped> {
        let next = remapped.frames_taken();
        self.taken(remapped, frames.get(next.checked_sub(1)?..=next)?, buffers)
    }

    /// One that stands at the first of some frames, after all of them.
    pub(super) fn taken(
        &self,
        remapped: Remapped,
        frames: &[PlacedFrame<'_>],
        buffers: &mut Frame,
    ) -> Option<Remapped> {
        let Remapped { track, mut history, mut poses } = remapped;
        let track = track.replayed(frames, buffers, |track, frame, seconds, outline| {
            frame.load(outline, track.reference());
            let outcome = advance_again(self.settings, (track, frame), &mut history, seconds, self.turns);
            poses.push(*track.body_pose());
            outcome.is_some_and(|outcome| outcome.is_accepted())
        })?;
        Some(Remapped { track, history, poses })
    }
}
