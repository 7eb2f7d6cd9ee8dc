use freeform_motion::estimate::{MotionEstimate, MotionState, ParameterEstimate, PointVelocity, ProcessNoise};
use freeform_motion::{VelocityUnit, significant};
use nalgebra::DMatrix;
use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use serde::{Deserialize, Serialize};

use crate::arrays::{array_of_matrix, array_of_matrix3, array2, point};
use crate::errors::value_error;
use crate::pickled::{Pickled, Reduced};

/// One parameter of a motion.
#[pyclass(frozen, name = "Parameter", module = "freeform_motion")]
#[derive(Debug)]
pub(crate) struct PyParameter {
    inner: ParameterEstimate,
    /// Which it is one of.
    of: PyEstimate,
}

#[pymethods]
impl PyParameter {
    /// Name: `omega`, `b1`, `a3`, ...
    #[getter]
    fn name(&self) -> &'static str {
        self.inner.name
    }

    /// Unit: `rad/s`, `1/s`, or for b of masks whose pixels have the size 1, as `identify` gives it, `px/s` (with a pixel aspect
    /// `pixel heights/s`); in other units of length, and in observations, `1/s` is lengths per second.
    #[getter]
    fn unit(&self) -> &'static str {
        self.of.unit_of(&self.inner)
    }

    /// The value; None where the outlines tell nothing of it.
    #[getter]
    fn value(&self) -> Option<f64> {
        self.inner.value
    }

    /// Its standard deviation, all of it; None where the method gives none.
    #[getter]
    fn std(&self) -> Option<f64> {
        self.inner.standard_deviation
    }

    /// The part of it that comes from random errors of the points, which more frames average out.
    #[getter]
    fn std_random(&self) -> Option<f64> {
        self.inner.random_deviation
    }

    /// The part of it that comes from errors of whole outlines: of the edge uncertainty, and of what the motion model leaves out.
    #[getter]
    fn std_systematic(&self) -> Option<f64> {
        self.inner.systematic_deviation
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (PyEstimate, &'static str))> {
        Ok((py.import("operator")?.getattr("getitem")?, (self.of.clone(), self.inner.name)))
    }

    fn __repr__(&self) -> String {
        text(&self.inner, self.unit())
    }
}

fn text(parameter: &ParameterEstimate, unit: &str) -> String {
    let ParameterEstimate { name, value, standard_deviation, .. } = parameter;
    match (value, standard_deviation) {
        (None, _) => format!("{name} not observable"),
        (Some(value), None) => format!("{name} = {} {unit}", significant(*value, 6)),
        (Some(value), Some(std)) => {
            format!("{name} = {} +- {} {unit}", significant(*value, 6), significant(*std, 2))
        }
    }
}

/// An identified motion: one value per parameter of its model, and how well each is known.
#[pyclass(frozen, name = "Estimate", module = "freeform_motion")]
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct PyEstimate {
    inner: MotionEstimate,
    covariance: Option<DMatrix<f64>>,
    /// Saved behind the others, since estimates that were saved before have none.
    #[serde(skip)]
    velocity_unit: VelocityUnit,
}

impl Pickled for PyEstimate {
    const KIND: ([u8; 4], &'static str) = (*b"esti", "Estimate");

    fn to_bytes(&self) -> PyResult<Vec<u8>> {
        Self::format().encoded(&(self, self.velocity_unit)).map_err(value_error)
    }

    fn of_bytes(bytes: &[u8]) -> PyResult<Self> {
        let format = Self::format();
        match format.decoded::<(Self, VelocityUnit)>(bytes) {
            Ok((estimate, velocity_unit)) => Ok(estimate.with_velocities_in(velocity_unit)),
            Err(_) => format.decoded(bytes).map_err(value_error),
        }
    }
}

impl PyEstimate {
    pub(crate) fn new(inner: MotionEstimate, covariance: Option<DMatrix<f64>>) -> Self {
        Self { inner, covariance, velocity_unit: VelocityUnit::default() }
    }

    /// The same with velocities in a unit that has a name.
    pub(crate) fn with_velocities_in(self, velocity_unit: VelocityUnit) -> Self {
        Self { velocity_unit, ..self }
    }

    /// The unit of its velocities.
    pub(crate) fn velocity_unit(&self) -> VelocityUnit {
        self.velocity_unit
    }

    fn unit_of(&self, parameter: &ParameterEstimate) -> &'static str {
        let model = self.inner.model();
        let position = model.parameter_names().iter().position(|name| *name == parameter.name);
        let kind = position.map(|position| model.parameter_kinds()[position]);
        kind.map_or(parameter.unit, |kind| self.velocity_unit.of_parameter(kind, parameter.unit))
    }

    /// Whether a parameter of this name has a value.
    pub(crate) fn states(&self, name: &str) -> bool {
        self.inner.parameters().any(|parameter| parameter.name == name && parameter.value.is_some())
    }

    /// Its parameters in one line.
    pub(crate) fn text(&self) -> String {
        self.inner.parameters().map(|p| text(&p, self.unit_of(&p))).collect::<Vec<_>>().join(", ")
    }
}

/// Values of parameters, NaN where there is none.
pub(crate) fn or_nan(values: impl Iterator<Item = Option<f64>>) -> Vec<f64> {
    values.map(|value| value.unwrap_or(f64::NAN)).collect()
}

#[pymethods]
impl PyEstimate {
    /// The motion model: `rigid`, `similarity`, `affine` or `projective`.
    #[getter]
    fn motion(&self) -> String {
        self.inner.model().to_string()
    }

    /// Names of the parameters, a tuple of k.
    #[getter]
    fn names<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.inner.model().parameter_names())
    }

    /// Units of the parameters, a tuple of k.
    #[getter]
    fn units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.inner.parameters().map(|parameter| self.unit_of(&parameter)).collect::<Vec<_>>())
    }

    /// Values in the order of the names, shape (k,); NaN where a parameter is not observable.
    #[getter]
    fn values<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, or_nan(self.inner.parameters().map(|p| p.value)))
    }

    /// Standard deviations, all of them, shape (k,); NaN where there is none.
    #[getter]
    fn std<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, or_nan(self.inner.parameters().map(|p| p.standard_deviation)))
    }

    /// The parts of the standard deviations that come from random errors of the points, shape (k,); NaN where there is none.
    #[getter]
    fn std_random<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, or_nan(self.inner.parameters().map(|p| p.random_deviation)))
    }

    /// The parts of the standard deviations that come from errors of whole outlines, shape (k,): `std**2 = std_random**2 +
    /// std_systematic**2`. NaN where there is none.
    #[getter]
    fn std_systematic<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, or_nan(self.inner.parameters().map(|p| p.systematic_deviation)))
    }

    /// Whether each parameter is observable, shape (k,), bool.
    #[getter]
    fn observable<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        PyArray1::from_vec(py, self.inner.parameters().map(|p| p.value.is_some()).collect())
    }

    /// Covariance of the parameters, shape (k, k), as if unobservable directions were known; None where the method gives none.
    #[getter]
    fn covariance<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray2<f64>>> {
        self.covariance.as_ref().map(|covariance| array_of_matrix(py, covariance))
    }

    /// The generator A of the motion, `d/dt (x, y, 1) = A (x, y, 1)`, shape (3, 3); None where a parameter is not observable.
    #[getter]
    fn generator<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray2<f64>>> {
        self.inner.known_generator().map(|generator| array_of_matrix3(py, &generator))
    }

    fn __getitem__(&self, name: &str) -> PyResult<PyParameter> {
        let found = self.inner.parameters().find(|parameter| parameter.name == name);
        let names = || self.inner.model().parameter_names().join(", ");
        found
            .map(|inner| PyParameter { inner, of: self.clone() })
            .ok_or_else(|| PyKeyError::new_err(format!("{name:?} is none of {}", names())))
    }

    fn __len__(&self) -> usize {
        self.inner.model().parameter_count()
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(self.names(py)?.try_iter()?.into_any())
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        slf.get().reduced(&slf.get_type())
    }

    #[staticmethod]
    fn _restored(bytes: &[u8]) -> PyResult<Self> {
        Self::of_bytes(bytes)
    }

    fn __repr__(&self) -> String {
        format!("Estimate({})", self.text())
    }
}

/// Pose and motion of an object at one time, with their joint covariance, in the image.
#[pyclass(frozen, name = "MotionState", module = "freeform_motion")]
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct PyMotionState {
    pub(crate) inner: MotionState,
}

impl Pickled for PyMotionState {
    const KIND: ([u8; 4], &'static str) = (*b"moti", "MotionState");
}

/// Covariance of the motion of a state, shape (k, k), image units.
pub(crate) fn motion_covariance(state: &MotionState) -> DMatrix<f64> {
    let k = state.model().parameter_count();
    state.covariance().view((k, k), (k, k)).into_owned()
}

#[pymethods]
impl PyMotionState {
    /// Time in seconds.
    #[getter]
    fn time(&self) -> f64 {
        self.inner.time()
    }

    /// The motion at that time, with its covariance.
    #[getter]
    fn estimate(&self) -> PyEstimate {
        PyEstimate::new(self.inner.motion(), Some(motion_covariance(&self.inner)))
    }

    /// The map of the image from the first outline to its present place, in homogeneous coordinates, shape (3, 3).
    #[getter]
    fn pose<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        array_of_matrix3(py, self.inner.pose().matrix())
    }

    /// Names of the pose parameters: `angle`, `x` and `y` for a rigid motion.
    #[getter]
    fn pose_names<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.inner.pose_parameters().iter().map(|p| p.name).collect::<Vec<_>>())
    }

    /// The pose as numbers, in the order of the names. The angle is in radians between -pi and pi, positive where omega is; x and y say
    /// where the centre of the first outline is now. NaN where the outline does not show it, such as the angle of a circle.
    #[getter]
    fn pose_values<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.inner.pose_parameters().iter().map(|p| p.value).collect())
    }

    /// Standard deviations of the pose parameters; infinite where the outline does not show them.
    #[getter]
    fn pose_std<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.inner.pose_parameters().iter().map(|p| p.standard_deviation).collect())
    }

    /// Covariance of the pose error, then of the motion, each in the order of the motion parameters, shape (2 k, 2 k).
    #[getter]
    fn covariance<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        array_of_matrix(py, &self.inner.covariance())
    }

    /// The state predicted for another time.
    ///
    /// Parameters
    /// ----------
    /// time : float
    ///     Seconds.
    ///
    /// Returns
    /// -------
    /// MotionState
    fn predicted(&self, time: f64) -> PyResult<Self> {
        if !time.is_finite() {
            return Err(pyo3::exceptions::PyValueError::new_err(format!("time {time} is not finite")));
        }
        Ok(Self { inner: self.inner.predicted(time, &ProcessNoise::default()) })
    }

    /// Velocity of the point of the object that was at a place in the first frame.
    ///
    /// Parameters
    /// ----------
    /// first : array_like, shape (2,)
    ///     The place, image coordinates.
    ///
    /// Returns
    /// -------
    /// PointVelocity
    fn velocity_of(&self, first: &Bound<'_, PyAny>) -> PyResult<PyPointVelocity> {
        Ok(PyPointVelocity { inner: self.inner.velocity_of(&point(first)?) })
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        slf.get().reduced(&slf.get_type())
    }

    #[staticmethod]
    fn _restored(bytes: &[u8]) -> PyResult<Self> {
        Self::of_bytes(bytes)
    }

    fn __repr__(&self) -> String {
        let pose = self.inner.pose_parameters();
        let pose: Vec<String> = pose.iter().map(|p| format!("{} = {}", p.name, significant(p.value, 6))).collect();
        format!("MotionState(time = {}, {})", self.inner.time(), pose.join(", "))
    }
}

/// Velocity of a point of the object at one time.
#[pyclass(frozen, name = "PointVelocity", module = "freeform_motion")]
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct PyPointVelocity {
    pub(crate) inner: PointVelocity,
}

impl Pickled for PyPointVelocity {
    const KIND: ([u8; 4], &'static str) = (*b"velo", "PointVelocity");
}

#[pymethods]
impl PyPointVelocity {
    /// Where the point is at that time, shape (2,).
    #[getter]
    fn point<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.inner.point.coords.as_slice())
    }

    /// Its velocity, lengths per second, shape (2,).
    #[getter]
    fn velocity<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.inner.velocity.as_slice())
    }

    /// Standard deviations of both components, shape (2,).
    #[getter]
    fn std<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.inner.standard_deviations().as_slice())
    }

    /// Covariance of the velocity, shape (2, 2).
    #[getter]
    fn covariance<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        array2(py, 2, 2, |i, j| self.inner.covariance[(i, j)])
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        slf.get().reduced(&slf.get_type())
    }

    #[staticmethod]
    fn _restored(bytes: &[u8]) -> PyResult<Self> {
        Self::of_bytes(bytes)
    }

    fn __repr__(&self) -> String {
        let v = self.inner.velocity;
        format!("PointVelocity(velocity = ({}, {}))", significant(v.x, 6), significant(v.y, 6))
    }
}
