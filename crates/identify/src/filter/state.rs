use nalgebra::DMatrix;

use super::motion_filter::MotionFilter;
use crate::{information::invert_positive_definite, motion_state::MotionState};

impl MotionFilter {
    /// Pose and motion with their joint covariance, at the time that they stand at: that of the last frame accepted, or rejected while
    /// tracking. `None` wherever [`estimate`](Self::estimate) is.
    #[must_use]
    pub fn state(&self) -> Option<MotionState> {
        let estimate = self.estimate()?;
        let map = self.map()?;
        let size = 2 * map.model.parameter_count();
        let marginal = DMatrix::from_fn(size, size, |i, j| map.marginal[(i, j)]);
        let with_outline_given = DMatrix::from_fn(size, size, |i, j| map.information.dense[i][j]);
        let mut observable = [false; 8];
        observable.iter_mut().zip(estimate.parameters()).for_each(|(seen, p)| *seen = p.value.is_some());
        Some(MotionState {
            model: map.model,
            time: self.map_time,
            origin: map.origin,
            radius: map.radius,
            pose: map.pose,
            motion: map.motion,
            covariance: invert_positive_definite(&marginal)? * (map.sigma * map.sigma),
            within: invert_positive_definite(&with_outline_given)? * (map.sigma * map.sigma),
            observable,
        })
    }
}
