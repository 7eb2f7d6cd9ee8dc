use freeform_curve_fit::{FitError, OutlineError, SettingsError};
use freeform_decompose::{CorrespondenceError, DecompositionError};
use freeform_identify::IdentifyError;
use freeform_riccati::DynamicsError;

/// Why a frame gave nothing, or a pipeline could not be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PipelineError {
    /// The size of the object in the identifier is out of its range: powers of it up to the degree of the curve are computed with.
    #[error("size of {size} in the identifier is not a number from 1e-6 to 1e6")]
    Size {
        /// The RMS radius asked for.
        size: f64,
    },
    /// The settings of the fit are refused.
    #[error("fit settings: {0}")]
    FitSettings(#[from] SettingsError),
    /// No curve could be fitted.
    #[error("no fit: {0}")]
    Fit(#[from] FitError),
    /// The curve has no decomposition into lines.
    #[error("no line decomposition: {0}")]
    Decomposition(#[from] DecompositionError),
    /// The lines could not be matched to those of the frame before.
    #[error("lines not matched: {0}")]
    Correspondence(#[from] CorrespondenceError),
    /// An outline cannot be moved to where it was in the first frame (projective motion).
    #[error("not moved to the first frame: {0}")]
    Outline(#[from] OutlineError),
    /// A line cannot be moved to the image (projective motion).
    #[error("no line in the image: {0}")]
    Line(#[from] DynamicsError),
    /// The identifier refused its settings or the lines.
    #[error("not identified: {0}")]
    Identify(#[from] IdentifyError),
    /// The fitted curve is not bounded, so that some of its lines are real.
    #[error("the fitted curve is not bounded (margin {margin:.1e})")]
    NotBounded {
        /// Minimum of the leading form on the unit circle over its root mean square.
        margin: f64,
    },
}
