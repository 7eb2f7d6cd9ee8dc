//! The initialisation window: the frames that a track was begun from, and its map cut anew from them.
use freeform_curve_fit::Outline;
use nalgebra::Affine2;

use super::{
    motion_change::MotionHistory,
    motion_filter::{MotionFilter, Phase},
    remapper::Remapper,
    taken_ahead::{Hypothesis, TakenAhead},
    window::{Ahead, Draft, Due, Measured, Placed, Remapped, Remapping},
};
use crate::{
    map::{CellsInCommon, TurnEvent, TurnEvidence},
    search::Landmarks,
    track::Track,
    tuning::{remapping as tuning, supervisor::MOST_BEGUN_IN_VAIN},
};

impl MotionFilter {
    /// Keeps one of the first frames, and cuts the map anew once there are enough of them, or where the motion seems to change, which
    /// may be what coarse cells make of it. No frame has more of that to do than one cut, or than measuring a few of the frames kept.
    pub(super) fn keep(&mut self, time: f64, outline: &Outline, changes: bool) {
        let Some(track) = &mut self.track else { return };
        if track.turn_evidence() == TurnEvidence::Refuted {
            // The map is not cut anew: it would seem to show the turn again.
            self.window.end();
            return;
        }
        if self.phase != Phase::Tracking {
            // Found again somewhere: what was seen before has come there by what nobody knows.
            if track.begin_here() {
                self.window.begin_anew(time, outline, track);
            } else {
                self.window.end();
            }
            return;
        }
        let is_due = self.window.keep(time, outline, track);
        let (remapping, ahead) = (self.window.take_remapping(), std::mem::take(self.window.taken_ahead_mut()));
        let is_idle = matches!(remapping, Remapping::Idle);
        if is_idle && !(is_due || changes) || !self.window.are_several() {
            return;
        }
        if track.turn_is_unseen() {
            self.begin_with_turn(outline);
        } else {
            let turn = self.turn_hypotheses.present_turn();
            let next = match remapping {
                Remapping::Drafted(draft) if draft.turn == turn => self.measure(*draft),
                Remapping::Measured(measured) if measured.begun.turn == turn => {
                    let most = frames_at_once(1 + self.turn_hypotheses.followed().count());
                    self.go_on(*measured, most, ahead)
                }
                Remapping::Placed(placed) if placed.turn == turn => Remapping::Due(Due::Cutting(placed)),
                Remapping::Again { cuts, in_common } => Remapping::Due(Due::Placing { turn, cuts, in_common }),
                // The map is cut for another hypothesis where they have been exchanged meanwhile.
                Remapping::Placed(_)
                | Remapping::Drafted(_)
                | Remapping::Measured(_)
                | Remapping::Due(_)
                | Remapping::Idle => {
                    Remapping::Due(Due::Placing { turn, cuts: 0, in_common: CellsInCommon::NotNeeded })
                }
            };
            self.window.set_remapping(next);
            if !self.leaves_work() {
                self.do_what_is_due();
            }
        }
        self.end_window_unless_few();
    }

    /// Forgets the frames kept unless they are in use, or more of them would make the map better.
    pub(super) fn end_window_unless_few(&mut self) {
        self.window.end_unless_few(self.track.as_ref().map_or(0, Track::cell_count));
    }

    /// Whether the motion changes, as is seen or as the settings say.
    fn may_change(&self) -> bool {
        self.history.is_changing() || !self.settings.process_noise.is_none()
    }

    /// Whether the frames kept must have cells in common: where the motion changes, and where they show that it does before it is seen to.
    fn cells_in_common_of_kept(&mut self) -> CellsInCommon {
        let Some(track) = self.track.as_ref().filter(|_| !self.may_change()) else {
            return CellsInCommon::InEveryFrame;
        };
        let [by_motion, as_found] = [self.window.by_motion(track), self.window.as_found()];
        let moves_otherwise = track.explains_better(&as_found, &by_motion, &mut self.frame);
        if moves_otherwise { CellsInCommon::InEveryFrame } else { CellsInCommon::NotNeeded }
    }

    /// Puts the points of the first frames in order, for the hypothesis of a turn, after so many cuts, for a map to be cut along them: where there are
    /// rivals, after the next frame.
    pub(super) fn place(&mut self, (turn, cuts): (f64, usize), in_common: CellsInCommon) -> Remapping {
        let hypotheses = 1 + self.turn_hypotheses.followed().count();
        if hypotheses > 1 && kept_once_measured(self.window.len(), hypotheses) > tuning::MOST_KEPT {
            return Remapping::Idle;
        }
        // The motion that has been seen to change in these frames has, whatever a better map says.
        let in_common = match in_common {
            CellsInCommon::NotNeeded => self.cells_in_common_of_kept(),
            CellsInCommon::InEveryFrame | CellsInCommon::InSomeFrames => in_common,
        };
        let Some(track) = &self.track else { return Remapping::Idle };
        let frames = match in_common {
            CellsInCommon::NotNeeded => self.window.by_motion(track),
            CellsInCommon::InEveryFrame | CellsInCommon::InSomeFrames => self.window.as_found(),
        };
        let Some(runs) = track.points_along(&frames, 1, &mut self.frame) else { return Remapping::Idle };
        let placed = Box::new(Placed { runs, turn, cuts, in_common });
        if hypotheses == 1 { Remapping::Due(Due::Cutting(placed)) } else { Remapping::Placed(placed) }
    }

    /// Cuts the map anew along points in order.
    pub(super) fn cut(&mut self, Placed { runs, turn, cuts, in_common }: Placed) -> Remapping {
        let placed = self.track.as_ref().zip(self.window.first());
        let cut = placed.and_then(|(track, first)| track.recut_along(runs, first, in_common, &mut self.frame));
        let draft = |(track, in_common)| Remapping::Drafted(Box::new(Draft { track, turn, cuts: cuts + 1, in_common }));
        cut.map_or(Remapping::Idle, draft)
    }

    /// Measures the frames kept on cells cut anew.
    pub(super) fn measure(&mut self, draft: Draft) -> Remapping {
        let Draft { track, turn, cuts, in_common } = draft;
        let Some(track) = self.begun_on(track) else { return Remapping::Idle };
        let hypotheses = 1 + self.turn_hypotheses.followed().count();
        if hypotheses == 1 {
            let ahead = Ahead::Taking(Box::new(Remapped::at_first(track)));
            return self.exchange_for(ahead, (cuts, in_common));
        }
        let present = Remapped::at_first(track.clone());
        let measured = Measured { begun: Draft { track, turn, cuts, in_common }, present, rivals: Vec::new() };
        self.go_on(measured, frames_at_once(hypotheses) - tuning::FRAMES_OF_BEGINNING, TakenAhead::default())
    }

    /// Takes so many more of the frames kept on the new cells, at most.
    pub(super) fn take_kept(&mut self, remapped: Remapped, most: usize) -> Option<Remapped> {
        let remapper = Remapper { settings: &self.settings, window: &self.window, turns: self.turns_of_kept() };
        let frames = self.window.by_motion(&remapped.track);
        let next = remapped.frames_taken();
        let end = next.saturating_add(most).min(frames.len());
        remapper.taken(remapped, frames.get(next.checked_sub(1)?..end)?, &mut self.frame)
    }

    /// Takes so many of the frames kept on the new cells, those first that have been taken `ahead`, always with the hypothesis that has taken the
    /// fewest, and begins one more rival. Once all have taken all frames they are exchanged at once: one alone would win by its finer cells.
    fn go_on(
        &mut self,
        Measured { begun, mut present, mut rivals }: Measured,
        most: usize,
        mut ahead: TakenAhead,
    ) -> Remapping {
        let in_common = begun.in_common;
        let remapper = Remapper { settings: &self.settings, window: &self.window, turns: self.turns_of_kept() };
        let frame = &mut self.frame;
        let frames = self.window.by_motion(&present.track);
        rivals.retain(|(turn, _)| self.turn_hypotheses.followed().any(|(of, _)| of == *turn));
        let mut waiting = self.turn_hypotheses.followed().filter(|(turn, _)| rivals.iter().all(|(of, _)| of != turn));
        let (next, is_last) = (waiting.next(), waiting.next().is_none());
        drop(waiting);
        if let Some((turn, rival)) = next {
            rivals.push((turn, remapper.on_map_of(&begun.track, (rival, in_common), frame)));
        }
        for _ in 0..most {
            let of_rivals = rivals.iter_mut().filter(|(_, rival)| rival.is_some());
            let behind = of_rivals.min_by_key(|(_, rival)| rival.as_ref().map(Remapped::frames_taken));
            match behind {
                Some((turn, rival)) if rival.as_ref().map(Remapped::frames_taken) < Some(present.frames_taken()) => {
                    let (of, turns) = (Hypothesis::Rival { turn: *turn }, remapper.turns);
                    let next = |rival| remapper.taken_next(rival, &frames, frame);
                    *rival = rival.take().and_then(|rival| ahead.take_or(of, turns, rival, next));
                }
                _ if present.frames_taken() < frames.len() => {
                    let (of, turns) = (Hypothesis::Present, remapper.turns);
                    let next = ahead.take_or(of, turns, present, |track| remapper.taken_next(track, &frames, frame));
                    let Some(next) = next else { return Remapping::Idle };
                    present = next;
                }
                _ => break,
            }
        }
        let has_all = |remapped: &Remapped| remapped.frames_taken() >= frames.len();
        let have_all = is_last && has_all(&present) && rivals.iter().all(|(_, r)| r.as_ref().is_none_or(has_all));
        if !have_all {
            return Remapping::Measured(Box::new(Measured { begun, present, rivals }));
        }
        self.unless_astray(present)
            .map_or(Remapping::Idle, |present| self.exchange(present, rivals, (begun.cuts, in_common)))
    }

    /// Exchanges the track, and its rivals with it, for those on cells cut anew, and looks for changes of the motion once more: what was taken for
    /// one may have been what coarse cells left. Better aligned frames make a better map, which aligns them better, so that it is cut again unless
    /// the pose has settled, or more frames are kept than rivals soon catch up with.
    pub(super) fn exchange(
        &mut self,
        mut present: Remapped,
        mut rivals: Vec<(f64, Option<Remapped>)>,
        (cuts, in_common): (usize, CellsInCommon),
    ) -> Remapping {
        let Some(track) = &self.track else { return Remapping::Idle };
        if !present.track.turn_leaps(track.body_pose(), 0.0) {
            present.track.go_on_with_turn_profile_of(track);
        }
        self.turn_hypotheses.remap(|turn| {
            let of_turn = rivals.iter_mut().find(|(of, _)| *of == turn);
            of_turn.and_then(|(_, rival)| rival.take()).map(|rival| rival.track)
        });
        let has_settled = (present.track.body_pose() - track.body_pose()).norm() < present.track.sigma();
        self.track = Some(present.track);
        self.motion_changed = present.history.is_changing();
        self.history = present.history;
        if !self.history.change.is_seen() {
            // What the first few frames seem to say of it counts for nothing.
            self.history.change = Default::default();
        }
        self.window.set_poses(present.poses);
        // Each cut with rivals is from a multiple of the frames of the one before, as more are kept while these are measured.
        let are_many = self.window.len() > tuning::OCCASIONS[1] && self.turn_hypotheses.followed().next().is_some();
        if has_settled || are_many || cuts >= tuning::MOST_CUTS {
            Remapping::Idle
        } else {
            Remapping::Again { cuts, in_common }
        }
    }

    /// Begins anew, in the same body frame, with a frame that shows the turn at last: the earlier ones have turned by what nobody
    /// knows.
    pub(super) fn begin_with_turn(&mut self, outline: &Outline) {
        let Some(track) = &mut self.track else { return };
        if track.turn_evidence().times_begun().0 >= MOST_BEGUN_IN_VAIN {
            // It is hidden anew, as a turn that is refuted.
            track.show_turn();
            track.refute_turn();
            self.turn_hypotheses = Default::default();
            self.window.end();
            return;
        }
        let Some(new) = track.begun_anew(outline, &mut self.frame) else {
            track.hide_turn();
            track.record_turn(TurnEvent::NotBegun);
            return;
        };
        let to_body: Option<Affine2<f64>> = nalgebra::try_convert(new.pose().inverse());
        self.search_memory.landmarks = to_body.and_then(|to_body| Some(Landmarks::of(outline)?.moved(&to_body)));
        self.begin_window(self.clock.last_frame, outline, &new);
        self.replace(new, MotionHistory::default(), self.clock.of_track, Phase::Acquiring);
        self.counts.begun_with_more += 1;
    }
}

/// Frames kept that are taken on new cells in one step, by the number of hypotheses which all take the frame of that step besides.
pub(super) fn frames_at_once(hypotheses: usize) -> usize {
    tuning::MEASURED_AT_ONCE.saturating_sub(hypotheses).max(hypotheses + tuning::FRAMES_OF_BEGINNING)
}

/// Frames that will be kept once so many hypotheses have caught up on those kept now, as one more comes in each step.
fn kept_once_measured(frames: usize, hypotheses: usize) -> usize {
    let caught_up = frames_at_once(hypotheses) - hypotheses;
    frames + (frames * hypotheses).div_ceil(caught_up)
}

#[cfg(test)]
mod tests {
    use freeform_riccati::MotionModel;

    use super::*;
    use crate::{
        drawn_curves::{outline, polar, turning},
        supervisor::settings::FilterSettings,
    };

    #[test]
    fn frames_are_not_kept_for_ever_where_the_turn_stays_unknown() {
        let outline = outline(100, |angle| polar(1.0, angle));
        let mut filter =
            MotionFilter::new(FilterSettings { model: MotionModel::Rigid, ..Default::default() }).expect("settings");
        for frame in 0..100 {
            filter.step(f64::from(frame) / 30.0, &outline).expect("increasing times");
            assert!(filter.window.len() <= tuning::OCCASIONS[2], "frame {frame}");
        }
        assert!(filter.track.as_ref().is_some_and(Track::turn_is_unseen));
    }

    #[test]
    fn a_map_is_cut_after_a_frame_and_measured_before_the_next() {
        let egg = |t: f64| 1.0 + 0.2 * t.cos() + 0.1 * (3.0 * t).sin();
        let mut filter = MotionFilter::new(FilterSettings::default()).expect("settings");
        for frame in 0..6 {
            let before = filter.track.as_ref().map_or(0, Track::cell_count);
            let step = filter.step(f64::from(frame) / 30.0, &turning(frame, 400, egg)).expect("increasing times");
            assert!(step.is_accepted(), "frame {frame}");
            assert_eq!(
                filter.window.drafted_for(filter.turn_hypotheses.present_turn()).is_some(),
                frame == 3,
                "frame {frame}"
            );
            let is_finer = before > 0 && filter.track.as_ref().is_some_and(|track| track.cell_count() > before);
            assert_eq!(is_finer, frame == 4, "frame {frame}: {before} cells before");
        }
        assert_eq!(filter.window.len(), 0);
    }

    #[test]
    fn rivals_are_measured_on_the_cells_of_the_present_track() {
        // Outlines of two lobes, and of four, whose rivals take more frames to be measured.
        for (lobes, frames) in [(2.0, 8), (4.0, 18)] {
            let lobed = |t: f64| 1.0 + 0.2 * (lobes * t).cos();
            let mut filter = MotionFilter::new(FilterSettings::default()).expect("settings");
            let mut counts = Vec::new();
            for frame in 0..frames {
                filter.step(f64::from(frame) / 30.0, &turning(frame, 400, lobed)).expect("increasing times");
                let Some(track) = &filter.track else { continue };
                let rivals: Vec<_> = filter.turn_hypotheses.followed().map(|(_, rival)| rival.cell_count()).collect();
                // All are exchanged at once.
                assert!(rivals.iter().all(|cells| *cells == track.cell_count()), "frame {frame}: {rivals:?}");
                counts.extend(rivals);
            }
            assert!(counts.first() < counts.last(), "{lobes} lobes, never cut anew: {counts:?}");
        }
    }

    #[test]
    fn few_frames_are_kept_while_several_hypotheses_are_measured_on_new_cells() {
        // With 40 points there are occasions up to the last, and each cut could be followed by another.
        for (lobes, points, hypotheses, most) in [(4.0, 400, 4, 16), (8.0, 400, 5, 16), (4.0, 40, 4, 90)] {
            let lobed = |t: f64| 1.0 + 0.2 * (lobes * t).cos();
            let mut filter = MotionFilter::new(FilterSettings::default()).expect("settings");
            let (mut kept, mut followed, mut cells) = (0, 0, Vec::new());
            for frame in 0..100 {
                filter.step(f64::from(frame) / 30.0, &turning(frame, points, lobed)).expect("increasing times");
                kept = kept.max(filter.window.len());
                followed = followed.max(1 + filter.turn_hypotheses.followed().count());
                cells.extend(filter.track.as_ref().map(Track::cell_count));
            }
            assert_eq!(followed, hypotheses, "{lobes} lobes, {points} points");
            assert!(kept <= most && filter.window.len() == 0, "{lobes} lobes, {points} points: {kept} frames");
            assert!(cells.first() < cells.last(), "{lobes} lobes, {points} points, never cut anew: {cells:?}");
        }
    }

    #[test]
    fn no_map_is_cut_from_more_frames_than_rivals_catch_up_with_before_too_many_are_kept() {
        // Four and eight rivals of the present track among them.
        for hypotheses in 2..=9 {
            let caught_up = |from: usize| {
                let (mut kept, mut taken) = (from, 0);
                while taken < hypotheses * kept {
                    taken += frames_at_once(hypotheses);
                    kept += 1;
                }
                kept
            };
            let cut = tuning::OCCASIONS.map(|frames| kept_once_measured(frames, hypotheses) <= tuning::MOST_KEPT);
            assert_eq!(cut, [true, true, hypotheses < 4], "{hypotheses} hypotheses");
            for frames in tuning::OCCASIONS {
                // The frame of a step comes before its share of the others is taken: one more or less.
                let kept = caught_up(frames).abs_diff(kept_once_measured(frames, hypotheses));
                assert!(kept <= 1, "{hypotheses} hypotheses, {frames} frames");
            }
        }
    }

    #[test]
    fn frames_are_not_kept_for_ever_where_rivals_never_catch_up() {
        let lobed = |t: f64| 1.0 + 0.2 * (4.0 * t).cos();
        let mut filter = MotionFilter::new(FilterSettings::default()).expect("settings");
        for frame in 0..8 {
            filter.step(f64::from(frame) / 30.0, &turning(frame, 100, lobed)).expect("increasing times");
        }
        let track = filter.track.clone().expect("a track");
        let measured = filter.window.take_remapping();
        assert!(matches!(measured, Remapping::Measured(_)));
        filter.window.set_remapping(measured);
        let most = (8..200).map(|frame| {
            filter.window.keep(f64::from(frame) / 30.0, &turning(frame, 100, lobed), &track);
            filter.window.end_unless_few(track.cell_count());
            filter.window.len()
        });
        assert_eq!(most.max(), Some(tuning::MOST_KEPT));
        assert_eq!(filter.window.len(), 0);
    }
}
