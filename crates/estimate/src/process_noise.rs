use freeform_riccati::{MAX_PARAMETERS, MotionModel, ParameterKind, ParameterVector};

/// How fast the motion itself may change: standard deviations per square root of a second, of the motion about the centre of the first
/// outline.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ProcessNoise {
    /// Of the rates of turning, growth and shear, in 1/s.
    pub rates: f64,
    /// Of the velocity of that centre, image lengths per second.
    pub velocities: f64,
}

impl ProcessNoise {
    /// Whether the motion is constant.
    #[must_use]
    pub fn is_none(&self) -> bool {
        self.rates == 0.0 && self.velocities == 0.0
    }

    /// Variance per second of every parameter of a model in coordinates that are centred on the object and divided by `radius` (image
    /// lengths).
    #[must_use]
    pub fn variances(&self, model: MotionModel, radius: f64) -> ParameterVector {
        let mut variances = [0.0; MAX_PARAMETERS];
        for (variance, kind) in variances.iter_mut().zip(model.parameter_kinds()) {
            let deviation = match kind {
                ParameterKind::Rate => self.rates,
                ParameterKind::Velocity => self.velocities / radius,
                ParameterKind::Perspective => self.rates * radius,
            };
            *variance = deviation * deviation;
        }
        variances
    }
}
