use freeform_riccati::MotionModel;

use super::error::FilterError;

/// How fast the motion itself may change: standard deviations per square root of a second.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ProcessNoise {
    /// Of the rates of turning, growth and shear, in 1/s.
    pub rates: f64,
    /// Of the velocities b1 and b2, image lengths per second.
    pub velocities: f64,
}

/// Settings of a [`MotionFilter`](crate::MotionFilter).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FilterSettings {
    /// Which motions are looked for.
    pub model: MotionModel,
    /// How fast the motion may change; none at all by default.
    pub process_noise: ProcessNoise,
    /// Smallest share of a frame's points that must lie on the known outline, or beyond its ends, for the frame to be taken. In (0, 1).
    pub smallest_agreement: f64,
    /// Frames rejected in a row after which the object is looked for anew, at least 1.
    pub patience: usize,
}

impl Default for FilterSettings {
    /// Rigid motion that does not change; a frame is taken if 70 % of its points agree; patience of 2 frames.
    fn default() -> Self {
        Self { model: MotionModel::Rigid, process_noise: ProcessNoise::default(), smallest_agreement: 0.7, patience: 2 }
    }
}

impl FilterSettings {
    pub(crate) fn check(&self) -> Result<(), FilterError> {
        let fail = |setting, value, range| Err(FilterError::Setting { setting, value, range });
        for (setting, value) in [
            ("process noise of rates", self.process_noise.rates),
            ("process noise of velocities", self.process_noise.velocities),
        ] {
            if !(value.is_finite() && value >= 0.0) {
                return fail(setting, value, "finite and not negative");
            }
        }
        if !(self.smallest_agreement > 0.0 && self.smallest_agreement < 1.0) {
            return fail("smallest agreement", self.smallest_agreement, "between 0 and 1");
        }
        if self.patience == 0 {
            return fail("patience", 0.0, "at least 1");
        }
        Ok(())
    }
}
