use crate::{degree::Degree, error::SettingsError};

/// How an implicit polynomial is fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Method {
    /// Plain 3L (Blane, Lei, Civi, Cooper 2000): the curve follows the data best, and may be unbounded.
    ThreeLevel,
    /// GS3L (Sahin, Unel 2004): 3L plus the Euclidean-invariant ridge of Tasdizen, Tarel and Cooper (2000).
    /// Bounded curves become likely, not certain.
    GloballyStabilised {
        /// Weight kappa of the ridge, at least 0. Prefer the smallest that serves: a large one makes circles of lines.
        ridge_weight: f64,
    },
    /// 3L under the constraint that the leading form is positive: closed and bounded by construction.
    Bounded {
        /// Smallest value of the leading form on the unit circle, as a fraction of the root mean square over the circle
        /// that it has without the constraint. In (0, 0.9].
        margin: f64,
        /// Weight kappa of the rotation-invariant ridge, as in [`GloballyStabilised`](Self::GloballyStabilised); 0 for
        /// none. A ridge makes the constraint idle on most frames and calms the leading form.
        ridge_weight: f64,
    },
}

/// In which coordinates an outline is fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Normalise {
    /// Centred and scaled. The fit of an outline moved by a similarity is the moved fit; that of a stretched or sheared one is not.
    #[default]
    Similarity,
    /// Moved by its area moments to a circle of inertia and spread evenly by arc length there. The fit of an outline moved by any
    /// affine map is the moved fit, to rounding, and to what spreading an outline anew changes where its points are others. For
    /// closed outlines; an open one has no area moments, and needs [`Fitter::fit_in`](crate::Fitter::fit_in).
    Affine,
}

/// Settings of a [`Fitter`](crate::Fitter).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FitSettings {
    /// Degree of the polynomial.
    pub degree: Degree,
    /// Which least-squares problem is solved.
    pub method: Method,
    /// Distance c of the outer level sets from the data, in units of the RMS radius of the outline where it is fitted.
    /// In (0, 1].
    pub offset: f64,
    /// Half width of the window that normals are regressed over, as a fraction of the length of the outline.
    /// In [0, 0.25].
    pub normal_half_window: f64,
    /// In which coordinates the outline is fitted.
    pub normalise: Normalise,
}

impl Default for FitSettings {
    /// A bounded quartic with level sets at a tenth of the RMS radius.
    fn default() -> Self {
        Self {
            degree: Degree::Quartic,
            method: Method::Bounded { margin: 0.02, ridge_weight: 0.0 },
            offset: 0.1,
            normal_half_window: 0.02,
            normalise: Normalise::Similarity,
        }
    }
}

impl FitSettings {
    pub(crate) fn check(&self) -> Result<(), SettingsError> {
        if !(self.offset > 0.0 && self.offset <= 1.0) {
            return Err(SettingsError::Offset { value: self.offset });
        }
        if !(0.0..=0.25).contains(&self.normal_half_window) {
            return Err(SettingsError::NormalHalfWindow { value: self.normal_half_window });
        }
        match self.method {
            Method::GloballyStabilised { ridge_weight: value } | Method::Bounded { ridge_weight: value, .. }
                if !(value >= 0.0 && value.is_finite()) =>
            {
                Err(SettingsError::RidgeWeight { value })
            }
            Method::Bounded { margin: value, .. } if !(value > 0.0 && value <= 0.9) => {
                Err(SettingsError::Margin { value })
            }
            _ => Ok(()),
        }
    }
}
