//! A curve fitted to one outline, and what it is made of.
use freeform_motion::curve_fit::{Fit, FitCovariance};
use freeform_motion::decompose::{
    AffineInvariants, CurveUncertainty, Decomposition, DecompositionError, RelatedPoints,
};
use freeform_motion::outline_io::OutlineFrame;
use nalgebra::{Matrix2, Point2};

/// A curve fitted to one outline, and what it is made of.
#[derive(Debug, Clone)]
pub(crate) struct FittedOutline {
    pub(crate) object: String,
    pub(crate) frame: u64,
    pub(crate) time: f64,
    pub(crate) fit: Fit,
    /// In image coordinates.
    pub(crate) parts: Result<Parts, DecompositionError>,
    /// If they were asked for.
    pub(crate) deviations: Option<Deviations>,
    /// Middles of the stray parts of the curve, if they were searched for.
    pub(crate) stray_parts: Vec<Point2<f64>>,
}

/// Standard deviations of what a decomposition gives, from the noise of the points.
#[derive(Debug, Clone)]
pub(crate) struct Deviations {
    /// Of x and y of the related points, in image coordinates.
    pub(crate) related_points: Vec<[f64; 2]>,
    /// Of the invariants; empty if there are none.
    pub(crate) invariants: Vec<f64>,
}

/// What a decomposition gives.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Parts {
    pub(crate) decomposition: Decomposition,
    /// With the values of the monic polynomial in image coordinates.
    pub(crate) related_points: RelatedPoints,
    pub(crate) invariants: Option<AffineInvariants>,
}

impl FittedOutline {
    /// The curve of one frame of one object.
    pub(crate) fn new(frame: &OutlineFrame, fit: Fit) -> Self {
        // In working coordinates, where nothing is lost to rounding, and then moved.
        let parts = Decomposition::of(fit.working()).and_then(|working| {
            let image_from_working = fit.normalisation().image_from_working();
            let decomposition = working.moved(&image_from_working)?;
            let n = working.degree().value();
            let factor = working.coefficient(n) / decomposition.coefficient(n);
            let related_points = RelatedPoints::of(&working).moved(&image_from_working).scaled(factor);
            Ok(Parts { decomposition, related_points, invariants: AffineInvariants::of(&working) })
        });
        Self {
            object: frame.object.clone(),
            frame: frame.frame,
            time: frame.time,
            fit,
            parts,
            deviations: None,
            stray_parts: Vec::new(),
        }
    }

    /// Adds the standard deviations of its parts for a covariance of the coefficients.
    pub(crate) fn with_deviations(mut self, covariance: &FitCovariance) -> Self {
        let carried = CurveUncertainty::carried(self.fit.working(), &covariance.coefficients());
        let map = self.fit.normalisation().image_from_working();
        let linear = map.matrix().fixed_view::<2, 2>(0, 0).into_owned();
        let deviations_of = |c: &Matrix2<f64>| (linear * c * linear.transpose()).diagonal().map(f64::sqrt).into();
        self.deviations = carried.ok().map(|carried| Deviations {
            related_points: carried.points().iter().map(deviations_of).collect(),
            invariants: carried.invariants().map_or_else(Vec::new, |c| c.diagonal().iter().map(|v| v.sqrt()).collect()),
        });
        self
    }
}
