//! The first frames of outlines of few points each, which are aligned together once there are enough of them.
use freeform_curve_fit::Outline;
use freeform_riccati::MotionModel;

use super::{
    initialisation::Remapper,
    motion_filter::{MotionFilter, Phase},
    window::{InitialisationWindow, Remapped},
};
use crate::{
    map::{CellsInCommon, TurnEvent},
    measurement::Frame,
    search::{Aligned, Landmarks, TimedPoints, aligned},
    track::Track,
    tuning::groupwise as tuning,
};

/// The frames of a track since it was begun, taken or not, as long as they may have to be aligned together: none otherwise.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct SparseFrames {
    /// In units of time.
    frames: Vec<(f64, Outline)>,
}

impl SparseFrames {
    /// Begins with the first frame of a track.
    pub(super) fn begin(model: MotionModel, time: f64, outline: &Outline) -> Self {
        let is_sparse = model <= MotionModel::Similarity && is_sparse(outline);
        Self { frames: if is_sparse { vec![(time, outline.clone())] } else { Vec::new() } }
    }

    /// Takes another unit of time.
    pub(super) fn divide_times(&mut self, unit: f64) {
        self.frames.iter_mut().for_each(|(time, _)| *time /= unit);
    }

    /// Keeps a frame that follows the others, if these are kept; whether they are to be aligned now.
    fn keep(&mut self, time: f64, outline: &Outline) -> bool {
        let Some((last, _)) = self.frames.last() else { return false };
        if !is_sparse(outline) {
            self.frames.clear();
        } else if time > *last {
            self.frames.push((time, outline.clone()));
        }
        tuning::OCCASIONS.contains(&self.frames.len())
    }
}

/// Whether an outline is seen as a whole by few points.
fn is_sparse(outline: &Outline) -> bool {
    matches!(outline, Outline::Closed(_)) && outline.point_count() < tuning::SPARSE && outline.pieces().count() == 1
}

impl MotionFilter {
    /// Keeps one of the first frames of an outline of few points, and aligns them together where a map begun with the first of them alone does not show
    /// the turn, or has not found the object in some.
    pub(super) fn keep_if_sparse(&mut self, time: f64, outline: &Outline) {
        if !self.search_memory.sparse.keep(time, outline) {
            return;
        }
        let all = std::mem::take(&mut self.search_memory.sparse.frames);
        let is_unseen = self.track.as_ref().is_none_or(Track::turn_is_unseen);
        if !is_unseen && self.counts.rejected_by_track == 0 {
            return;
        }
        if self.begin_with_aligned(&all).is_none() && all.len() < tuning::OCCASIONS[tuning::OCCASIONS.len() - 1] {
            self.search_memory.sparse.frames = all;
        }
    }

    /// Begins anew with frames that are aligned together, the last of them being that which was processed last. `None`, and nothing changes, where they
    /// are not, or do not fit the outline that they make.
    fn begin_with_aligned(&mut self, all: &[(f64, Outline)]) -> Option<()> {
        let (first_time, first) = all.first()?;
        let (model, frame) = (self.settings.model, &mut self.frame);
        let begun = Track::begin(model, first, self.settings.mask_pixel, frame)?;
        let timed = |(time, outline): &(f64, Outline)| timed_points(&begun, frame, *time, outline);
        let timed: Vec<TimedPoints> = all.iter().map(timed).collect();
        let Aligned { poses, contour } = aligned(&timed)?;
        let (mut track, _) = begun.recut_along(vec![(contour, true)], first, CellsInCommon::NotNeeded, frame)?;
        track.begin_as(&begun, first, frame);
        track.set_time_unit(self.clock.unit.unwrap_or(1.0));
        let (second, seconds) = (poses.get(1)?, timed.get(1)?.0 - first_time);
        track.set_motion(model.motion_between(second, seconds)?);
        let mut window = InitialisationWindow::begin(*first_time, first, &track);
        for (time, outline) in &all[1..] {
            window.keep(*time, outline, &track);
        }
        let remapper = Remapper { settings: &self.settings, window: &window, turns: self.turns_of_kept() };
        let frames = window.by_motion(&track);
        let Remapped { mut track, history, poses } =
            remapper.taken(Remapped::at_first(track), &frames, &mut self.frame)?;
        track.record_turn(TurnEvent::Confirmed);
        drop(frames);
        window.set_poses(poses);
        self.window = window;
        self.turn_hypotheses = Default::default();
        self.search_memory.landmarks = Landmarks::of(first);
        self.motion_changed = history.is_changing();
        let time = self.clock.last_frame;
        self.replace(track, history, time, Phase::Tracking);
        Some(())
    }
}

/// The points of a frame, normalised as a track has them.
fn timed_points(track: &Track, frame: &mut Frame, time: f64, outline: &Outline) -> TimedPoints {
    frame.load(outline, track.reference());
    (time, frame.points.clone())
}

#[cfg(feature = "serde")]
impl SparseFrames {
    /// Whether they are no more than are kept, and came one after the other, after `last` none.
    pub(super) fn is_valid(&self, last: f64) -> bool {
        let most = tuning::OCCASIONS[tuning::OCCASIONS.len() - 1];
        self.frames.len() < most
            && self.frames.iter().all(|(time, outline)| time.is_finite() && *time <= last && is_sparse(outline))
            && self.frames.is_sorted_by(|(a, _), (b, _)| a < b)
    }
}
