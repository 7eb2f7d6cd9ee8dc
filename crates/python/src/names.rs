//! Names of models, methods and settings.
use freeform_motion::curve_fit::{Degree, Normalise};
use freeform_motion::identify::AdaptiveLaw;
use freeform_motion::outline_filter::{Dynamics, DynamicsWeights, Unstated, WrongFamily};
use freeform_motion::riccati::{CameraScale, MotionModel};
use freeform_motion::tracker::Method;
use freeform_motion::{TracedGround, Warning};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::{type_error, unknown_name, value_error};

/// The name of an object: a string, or a whole number such as a label.
pub(crate) fn object_name(value: &Bound<'_, PyAny>) -> PyResult<String> {
    match value.extract() {
        Ok(name) => Ok(name),
        Err(_) if value.extract::<i64>().is_ok() => Ok(value.str()?.to_string()),
        Err(_) => Err(type_error(format!(
            "object: a string or a whole number is needed, this is {}",
            value.get_type().name()?
        ))),
    }
}

pub(crate) fn motion_model(name: &str) -> PyResult<MotionModel> {
    let found = MotionModel::ALL.into_iter().find(|model| model.to_string() == name);
    found.ok_or_else(|| unknown_name("motion", name, &["rigid", "similarity", "affine", "projective"]))
}

pub(crate) fn method(name: &str) -> PyResult<Method> {
    let found = [Method::Filter, Method::Adaptive].into_iter().find(|method| method.name() == name);
    found.ok_or_else(|| unknown_name("method", name, &["filter", "adaptive"]))
}

pub(crate) fn adaptive_law(name: &str) -> PyResult<AdaptiveLaw> {
    match name {
        "structured" => Ok(AdaptiveLaw::Structured),
        "filtered" => Ok(AdaptiveLaw::FilteredLeastSquares),
        "printed" => Ok(AdaptiveLaw::Printed),
        "drem" => Ok(AdaptiveLaw::RegressorMixing),
        _ => Err(unknown_name("law", name, &["structured", "filtered", "printed", "drem"])),
    }
}

pub(crate) fn normalise(name: &str) -> PyResult<Normalise> {
    match name {
        "similarity" => Ok(Normalise::Similarity),
        "affine" => Ok(Normalise::Affine),
        _ => Err(unknown_name("normalise", name, &["similarity", "affine"])),
    }
}

pub(crate) fn dynamics(name: &str) -> PyResult<Dynamics> {
    name.parse().map_err(|_| unknown_name("dynamics", name, &Dynamics::ALL.map(Dynamics::name)))
}

/// Probabilities by the names of the hypotheses.
pub(crate) fn dynamics_weights<'py>(py: Python<'py>, weights: &DynamicsWeights) -> PyResult<Bound<'py, PyDict>> {
    let DynamicsWeights { generator, velocity, accelerating } = *weights;
    let dict = PyDict::new(py);
    for (hypothesis, weight) in
        [(Dynamics::Generator, generator), (Dynamics::Velocity, velocity), (Dynamics::Accelerating, accelerating)]
    {
        dict.set_item(hypothesis.name(), weight)?;
    }
    Ok(dict)
}

/// The codes of the warnings that say the same.
pub(crate) fn wrong_family_name(family: WrongFamily) -> &'static str {
    let code = Warning::WrongFamily { family, motion: MotionModel::Rigid, ground: TracedGround::default() }.code();
    code.strip_prefix("wrong_family_").unwrap_or(code)
}

pub(crate) fn unstated_name(unstated: Unstated) -> &'static str {
    match unstated {
        Unstated::Lost => Warning::Lost { last_known: None }.code(),
        Unstated::ManyRejected { rejected, frames } => Warning::TooManyRejected { rejected, frames }.code(),
    }
}

pub(crate) fn degree(value: usize) -> PyResult<Degree> {
    Degree::try_from(value).map_err(value_error)
}

pub(crate) fn camera_scale(value: Option<f64>) -> PyResult<Option<CameraScale>> {
    value.map(CameraScale::new).transpose().map_err(value_error)
}
