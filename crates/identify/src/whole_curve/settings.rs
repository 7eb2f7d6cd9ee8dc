use freeform_curve_fit::Degree;
use freeform_riccati::MotionModel;

use crate::filter::{FilterError, ProcessNoise};

/// Settings of a [`WholeCurveFilter`](crate::WholeCurveFilter).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveFilterSettings {
    /// Which motions are looked for.
    pub model: MotionModel,
    /// Degree of the polynomial.
    pub degree: Degree,
    /// Distance c of the outer level sets from the data, in units of the RMS radius of the first outline. In (0, 1].
    pub offset: f64,
    /// Half width of the window that normals are regressed over, as a fraction of the length of the outline. In [0, 0.25].
    pub normal_half_window: f64,
    /// How fast the motion may change; none at all by default.
    pub process_noise: ProcessNoise,
    /// Frames rejected in a row after which the object is looked for anew, at least 1.
    pub patience: usize,
}

impl Default for CurveFilterSettings {
    /// Rigid motion that does not change, a sextic with level sets at a tenth of the RMS radius, patience of 2 frames.
    fn default() -> Self {
        Self {
            model: MotionModel::Rigid,
            degree: Degree::Sextic,
            offset: 0.1,
            normal_half_window: 0.02,
            process_noise: ProcessNoise::default(),
            patience: 2,
        }
    }
}

impl CurveFilterSettings {
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
        if !(self.offset > 0.0 && self.offset <= 1.0) {
            return fail("offset", self.offset, "above 0 and at most 1");
        }
        if !(0.0..=0.25).contains(&self.normal_half_window) {
            return fail("half window of normals", self.normal_half_window, "from 0 to 0.25");
        }
        if self.patience == 0 {
            return fail("patience", 0.0, "at least 1");
        }
        Ok(())
    }
}
