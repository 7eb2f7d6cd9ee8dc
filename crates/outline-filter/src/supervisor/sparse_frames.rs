//! The first frames of outlines of few points each, which are aligned together once there are enough of them.
use freeform_curve_fit::Outline;
#[cfg(feature = "serde")]
use freeform_estimate::StateFormat;
use freeform_riccati::MotionModel;

use super::{
    gates::Turns,
    motion_filter::{MotionFilter, Phase},
    remapper::Remapper,
    turn_hypotheses::TurnHypotheses,
    window::{InitialisationWindow, Remapped},
};
use crate::{
    map::{CellsInCommon, TurnEvent, TurnEvidence},
    search::{Aligned, TimedPoints, aligned},
    track::Track,
    tuning::groupwise as tuning,
};

/// Frames after which they are aligned for the last time.
const MOST_FRAMES: usize = tuning::OCCASIONS[tuning::OCCASIONS.len() - 1];

/// The frames of a track since it was begun, taken or not, as long as they may have to be aligned together: none otherwise.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct SparseFrames {
    /// In units of time.
    frames: Vec<(f64, Outline)>,
    /// The [segment](MotionFilter::segment) that they began.
    segment: usize,
}

impl SparseFrames {
    /// Begins with the first frame of a track.
    pub(super) fn begin(model: MotionModel, segment: usize, (time, outline): (f64, &Outline)) -> Self {
        let frames = if may_align(model, outline) { vec![(time, outline.clone())] } else { Vec::new() };
        Self { frames, segment }
    }

    /// Takes another unit of time.
    pub(super) fn divide_times(&mut self, unit: f64) {
        self.frames.iter_mut().for_each(|(time, _)| *time /= unit);
    }

    /// Keeps a frame that follows the others, if these are kept; whether they are to be aligned now.
    fn keep(&mut self, model: MotionModel, time: f64, outline: &Outline) -> bool {
        let Some((last, _)) = self.frames.last() else { return false };
        if !may_align(model, outline) {
            self.frames.clear();
        } else if time > *last {
            self.frames.push((time, outline.clone()));
        }
        tuning::OCCASIONS.contains(&self.frames.len())
    }
}

/// Whether an outline is seen as a whole by few points, and moves as a rigid one does over some frames.
fn may_align(model: MotionModel, outline: &Outline) -> bool {
    let is_whole = matches!(outline, Outline::Closed(_)) && outline.pieces().count() == 1;
    model <= MotionModel::Similarity && is_whole && outline.point_count() < tuning::SPARSE
}

impl MotionFilter {
    /// Keeps one of the first frames of an outline of few points, and aligns them together where a map begun with the first of them alone does not
    /// show the turn, or has not found the object in some. What was said of a frame stays said.
    pub(super) fn keep_if_sparse(&mut self, time: f64, outline: &Outline) {
        if !self.search_memory.sparse.keep(self.settings.model, time, outline) {
            return;
        }
        let all = std::mem::take(&mut self.search_memory.sparse);
        let evidence = self.track.as_ref().map(Track::turn_evidence);
        let is_unseen = self.track.as_ref().is_none_or(Track::turn_is_unseen);
        if evidence == Some(TurnEvidence::Refuted) || !is_unseen && self.counts.rejected_by_track == 0 {
            return;
        }
        if self.begin_with_aligned(&all).is_none() && all.frames.len() < MOST_FRAMES {
            self.search_memory.sparse = all;
        }
    }

    /// Begins anew with frames that are aligned together, the last of them being that which was processed last. `None`, and nothing changes, where
    /// they are not, or do not fit the outline that they make.
    fn begin_with_aligned(&mut self, SparseFrames { frames: all, segment }: &SparseFrames) -> Option<()> {
        let (first_time, first) = all.first()?;
        let (model, frame) = (self.settings.model, &mut self.frame);
        let begun = Track::begin(model, first, self.settings.mask_pixel, frame)?;
        // Errors of points that are rounded stay with the pixels, and would make the smoothest contour where nothing turns.
        if begun.noise().rounding().pixel() > 0.0 {
            return None;
        }
        let timed = |(time, outline): &(f64, Outline)| {
            frame.load(outline, begun.reference());
            (*time, frame.points.clone())
        };
        let timed: Vec<TimedPoints> = all.iter().map(timed).collect();
        let Aligned { poses, contour } = aligned(&timed)?;
        let (mut track, _) = begun.recut_along(vec![(contour, true)], first, CellsInCommon::NotNeeded, frame)?;
        track.begin_as(&begun, first, frame);
        track.set_time_unit(self.seconds_per_unit());
        let (second, seconds) = (poses.get(1)?, timed.get(1)?.0 - first_time);
        track.set_motion(model.motion_between(second, seconds)?);
        let mut window = InitialisationWindow::begin(*first_time, first, &track);
        for (time, outline) in &all[1..] {
            window.keep(*time, outline, &track);
        }
        let remapper = Remapper { settings: &self.settings, window: &window, turns: Turns::One };
        let frames = window.by_motion(&track);
        let Remapped { mut track, history, poses } =
            remapper.taken(Remapped::at_first(track), &frames, &mut self.frame)?;
        track.record_turn(TurnEvent::Confirmed);
        drop(frames);
        window.set_poses(poses);
        self.window = window;
        self.turn_hypotheses = TurnHypotheses::default();
        self.search_memory.begin(first);
        self.counts.begin_with(all.len());
        // If a restart among these frames has counted the segment up, poses now refer to an earlier frame than since then: a new number.
        self.counts.begun_with_more += usize::from(self.segment() != *segment);
        self.motion_changed = history.is_changing();
        let time = self.clock.last_frame;
        self.replace(track, history, time, Phase::Tracking);
        Some(())
    }
}

#[cfg(feature = "serde")]
impl SparseFrames {
    /// Whether they are such frames of a model, no more than are kept, and came one after the other up to the `last` of all.
    pub(super) fn is_valid(&self, model: MotionModel, last: f64) -> bool {
        self.frames.len() < MOST_FRAMES
            && self.segment < StateFormat::MOST_COUNTED
            && self.frames.iter().all(|(time, outline)| time.is_finite() && *time <= last && may_align(model, outline))
            && self.frames.is_sorted_by(|(a, _), (b, _)| a < b)
    }
}

#[cfg(all(test, feature = "serde"))]
mod tests {
    use super::*;
    use crate::drawn_curves::turning;

    #[test]
    fn frames_that_could_not_have_been_kept_are_refused() {
        let egg = |t: f64| 1.0 + 0.2 * t.cos();
        let frame = |number: u32, points: u32| (f64::from(number), turning(number, points, egg));
        let of = |frames: Vec<(f64, Outline)>| SparseFrames { frames, segment: 0 };
        let few: Vec<_> = (0..5).map(|number| frame(number, 12)).collect();
        let is_valid = |frames: Vec<_>, model| of(frames).is_valid(model, 20.0);
        assert!(is_valid(few.clone(), MotionModel::Rigid) && is_valid(Vec::new(), MotionModel::Affine));
        assert!(!is_valid(few.clone(), MotionModel::Affine));
        assert!(!is_valid(few.iter().rev().cloned().collect(), MotionModel::Rigid));
        assert!(
            !is_valid(vec![frame(0, 24)], MotionModel::Rigid) && !is_valid(vec![frame(21, 12)], MotionModel::Rigid)
        );
        assert!(!is_valid((0..16).map(|number| frame(number, 12)).collect(), MotionModel::Rigid));
    }
}
