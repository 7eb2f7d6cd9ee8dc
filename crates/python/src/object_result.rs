use freeform_motion::VelocityUnit;
use freeform_motion::outline_filter::DynamicsWeights;
use freeform_motion::tracker::{NotStated, ObjectResult};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::{Deserialize, Serialize};

use crate::errors::value_error;
use crate::estimate::{PyEstimate, PyPointVelocity};
use crate::names::dynamics_weights;
use crate::pickled::{Pickled, Reduced};
use crate::result_warning::PyResultWarning;

/// The result for an object after all its frames so far.
#[pyclass(frozen, name = "ObjectResult", module = "freeform_motion")]
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct PyObjectResult {
    /// Name of the object.
    #[pyo3(get)]
    object: String,
    /// `filter` or `adaptive`.
    #[pyo3(get)]
    method: String,
    /// The motion model.
    #[pyo3(get)]
    motion: String,
    /// Number of frames, rejected ones included.
    #[pyo3(get)]
    frames: usize,
    /// Frames that were not used.
    #[pyo3(get)]
    frames_rejected: usize,
    /// Why the first of them was not used.
    #[pyo3(get)]
    first_rejection: Option<String>,
    /// The last known motion, in space if a camera scale is given; None if no motion was found.
    #[pyo3(get)]
    estimate: Option<PyEstimate>,
    /// Velocity of the middle of the object in the last frame, in space if a camera scale is given (motion filter).
    #[pyo3(get)]
    velocity: Option<PyPointVelocity>,
    rival_turns: Vec<f64>,
    aliases: Vec<f64>,
    dynamics: Option<[f64; 3]>,
    /// What a user should know, causes before consequences: each with a `code` for programs and a `message` for people.
    #[pyo3(get)]
    warnings: Vec<PyResultWarning>,
    /// Saved behind the others, since results that were saved before have none.
    #[serde(skip)]
    reasons: Reasons,
}

/// Why values of a result are not stated.
#[derive(Debug, Default, Serialize, Deserialize)]
struct Reasons {
    /// Names of parameters, each with its reason.
    of_parameters: Vec<(String, String)>,
    of_velocity: Option<String>,
}

impl Reasons {
    fn of(result: &ObjectResult) -> Self {
        let unstated = result.unstated().into_iter();
        Self {
            of_parameters: unstated.map(|(name, reason)| (name.to_owned(), reason.name().to_owned())).collect(),
            of_velocity: result.velocity_not_stated().map(|reason| reason.name().to_owned()),
        }
    }
}

impl From<ObjectResult> for PyObjectResult {
    fn from(result: ObjectResult) -> Self {
        let (reasons, covariance) = (Reasons::of(&result), result.covariance);
        Self {
            object: result.object,
            method: result.method.name().to_owned(),
            motion: result.motion.to_string(),
            frames: result.frames,
            frames_rejected: result.frames_rejected,
            first_rejection: result.first_rejection.map(|rejection| rejection.to_string()),
            estimate: result.estimate.map(|estimate| PyEstimate::new(estimate, covariance)),
            velocity: result.velocity.map(|inner| PyPointVelocity { inner }),
            rival_turns: result.ambiguity.map_or_else(Vec::new, |ambiguity| ambiguity.rival_turns),
            aliases: result.aliases,
            dynamics: result.dynamics.map(|weights| [weights.generator, weights.velocity, weights.accelerating]),
            warnings: result.warnings.iter().map(Into::into).collect(),
            reasons,
        }
    }
}

impl PyObjectResult {
    /// The same with velocities in a unit that has a name.
    pub(crate) fn with_velocities_in(self, unit: VelocityUnit) -> Self {
        Self { estimate: self.estimate.map(|estimate| estimate.with_velocities_in(unit)), ..self }
    }

    /// The same with more to be known of it, behind all other warnings.
    pub(crate) fn with_warnings(mut self, warnings: &[PyResultWarning]) -> Self {
        self.warnings.extend(warnings.iter().cloned());
        self
    }
}

impl Pickled for PyObjectResult {
    const KIND: ([u8; 4], &'static str) = (*b"obje", "ObjectResult");

    fn to_bytes(&self) -> PyResult<Vec<u8>> {
        let unit = self.estimate.as_ref().map(PyEstimate::velocity_unit).unwrap_or_default();
        Self::format().encoded(&(self, &self.reasons, unit)).map_err(value_error)
    }

    fn of_bytes(bytes: &[u8]) -> PyResult<Self> {
        let format = Self::format();
        if let Ok((result, reasons, unit)) = format.decoded::<(Self, Reasons, VelocityUnit)>(bytes) {
            return Ok(Self { reasons, ..result }.with_velocities_in(unit));
        }
        match format.decoded(bytes) {
            Ok((result, reasons)) => Ok(Self { reasons, ..result }),
            Err(_) => format.decoded(bytes).map_err(value_error),
        }
    }
}

#[pymethods]
impl PyObjectResult {
    /// Why a parameter is not stated: `unobservable` (the outlines do not show it), `ambiguous` (two turns explain them) or `unknown` (not known
    /// well enough, or saved by a version that did not tell); None where it is stated.
    fn not_stated(&self, name: &str) -> Option<&str> {
        let told = self.reasons.of_parameters.iter().find(|(parameter, _)| parameter == name);
        let is_stated = || self.estimate.as_ref().is_some_and(|estimate| estimate.states(name));
        match told {
            Some((_, reason)) => Some(reason),
            None => (!is_stated()).then_some(NotStated::Unknown.name()),
        }
    }

    /// Why `velocity` is None: `ambiguous` (it is another for each of the turns that explain the outlines) or `unknown`; None where it is stated.
    #[getter]
    fn velocity_not_stated(&self) -> Option<&str> {
        let reason = self.reasons.of_velocity.as_deref().unwrap_or(NotStated::Unknown.name());
        self.velocity.is_none().then_some(reason)
    }

    /// Other turns in radians, anticlockwise if y points up, that explain the outlines as well, shape (n,); empty where there is none.
    #[getter]
    fn rival_turns<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.rival_turns)
    }

    /// Other angular velocities that explain the outlines as well because they have a symmetry, shape (n,), rad/s; of affine and projective motion mean
    /// ones, (a2 - a3) / 2. Empty where there is none.
    #[getter]
    fn aliases<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.aliases)
    }

    /// Probabilities of the hypotheses of dynamics, `generator`, `velocity` and `accelerating`, which sum up to 1 (motion filter); None
    /// where they are not told.
    #[getter]
    fn dynamics<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let weights = self.dynamics.map(|[generator, velocity, accelerating]| DynamicsWeights {
            generator,
            velocity,
            accelerating,
        });
        weights.map(|weights| dynamics_weights(py, &weights)).transpose()
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        slf.get().reduced(&slf.get_type())
    }

    #[staticmethod]
    fn _restored(bytes: &[u8]) -> PyResult<Self> {
        Self::of_bytes(bytes)
    }

    fn __repr__(&self) -> String {
        let Self { object, frames, frames_rejected, estimate, warnings, .. } = self;
        let codes: Vec<_> = warnings.iter().map(PyResultWarning::code).collect();
        let codes = if codes.is_empty() { String::new() } else { format!(", warnings: {}", codes.join(", ")) };
        let estimate = estimate.as_ref().map_or("no motion found".to_owned(), PyEstimate::text);
        format!("ObjectResult({object:?}, {frames} frames, {frames_rejected} rejected, {estimate}{codes})")
    }
}
