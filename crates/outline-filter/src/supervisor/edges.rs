//! The object followed without the points along straight edges that are not of it.
use freeform_curve_fit::Outline;
use freeform_riccati::MotionModel;

use super::motion_filter::{FilterStep, MotionFilter, Phase};
use crate::{occlusion::StandingEdge, update::Rejection};

impl MotionFilter {
    /// Straight edges of the outline that are not of the object, in the order in which they were found: they stood still, or moved slowly, while one
    /// rigid motion explained the rest. Such is the side of something in front of the object. Their points are left out from the frame on in which
    /// they
    /// are found. The map is begun anew with it where it holds the edge; [`segment`](Self::segment) is counted up then. Empty but for rigid
    /// motion: an outline that may be
    /// stretched may do the same by itself.
    pub fn standing_edges(&self) -> impl ExactSizeIterator<Item = StandingEdge> + '_ {
        self.edges.found()
    }

    /// Counted up from 0 where poses no longer go back to the same first outline: after a [restart](Self::restarts), and where a frame has shown the
    /// turn of the object for the first time, since nobody knows how far it had turned until then, and where an [edge](Self::standing_edges) was
    /// found
    /// not to be of the object.
    #[must_use]
    pub fn segment(&self) -> usize {
        self.counts.restarts + self.counts.begun_with_turn + self.counts.begun_without_edge
    }

    pub(super) fn looks_for_edges(&self) -> bool {
        self.settings.model == MotionModel::Rigid
    }

    /// Begins anew with a frame whose points along an edge that was just found are left out, if the map holds the edge as a side of the object, as
    /// it does
    /// where the object was cut off by it from the beginning on; whether it has. A map of what lies beyond the edge was begun before, and stays.
    pub(super) fn begin_without_edge(&mut self, time: f64, left: &Outline) -> bool {
        let holds_edge =
            self.track.as_ref().is_none_or(|track| self.edges.end(track.outline_points(), &left.centroid()));
        holds_edge && self.begin_with(time, left)
    }

    /// Begins anew with what is left of a frame beside an edge; whether enough is. A map that the edge was not taken for a side of, and which does
    /// not
    /// explain that either, was led astray by the edge.
    pub(super) fn begin_with(&mut self, time: f64, left: &Outline) -> bool {
        let is_begun = self.start(time, left).is_ok();
        if is_begun {
            self.before_repeated = None;
            self.counts.begun_without_edge += 1;
        }
        is_begun
    }

    /// After a frame of which an edge leaves too little: the object is moved on to its time, and lost where there are several.
    pub(super) fn be_hidden(&mut self, seconds: f64, time: f64, outline: &Outline) -> FilterStep {
        self.repeated.take(seconds, outline);
        self.pass_over(time);
        self.counts.add_rejected();
        if self.phase == Phase::Tracking && self.counts.rejected_in_a_row >= self.settings.patience {
            self.before_repeated = None;
            self.phase = Phase::Lost;
        }
        FilterStep { time: seconds, phase: self.phase, measurement: None, rejection: Some(Rejection::NotFound) }
    }
}
