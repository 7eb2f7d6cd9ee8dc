use freeform_curve_fit::{FitSettings, Fitter, Outline};
use freeform_decompose::{Decomposition, RelatedPoints};
use nalgebra::{Affine2, Point2};

use crate::{measurement::Reference, tuning::registration as tuning};

/// Related points of one outline, those of the quartic's two line pairs.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Landmarks([Point2<f64>; 2]);

impl Landmarks {
    /// In the image coordinates of the outline. A hundred of its points are enough: they tell the turn to some degrees, and
    /// searches begin with that.
    pub(crate) fn of(outline: &Outline) -> Option<Self> {
        let thinned = match outline {
            Outline::Closed(closed) if outline.deviations().is_none() => {
                let points = closed.points();
                let stride = points.len() / tuning::POINTS_OF_LANDMARKS;
                if stride > 1 { Outline::closed(points.iter().step_by(stride).copied().collect()).ok() } else { None }
            }
            _ => None,
        };
        let outline = thinned.as_ref().unwrap_or(outline);
        let fit = Fitter::new(FitSettings::default()).ok()?.fit(outline).ok()?;
        let decomposition = Decomposition::of(fit.working()).ok()?;
        let related = RelatedPoints::of(&decomposition);
        let mut points =
            related.level(4).map(|d| fit.normalisation().centre + fit.normalisation().radius * d.point.coords);
        Some(Self([points.next()?, points.next()?]))
    }

    /// Moved by an affine map of the image.
    pub(crate) fn moved(&self, map: &Affine2<f64>) -> Self {
        Self(self.0.map(|p| map * p))
    }

    /// In normalised coordinates.
    pub(super) fn normalised(&self, reference: Reference) -> [Point2<f64>; 2] {
        self.0.map(|p| Point2::from((p - reference.origin) / reference.radius))
    }
}

#[cfg(feature = "serde")]
impl Landmarks {
    /// Whether every coordinate is finite.
    pub(crate) fn is_finite(&self) -> bool {
        self.0.iter().flat_map(|p| &p.coords).all(|coordinate| coordinate.is_finite())
    }
}
