use std::ops::RangeInclusive;

use freeform_curve_fit::{FitSettings, Method, Normalise};
use freeform_identify::{AdaptiveLaw, AdaptiveSettings};
use freeform_riccati::MotionModel;

use crate::pipeline_error::PipelineError;

/// RMS radius of the first outline in the coordinates of the identifier where no other is given.
const RMS_RADIUS: f64 = 0.6;

/// The coefficients of a curve go with powers of the radius up to its degree, which is 8 at most: within these they stay numbers.
const SIZES: RangeInclusive<f64> = 1e-6..=1e6;

/// Settings of a [`Pipeline`](crate::Pipeline).
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PipelineSettings {
    /// How a curve is fitted to every outline.
    pub fit: FitSettings,
    /// How the motion is identified from its lines.
    pub identify: AdaptiveSettings,
    /// RMS radius of the first outline in the coordinates of the identifier, from 1e-6 to 1e6. The gains of the paper belong to objects of about
    /// size 1; a larger radius makes the law settle faster and follow the noise more.
    pub size: f64,
}

impl Default for PipelineSettings {
    /// A bounded quartic, rounder than the one that follows the outline best: a ridge and a large margin keep the lines
    /// of the leading form away from real ones, whose slopes swing far out as they turn and carry their noise with them.
    fn default() -> Self {
        let method = Method::Bounded { margin: 0.5, ridge_weight: 0.03 };
        let fit = FitSettings { method, offset: 0.15, ..FitSettings::default() };
        Self { fit, identify: AdaptiveSettings::default(), size: RMS_RADIUS }
    }
}

impl PipelineSettings {
    /// The settings for a family of motions. For affine motion outlines are fitted affine-normalised, since the lines of other fits
    /// do not follow it, and the law is filtered least squares: over six parameters the structured law takes minutes to
    /// settle for outlines whose lines excite it little. An outline moved to its circle of inertia needs less of a ridge, and a
    /// larger margin keeps the lines of slender ones, whose curve is bounded by it alone, apart. Projective motion has the same.
    #[must_use]
    pub fn for_model(model: MotionModel) -> Self {
        let mut settings = Self::default();
        settings.identify.model = model;
        if matches!(model, MotionModel::Affine | MotionModel::Projective) {
            settings.fit.normalise = Normalise::Affine;
            settings.identify.law = AdaptiveLaw::FilteredLeastSquares;
            settings.fit.method = Method::Bounded { margin: 0.7, ridge_weight: 0.003 };
        }
        settings
    }

    /// Checks what neither the fit nor the identifier checks.
    pub(crate) fn check(&self) -> Result<(), PipelineError> {
        let size = self.size;
        if SIZES.contains(&size) { Ok(()) } else { Err(PipelineError::Size { size }) }
    }
}
