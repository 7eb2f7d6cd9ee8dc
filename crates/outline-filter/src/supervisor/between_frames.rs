//! Work that one frame leaves and the next one needs, done between them: cutting the map anew and measuring the frames kept on it.
use super::{
    motion_filter::{MotionFilter, Phase},
    window::{Ahead, Due, Remapped, Remapping},
};
use crate::{map::CellsInCommon, track::Track};

/// Whether cutting the map anew is left to calls of [`prepare`](MotionFilter::prepare).
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct BetweenFrames {
    /// Whether one was made since the last frame.
    is_called: bool,
    /// Whether one was made before the present frame, so that another is to be expected after it.
    is_left: bool,
}

impl BetweenFrames {
    /// Begins a frame.
    pub(super) fn begin_frame(&mut self) {
        *self = Self { is_called: false, is_left: self.is_called };
    }
}

impl MotionFilter {
    /// Does a part of the work that waits for the next frame, while nothing else is to be done; whether more is waiting. All results are the same to
    /// the last bit whether, when and how often this is called: what is not done by the next [`step`](Self::step), that step does.
    ///
    /// After some of the first frames, and where the motion seems to change, the map of the outline is cut anew, and frames seen before are measured
    /// on it: steps of several times the length of others. Where this was called before a frame, its step leaves the cut to the calls after it; else
    /// it makes the cut itself, so that the step after it does not have both to do.
    ///
    /// ```
    /// use freeform_curve_fit::Outline;
    /// use freeform_outline_filter::{FilterSettings, MotionFilter};
    /// use nalgebra::Point2;
    ///
    /// let mut filter = MotionFilter::new(FilterSettings::default())?;
    /// for frame in 0..10 {
    ///     let shift = 0.01 * f64::from(frame);
    ///     let angles = (0..200).map(|i| std::f64::consts::TAU * f64::from(i) / 200.0);
    ///     let egg = angles.map(|t| Point2::new(shift + 0.5 * t.cos() + 0.05 * (2.0 * t).cos(), 0.3 * t.sin()));
    ///     filter.step(0.1 * f64::from(frame), &Outline::closed(egg.collect())?)?;
    ///     // What the filter says of this frame is used here, and then:
    ///     while filter.prepare() {
    ///         // More is waiting, if there is time left until the next frame.
    ///     }
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn prepare(&mut self) -> bool {
        self.between_frames.is_called = true;
        if self.window.is_due() {
            self.do_stage_that_is_due();
        } else {
            self.measure_ahead();
            self.take_ahead();
        }
        let may_measure = self.may_measure() && !matches!(self.window.ahead(), Some(Ahead::Taken(_)));
        self.window.is_due() || may_measure || self.next_to_take().is_some()
    }

    /// Whether what is due after this frame is left to be done before the next. It says nothing that is stated after this one.
    pub(super) fn leaves_work(&self) -> bool {
        self.between_frames.is_left
    }

    /// Makes all stages of cutting the map anew that are due, if any are.
    pub(super) fn do_what_is_due(&mut self) {
        while self.window.is_due() {
            self.do_stage_that_is_due();
        }
    }

    fn do_stage_that_is_due(&mut self) {
        let next = match self.window.take_remapping() {
            Remapping::Due(Due::Placing { turn, cuts, in_common }) => self.place((turn, cuts), in_common),
            Remapping::Due(Due::Cutting(placed)) => self.cut(*placed),
            other => return self.window.set_remapping(other),
        };
        self.window.set_remapping(next);
        self.end_window_unless_few();
    }

    /// Measures the frames kept on cells that were cut after the last of them, before the next frame is looked at: by the coarse map it might be
    /// taken for another thing. Where there are rivals, they take their turns instead.
    pub(super) fn measure_before_next(&mut self) {
        // By now the track may be another than that which was gone ahead from.
        let ahead = self.window.take_ahead();
        if !self.may_measure() {
            return;
        }
        if let Remapping::Drafted(draft) = self.window.take_remapping() {
            let next = match ahead {
                Some(ahead) => self.exchange_for(ahead, (draft.cuts, draft.in_common)),
                None => self.measure(*draft),
            };
            self.window.set_remapping(next);
            self.end_window_unless_few();
        }
    }

    /// Whether the map has been cut for the track, which is followed alone, and stands at the last frame that was looked at.
    fn may_measure(&self) -> bool {
        let is_followed = self.phase == Phase::Tracking && self.turn_hypotheses.followed().next().is_none();
        is_followed
            && self.before_repeated.is_none()
            && self.window.drafted_for(self.turn_hypotheses.present_turn()).is_some()
    }

    /// Does a part of what the next frame [waits for](Self::measure_before_next), which is no more than a frame takes, and leaves the track as it is.
    fn measure_ahead(&mut self) {
        if !self.may_measure() {
            return;
        }
        let next = match self.window.take_ahead() {
            None => {
                let turn = self.turn_hypotheses.present_turn();
                let new = self.window.drafted_for(turn).map(|draft| draft.track.clone());
                let begun = new.and_then(|new| self.begun_on(new));
                begun.map_or(Ahead::Taken(None), |track| Ahead::Taking(Box::new(Remapped::at_first(track))))
            }
            Some(Ahead::Taking(taking)) if taking.frames_taken() < self.window.len() => {
                let taken = self.take_kept(*taking, 1);
                taken.map_or(Ahead::Taken(None), |taken| Ahead::Taking(Box::new(taken)))
            }
            Some(Ahead::Taking(taken)) => Ahead::Taken(self.unless_astray(*taken).map(Box::new)),
            Some(taken) => taken,
        };
        self.window.set_ahead(next);
    }

    /// A track of cells cut anew, begun with the first of the frames kept as the present one knows it.
    pub(super) fn begun_on(&mut self, mut new: Track) -> Option<Track> {
        new.begin_as(self.track.as_ref()?, self.window.first()?, &mut self.frame);
        Some(new)
    }

    /// Exchanges the track, which no rival is followed with, for what all frames kept make of it on cells cut anew.
    pub(super) fn exchange_for(&mut self, ahead: Ahead, of_cut: (usize, CellsInCommon)) -> Remapping {
        let taken = match ahead {
            Ahead::Taken(taken) => taken.map(|taken| *taken),
            Ahead::Taking(taking) => {
                let taken = self.take_kept(*taking, usize::MAX);
                taken.and_then(|taken| self.unless_astray(taken))
            }
        };
        taken.map_or(Remapping::Idle, |taken| self.exchange(taken, Vec::new(), of_cut))
    }

    /// A track that has taken the frames kept on cells cut anew. One that has gone astray among them, and explains the last of them worse than where
    /// the present track is, is none to be exchanged for.
    pub(super) fn unless_astray(&mut self, present: Remapped) -> Option<Remapped> {
        let poses = [*present.track.body_pose(), *self.track.as_ref()?.body_pose()];
        let likelihoods = present.track.compared(self.window.last()?, &poses, &mut self.frame);
        (!likelihoods[0].is_worse_than(&likelihoods[1])).then_some(present)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{drawn_curves::turning, supervisor::settings::FilterSettings};

    fn step(filter: &mut MotionFilter, frame: u32) {
        let egg = |t: f64| 1.0 + 0.2 * t.cos() + 0.1 * (3.0 * t).sin();
        let step = filter.step(f64::from(frame) / 30.0, &turning(frame, 400, egg)).expect("increasing times");
        assert!(step.is_accepted(), "frame {frame}");
    }

    /// A filter after the frame in which its map is first cut, called once after every frame before that in which `is_called`.
    fn cut_after(is_called: impl Fn(u32) -> bool) -> MotionFilter {
        let mut filter = MotionFilter::new(FilterSettings::default()).expect("settings");
        for frame in 0..4 {
            step(&mut filter, frame);
            if frame < 3 && is_called(frame) {
                assert!(!filter.prepare(), "frame {frame}");
            }
        }
        filter
    }

    #[test]
    fn the_cut_is_left_to_one_who_called_before_the_frame_and_to_nobody_else() {
        for (is_left, filter) in [
            (true, cut_after(|_| true)),
            (true, cut_after(|frame| frame == 2)),
            (false, cut_after(|_| false)),
            (false, cut_after(|frame| frame < 2)),
        ] {
            assert_eq!(filter.window.is_due(), is_left);
            assert_eq!(filter.window.drafted_for(filter.turn_hypotheses.present_turn()).is_some(), !is_left);
        }
    }

    #[test]
    fn the_map_is_cut_and_all_frames_are_measured_before_the_next_frame_as_soon_as_nothing_waits() {
        let mut filter = cut_after(|_| true);
        let cells = filter.track.as_ref().map(Track::cell_count);
        let mut calls = 1;
        while filter.prepare() {
            calls += 1;
        }
        // Points in order, the cut, the first of four frames, each of the others, and whether the track has gone astray among them.
        assert_eq!(calls, 7);
        assert!(matches!(filter.window.ahead(), Some(Ahead::Taken(Some(taken))) if taken.frames_taken() == 4));
        assert_eq!(filter.track.as_ref().map(Track::cell_count), cells);
        assert!(!filter.prepare());
        step(&mut filter, 4);
        assert!(filter.window.ahead().is_none());
        assert!(filter.track.as_ref().map(Track::cell_count) > cells);
    }

    #[test]
    fn what_is_left_and_not_done_is_done_by_the_next_frame() {
        let mut filter = cut_after(|_| true);
        let cells = filter.track.as_ref().map(Track::cell_count);
        step(&mut filter, 4);
        assert!(filter.track.as_ref().map(Track::cell_count) > cells);
    }
}
