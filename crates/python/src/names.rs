//! Names of models, methods and settings.
use freeform_motion::curve_fit::Degree;
use freeform_motion::identify::AdaptiveLaw;
use freeform_motion::riccati::{CameraScale, MotionModel};
use freeform_motion::tracker::Method;
use pyo3::prelude::*;

use crate::errors::{unknown_name, value_error};

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
        _ => Err(unknown_name("law", name, &["structured", "filtered", "printed"])),
    }
}

pub(crate) fn degree(value: usize) -> PyResult<Degree> {
    Degree::try_from(value).map_err(value_error)
}

pub(crate) fn camera_scale(value: Option<f64>) -> PyResult<Option<CameraScale>> {
    value.map(CameraScale::new).transpose().map_err(value_error)
}
