use freeform_curve_fit::FitError;
use thiserror::Error;

/// Why an outline cannot be recognised, or cannot serve as a known one.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum RecogniseError {
    /// Open arcs: what is hidden leaves neither area moments nor a curve that could be compared.
    #[error("a part of the outline is hidden")]
    NotWhole,
    /// The outline encloses as much area one way round as the other, or crosses itself.
    #[error("the outline encloses no region")]
    NoRegion,
    /// No curve could be fitted to it.
    #[error("no curve could be fitted: {0}")]
    Fit(#[from] FitError),
    /// A setting outside its range.
    #[error("{name} is {value}, not in {range}")]
    Setting {
        /// Its name.
        name: &'static str,
        /// The value given.
        value: f64,
        /// What is accepted.
        range: &'static str,
    },
}
