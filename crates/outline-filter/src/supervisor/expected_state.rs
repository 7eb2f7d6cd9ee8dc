//! What is expected of the object at the time of a frame that has not been looked at.
use freeform_estimate::ExpectedState;
use nalgebra::DMatrix;

use super::{
    motion_filter::{MotionFilter, Phase},
    stated::Statement,
    tracking::predict,
};

impl MotionFilter {
    /// Pose and motion as they are expected at a later time, in seconds, from the frames so far: what a smoother compares the
    /// [state](Self::state) after a frame of that time with. `None` where the object is not followed, where no [state](Self::state) is known, and where
    /// the time is not later. It takes as long as a step or two.
    #[must_use]
    pub fn expected_state(&self, time: f64) -> Option<ExpectedState> {
        if self.phase != Phase::Tracking {
            return None;
        }
        let time = time / self.seconds_per_unit();
        let seconds = time - self.clock.of_track;
        let mut ahead = self.clone();
        ahead.stated.take();
        let track = ahead.track.as_mut().filter(|_| seconds > 0.0)?;
        if !predict(&self.settings, track, &mut ahead.history, seconds) {
            return None;
        }
        ahead.history.end_step();
        ahead.clock.of_track = time;
        let systematic = ahead.systematic_part()?;
        let turning_velocity = ahead.dynamics().map_or(1.0, |weights| weights.generator);
        Some(ExpectedState { state: ahead.state()?, turning_velocity, systematic })
    }

    /// The part of the covariance of the [state](Self::state) that frames do not average out.
    fn systematic_part(&self) -> Option<DMatrix<f64>> {
        let (track, Statement { random, all, .. }) = (self.track.as_ref()?, self.statement()?);
        let k = self.settings.model.parameter_count();
        let mut systematic = DMatrix::from_fn(2 * k, 2 * k, |i, j| all.covariance[(i, j)] - random.covariance[(i, j)]);
        let per_second = track.reference().per_second();
        systematic.rows_mut(k, k).scale_mut(per_second);
        systematic.columns_mut(k, k).scale_mut(per_second);
        Some(systematic)
    }
}
