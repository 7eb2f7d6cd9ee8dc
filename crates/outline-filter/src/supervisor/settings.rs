use freeform_estimate::ProcessNoise;
use freeform_riccati::MotionModel;

use super::error::FilterError;
use crate::dynamics::Dynamics;

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
    /// What is assumed of how the motion goes on from frame to frame; [`Dynamics::Auto`] by default. Without effect with process noise, or if
    /// `adaptive` is `false`.
    pub dynamics: Dynamics,
    /// Systematic uncertainty of the outlines, image lengths: how far all of a side may lie off in every frame, such as by a shadow or by
    /// a threshold, not negative; 0 by default. It widens what is stated, and enters nothing else.
    pub edge_uncertainty: f64,
    /// Size of a pixel of the two-valued masks that the outlines were traced from, image lengths, not negative; 0, the default, leaves it to
    /// the first outline: where its points lie on the pixels of a lattice, or on its lines as interpolated ones do, they are off by what that
    /// leaves, by how ragged they are. What such an outline is off stays as it is while the object moves by less than a pixel, and points beside
    /// each other are off together: their noise is reckoned with as at least 0.15 of a pixel of a mask, and what is stated is widened, the less
    /// the more pixels the object has moved on, as far as frames show it: where it moves by whole pixels from frame to frame they do not. Points
    /// that state deviations of their own are off by these.
    pub mask_pixel: f64,
    /// Smallest agreement ([`FrameMeasurement::agreement`](crate::FrameMeasurement::agreement)) of a frame that is taken, in (0, 1); 0.7 by
    /// default.
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
            dynamics: Dynamics::Auto,
            edge_uncertainty: 0.0,
            mask_pixel: 0.0,
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

    /// The hypotheses of dynamics that are followed.
    pub(crate) fn followed_dynamics(&self) -> Option<Dynamics> {
        if !self.process_noise.is_none() {
            return None;
        }
        Some(if self.adaptive { self.dynamics } else { Dynamics::Generator })
    }

    pub(crate) fn check(&self) -> Result<(), FilterError> {
        let fail = |setting, value, range| Err(FilterError::Setting { setting, value, range });
        let noise = self.process_noise;
        for (setting, value) in [
            ("process noise of rates", noise.rates),
            ("process noise of velocities", noise.velocities),
            ("edge uncertainty", self.edge_uncertainty),
            ("mask pixel", self.mask_pixel),
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
