//! The object followed without the points along straight edges that are not of it.
use freeform_curve_fit::Outline;
use freeform_riccati::MotionModel;

use super::{
    filter_step::FilterStep,
    motion_filter::{MotionFilter, Phase},
};
use crate::{
    occlusion::StandingEdge,
    track::Track,
    update::{FrameMeasurement, Rejection},
};

impl MotionFilter {
    /// Straight edges of the outline that are not of the object, in the order in which they were found: they stood still, or moved slowly, while one
    /// rigid motion explained the rest. Such is the side of something in front of the object. Their points are left out from the frame on in which
    /// they are found. The map is begun anew with it where it holds the edge; [`segment`](Self::segment) is counted up then. Empty but for rigid
    /// motion: an outline that may be stretched may do the same by itself.
    pub fn standing_edges(&self) -> impl ExactSizeIterator<Item = StandingEdge> + '_ {
        self.edges.found()
    }

    /// Edges whose points were left out for a while, until the outline was seen to go on across them, which is [`until`](StandingEdge::until) then;
    /// the last of them.
    pub fn former_edges(&self) -> impl ExactSizeIterator<Item = StandingEdge> + '_ {
        self.edges.former()
    }

    /// Looks at the outline of a frame at a time in seconds; whether it shows an edge that was not known.
    pub(super) fn look_for_edges(&mut self, outline: &Outline, seconds: f64) -> bool {
        let all_agrees = self.all_agrees();
        self.settings.model == MotionModel::Rigid && self.edges.look(outline, seconds, all_agrees)
    }

    /// Whether the object is tracked, the last frame was taken, and the points of the frames agree with the outline.
    fn all_agrees(&self) -> bool {
        let is_taken = self.phase == Phase::Tracking && self.counts.rejected_in_a_row == 0;
        is_taken && self.track.as_ref().is_some_and(Track::usually_agrees)
    }

    /// Whether the map holds an edge that was just found as a side of the object, as it does where the object was cut off by it from the beginning
    /// on. A map of what lies beyond the edge was begun before, and stays.
    pub(super) fn holds_edge(&self, left: &Outline) -> bool {
        self.track.as_ref().is_some_and(|track| self.edges.cuts_off(track.outline_points(), &left.centroid()))
    }

    /// Processes what is left of a frame. Where it `shows_edge` that was not known, and a map that explained the frames before disagrees, the edge
    /// has led that map astray although it was not taken for a side of it: then a new one is begun. A wrong frame of an object that is not tracked is
    /// none to begin with.
    pub(super) fn process_beside_edges(
        &mut self,
        time: f64,
        left: &Outline,
        shows_edge: bool,
    ) -> (Option<FrameMeasurement>, Option<Rejection>) {
        let (was_tracked, restarts) = (self.phase == Phase::Tracking, self.counts.restarts);
        let (measurement, rejection) = self.process(time, left);
        let disagrees = was_tracked && rejection.is_some_and(Rejection::is_disagreement);
        if shows_edge && disagrees && self.counts.restarts == restarts {
            self.begin_beside_edge(time, left);
        }
        (measurement, rejection)
    }

    /// Begins anew with what is left of a frame beside an edge; whether enough is.
    pub(super) fn begin_beside_edge(&mut self, time: f64, left: &Outline) -> bool {
        let is_begun = self.start(time, left).is_ok();
        if is_begun {
            self.before_repeated = None;
            self.counts.begun_without_edge += 1;
        }
        is_begun
    }

    /// After a frame of which an edge leaves too little: the object is moved on to its time, and lost where there are several. What is hidden says
    /// nothing against the map.
    pub(super) fn be_hidden(&mut self, seconds: f64, time: f64) -> FilterStep {
        self.pass_over(time);
        self.counts.rejected_in_recording += 1;
        self.counts.hidden_in_a_row += 1;
        let unseen = self.counts.rejected_in_a_row + self.counts.hidden_in_a_row;
        if self.phase == Phase::Tracking && unseen >= self.settings.patience {
            self.phase = Phase::Lost;
        }
        if self.phase != Phase::Tracking {
            self.before_repeated = None;
        }
        self.step_unmeasured(seconds, Some(Rejection::Hidden))
    }
}
