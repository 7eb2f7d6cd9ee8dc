use freeform_estimate::ProcessNoise;
use freeform_riccati::MotionModel;

use super::error::FilterError;

/// Settings of a [`MotionFilter`](crate::MotionFilter).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FilterSettings {
    /// The motion model.
    pub model: MotionModel,
    /// How fast the motion may change, if known; zeros by default.
    pub process_noise: ProcessNoise,
    /// Whether the filter follows changes of a motion without process noise, as soon as the innovations show them. `true` by default;
    /// if `false`, the motion is assumed constant.
    pub adaptive: bool,
    /// Smallest share of a frame's points that must lie on the known outline, or beyond its ends, for the frame to be taken, in (0, 1);
    /// 0.7 by default.
    pub smallest_agreement: f64,
    /// Frames rejected in a row after which the object is searched for again, at least 1; 2 by default.
    pub patience: usize,
}

impl Default for FilterSettings {
    /// Rigid motion that changes as far as the frames show it; a frame is taken if 70 % of its points agree; patience of 2 frames.
    fn default() -> Self {
        Self {
            model: MotionModel::Rigid,
            process_noise: ProcessNoise::default(),
            adaptive: true,
            smallest_agreement: 0.7,
            patience: 2,
        }
    }
}

impl FilterSettings {
    /// Whether changes of the motion are estimated.
    pub(crate) fn finds_changes(&self) -> bool {
        self.adaptive && self.process_noise.is_none()
    }

    pub(crate) fn check(&self) -> Result<(), FilterError> {
        let fail = |setting, value, range| Err(FilterError::Setting { setting, value, range });
        let noise = self.process_noise;
        for (setting, value) in
            [("process noise of rates", noise.rates), ("process noise of velocities", noise.velocities)]
        {
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
