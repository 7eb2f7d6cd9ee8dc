//! The velocity of an object's middle, and what an outline does not show of it.
use std::sync::Arc;

use freeform_estimate::{MotionState, PointVelocity};
use freeform_riccati::ParameterKind;

use super::{Track, estimate::TurnOfPose};
use crate::tuning::map::FRAMES_OF_CENTROID;

impl Track {
    /// Places the centroid by the outline as it is known now, each time that twice as many frames have shown its cells: they were cut along the
    /// points of few frames, and smoothed. Where the outline does not show a motion, the centroid stays, as it is where that motion leaves it.
    pub(super) fn renew_centroid(&mut self) {
        let shown = self.frames - self.frames_before_cells;
        let is_time = shown.is_power_of_two() && FRAMES_OF_CENTROID.contains(&shown);
        if is_time && self.null_directions().is_empty() {
            Arc::make_mut(&mut self.map).place_centroid(self.belief.model, self.belief.known_offsets());
        }
    }

    /// Velocity of the object's centroid in a state of this track; `None` where it is not worth stating. Whether the outline shows it
    /// [`hides_velocity`](Self::hides_velocity) says.
    pub(crate) fn velocity_of_centroid(&self, state: &MotionState) -> Option<PointVelocity> {
        let velocity = state.velocity_of_middle();
        let span = self.belief.memory.shortest(self.belief.parameter_count());
        let unit = self.reference.time_unit;
        let worth = |deviation: &f64| self.is_worth(*deviation * unit, span, self.reference.radius);
        velocity.standard_deviations().iter().all(worth).then_some(velocity)
    }

    /// Whether the outline does not show how its centroid moves: where some of the perspective is hidden, or where a motion that it does not show
    /// moves the centroid. Such a motion is held at none, with a deviation that says nothing of how far it may go.
    pub(crate) fn hides_velocity(&self) -> bool {
        self.hides_perspective() || self.map.hides_motion_of_centroid(self.model())
    }

    /// Whether the outline does not show some of the perspective, as an ellipse does not: nor does it show which point of the body is where then.
    fn hides_perspective(&self) -> bool {
        let hidden = self.hidden_parameters(TurnOfPose::AsTheOutlineShows);
        hidden
            .iter()
            .zip(self.model().parameter_kinds())
            .any(|(hidden, kind)| *hidden && *kind == ParameterKind::Perspective)
    }
}
