use freeform_estimate::{MotionState, NormalisedState};

use super::motion_filter::MotionFilter;

impl MotionFilter {
    /// Pose and motion with their joint covariance, at the time that they stand at: that of the last frame accepted, or rejected while
    /// tracking. `None` wherever [`estimate`](Self::estimate) is.
    #[must_use]
    pub fn state(&self) -> Option<MotionState> {
        let estimate = self.estimate()?;
        let map = self.map()?;
        let mut observable = [false; 8];
        observable.iter_mut().zip(estimate.parameters()).for_each(|(seen, p)| *seen = p.value.is_some());
        let state = NormalisedState {
            model: map.model,
            time: self.map_time,
            origin: map.origin,
            radius: map.radius,
            pose: map.pose,
            motion: map.motion,
            covariance: map.state_covariance(&map.marginal)?,
            covariance_given_outline: map.state_covariance(&map.information.with_outline_given())?,
            observable,
        };
        Some(state.into())
    }
}
