use freeform_estimate::PointVelocity;
use nalgebra::Point2;

use super::{motion_filter::MotionFilter, outline_map::OutlineMap};

impl MotionFilter {
    /// Velocity of the object's middle, the centre of its outline as far as that is known, at the time of [`state`](Self::state). It may be
    /// known where the velocity `b` of the image origin is not, as that of a circle. `None` where it is not known, where the
    /// motion is [ambiguous](Self::is_ambiguous), and wherever [`estimate`](Self::estimate) is.
    #[must_use]
    pub fn velocity(&self) -> Option<PointVelocity> {
        if self.is_ambiguous() {
            return None;
        }
        let map = self.map()?;
        let velocity = self.state()?.velocity_of(&(map.origin + map.radius * map.middle().coords));
        map.tells(&velocity).then_some(velocity)
    }
}

impl OutlineMap {
    /// Centre of the cells in the body frame.
    pub(super) fn middle(&self) -> Point2<f64> {
        Point2::new(self.body_frame[(0, 2)], self.body_frame[(1, 2)])
    }

    /// Whether a velocity of the middle is known by the measure of the parameters.
    fn tells(&self, velocity: &PointVelocity) -> bool {
        let deviations = velocity.standard_deviations();
        let worth = |deviation: &f64| self.is_worth(*deviation, self.shortest_span(), self.radius);
        deviations.iter().all(worth)
    }
}
