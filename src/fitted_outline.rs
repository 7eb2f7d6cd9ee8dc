use freeform_curve_fit::{Fit, FitCovariance};
use freeform_decompose::{AffineInvariants, CurveUncertainty, Decomposition, DecompositionError, RelatedPoints};
use freeform_outline_io::OutlineFrame;
use nalgebra::{Matrix2, Point2};

/// A curve fitted to the outline of an object in one frame, and what the curve consists of.
///
/// ```
/// use freeform_motion::FittedOutline;
/// use freeform_motion::curve_fit::{FitSettings, Fitter};
/// use freeform_motion::outline_io::{DEFAULT_OBJECT, OutlineFrame};
/// use freeform_motion::sim_camera::{PaperExperiment, SequenceLength, Settings, Simulator};
///
/// let settings = Settings { length: SequenceLength::Frames(1), ..Settings::default() };
/// let simulator = Simulator::new(PaperExperiment::FLIGHT_BIRD.scene(0.1)?, settings)?;
/// let outline = simulator.frames().next().expect("a frame").outline;
/// let fit = Fitter::new(FitSettings::default())?.fit(&outline)?;
/// let frame = OutlineFrame { frame: 0, time: 0.0, object: DEFAULT_OBJECT.to_owned(), outline };
/// let fitted = FittedOutline::new(&frame, fit);
/// assert!(!fitted.parts?.related_points.as_slice().is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct FittedOutline {
    /// Name of the object.
    pub object: String,
    /// Number of the frame.
    pub frame: u64,
    /// Time of the frame in seconds.
    pub time: f64,
    /// The curve.
    pub fit: Fit,
    /// What the curve consists of, in image coordinates.
    pub parts: Result<CurveParts, DecompositionError>,
    /// Standard deviations of the parts, after [`with_deviations`](Self::with_deviations).
    pub deviations: Option<CurveDeviations>,
    /// Middles of the stray parts of the curve; empty unless the caller has searched for them with [`Fit::stray_places`].
    pub stray_parts: Vec<Point2<f64>>,
}

/// Standard deviations of the parts of a curve, from the noise of the points.
#[derive(Debug, Clone)]
pub struct CurveDeviations {
    /// Of x and y of the related points, in image coordinates.
    pub related_points: Vec<[f64; 2]>,
    /// Of the invariants; empty if there are none.
    pub invariants: Vec<f64>,
}

/// What a curve consists of.
#[derive(Debug, Clone, Copy)]
pub struct CurveParts {
    /// Its complex lines.
    pub decomposition: Decomposition,
    /// Its related points, with the values of the monic polynomial in image coordinates.
    pub related_points: RelatedPoints,
    /// Its affine invariants, if it has any.
    pub invariants: Option<AffineInvariants>,
}

impl FittedOutline {
    /// The curve of one frame of one object, decomposed.
    #[must_use]
    pub fn new(frame: &OutlineFrame, fit: Fit) -> Self {
        // In working coordinates, where nothing is lost to rounding, and then moved.
        let parts = Decomposition::of(fit.working()).and_then(|working| {
            let image_from_working = fit.normalisation().image_from_working();
            let decomposition = working.moved(&image_from_working)?;
            let n = working.degree().value();
            let factor = working.coefficient(n) / decomposition.coefficient(n);
            let related_points = RelatedPoints::of(&working).moved(&image_from_working).scaled(factor);
            Ok(CurveParts { decomposition, related_points, invariants: AffineInvariants::of(&working) })
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
    #[must_use]
    pub fn with_deviations(mut self, covariance: &FitCovariance) -> Self {
        let carried = CurveUncertainty::carried(self.fit.working(), &covariance.coefficients());
        let map = self.fit.normalisation().image_from_working();
        let linear = map.matrix().fixed_view::<2, 2>(0, 0).into_owned();
        let deviations_of = |c: &Matrix2<f64>| (linear * c * linear.transpose()).diagonal().map(f64::sqrt).into();
        self.deviations = carried.ok().map(|carried| CurveDeviations {
            related_points: carried.points().iter().map(deviations_of).collect(),
            invariants: carried.invariants().map_or_else(Vec::new, |c| c.diagonal().iter().map(|v| v.sqrt()).collect()),
        });
        self
    }
}
