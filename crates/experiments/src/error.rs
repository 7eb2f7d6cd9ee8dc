use freeform_curve_fit::{FitError, SettingsError};
use freeform_decompose::DecompositionError;
use freeform_estimate::BoundError;
use freeform_motion::PipelineError;
use freeform_motion::tracker::TrackerError;
use freeform_outline_filter::FilterError;
use freeform_riccati::MotionModel;
use freeform_sim_camera::{ShapeError, SimulationError};

use crate::baseline::BaselineError;
use crate::monte_carlo::suite;
use crate::stress::Class;

/// Why an experiment cannot be made or gives nothing.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ExperimentError {
    /// The simulator refused a scene or its settings.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// A contour cannot be made.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// The tracker refused its settings.
    #[error(transparent)]
    Tracker(#[from] TrackerError),
    /// The bound of a setting cannot be given.
    #[error(transparent)]
    Bound(#[from] BoundError),
    /// A baseline refused its model.
    #[error(transparent)]
    Baseline(#[from] BaselineError),
    /// The motion filter refused its settings.
    #[error(transparent)]
    Filter(#[from] FilterError),
    /// The pipeline of the paper refused its settings.
    #[error(transparent)]
    Pipeline(#[from] PipelineError),
    /// The settings of a fit are refused.
    #[error(transparent)]
    FitSettings(#[from] SettingsError),
    /// An outline of a figure has no curve.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// The curve of a figure has no line factors.
    #[error(transparent)]
    Decomposition(#[from] DecompositionError),
    /// A figure has no outline to show.
    #[error("the {object} has no outline")]
    NoOutline {
        /// What it was to show.
        object: &'static str,
    },
    /// No setting of the suite has a name that contains this text.
    #[error(
        "no setting of the suite contains {text:?}; there are some for {} (docs/accuracy.md lists all)",
        suite::WORDS.join(", ")
    )]
    NoSuchSetting {
        /// What was looked for.
        text: String,
    },
    /// A method that does not identify the motion of a plane in space.
    #[error("the method {} identifies no motion in space, the motion filter does", method.name())]
    NoPlane {
        /// The method.
        method: crate::monte_carlo::Method,
    },
    /// The stress suite has no motions of this family.
    #[error("the stress suite has rigid, similarity and affine motion, no {model} one")]
    NoStressOfFamily {
        /// The family.
        model: MotionModel,
    },
    /// No kind of the stress suite has a class and name that contain this text.
    #[error(
        "no kind of the stress suite contains {text:?}; the classes are {} (--list shows all kinds)",
        Class::ALL.map(Class::name).join(", ")
    )]
    NoSuchKind {
        /// What was looked for.
        text: String,
    },
}
