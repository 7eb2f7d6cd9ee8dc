use std::sync::{Mutex, MutexGuard, PoisonError};

use freeform_motion::outline_io::OutlineFrame;
use freeform_motion::riccati::CameraScale;
use freeform_motion::tracker::{MethodSettings, ObjectPhase, ObjectResult, Observation};
use freeform_motion::{Tracker, TrackerSettings, Warning};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::errors::{value_error, whole};
use crate::estimate::{PyEstimate, PyMotionState, PyPointVelocity};
use crate::motion_filter::FilterArguments;
use crate::names::{camera_scale, dynamics_weights, method, motion_model};
use crate::outline::outline_of;
use crate::plane::rectification;

/// Identifies the motion of many objects from their outlines. Memory does not grow with the number of frames.
///
/// Parameters
/// ----------
/// motion : str
///     The motion model: `rigid`, `similarity`, `affine` or `projective`.
/// method : str
///     `filter` for the motion filter, `adaptive` for the paper's adaptive identifier.
/// scale : float, optional
///     Camera scale f/Z0. If it is given, b and velocities are those in space: divided by it.
/// rectify : array_like, shape (3, 3), optional
///     Homography from the picture to the plane that the objects move in, where a camera looks at it from aside (see `homography`). All
///     results are then in the plane, in its unit of length.
/// process_noise, adaptive, dynamics, edge_uncertainty, mask_pixel, smallest_agreement, patience
///     Settings of the motion filter, as of `MotionFilter`.
#[pyclass(frozen, name = "Tracker", module = "freeform_motion")]
#[derive(Debug)]
pub(crate) struct PyTracker {
    inner: Mutex<Tracker>,
}

impl PyTracker {
    /// Held by no thread that waits for the interpreter.
    pub(crate) fn lock(&self) -> MutexGuard<'_, Tracker> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl PyTracker {
    #[new]
    #[pyo3(signature = (motion = "rigid", *, method = "filter", scale = None, rectify = None, process_noise = (0.0, 0.0),
                        adaptive = true, dynamics = "auto", edge_uncertainty = 0.0, mask_pixel = 0.0, smallest_agreement = 0.7, patience = 2),
           text_signature = "(motion='rigid', *, method='filter', scale=None, rectify=None, process_noise=(0.0, 0.0), adaptive=True, \
                             dynamics='auto', edge_uncertainty=0.0, mask_pixel=0.0, smallest_agreement=0.7, patience=2)")]
    #[expect(clippy::too_many_arguments, reason = "keywords of a Python class")]
    fn new(
        motion: &str,
        method: &str,
        scale: Option<f64>,
        rectify: Option<&Bound<'_, PyAny>>,
        process_noise: (f64, f64),
        adaptive: bool,
        dynamics: &str,
        edge_uncertainty: f64,
        mask_pixel: f64,
        smallest_agreement: f64,
        #[pyo3(from_py_with = whole)] patience: usize,
    ) -> PyResult<Self> {
        let mut settings = TrackerSettings::new(self::method(method)?, motion_model(motion)?);
        settings.scale = camera_scale(scale)?;
        settings.rectification = rectify.map(rectification).transpose()?;
        let arguments = FilterArguments {
            process_noise,
            adaptive,
            dynamics,
            edge_uncertainty,
            mask_pixel,
            smallest_agreement,
            patience,
        };
        let filter = arguments.settings(motion)?;
        if let MethodSettings::Filter(settings) = &mut settings.method {
            *settings = filter;
        }
        Ok(Self { inner: Mutex::new(Tracker::new(settings).map_err(value_error)?) })
    }

    /// Takes the next outline of an object. A new name starts a new object.
    ///
    /// Parameters
    /// ----------
    /// object : str
    ///     Name of the object.
    /// frame : int
    ///     Number of the frame, 0 or more.
    /// time : float
    ///     Seconds; the times of each object must increase.
    /// outline : Outline or array_like, shape (n, 2)
    ///     An outline, or the points of a closed contour in order.
    ///
    /// Returns
    /// -------
    /// Observation
    ///     Pose and motion after the frame; or why it was rejected.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     Points that are no outline.
    fn push(
        &self,
        py: Python<'_>,
        object: String,
        #[pyo3(from_py_with = whole)] frame: u64,
        time: f64,
        outline: &Bound<'_, PyAny>,
    ) -> PyResult<PyObservation> {
        let outline = OutlineFrame { frame, time, object, outline: outline_of(outline)? };
        let inner = py.detach(|| self.lock().push(&outline));
        Ok(PyObservation { inner })
    }

    /// Records a frame of an object whose points are no outline. It counts as rejected.
    ///
    /// Parameters
    /// ----------
    /// object : str
    ///     Name of the object.
    /// frame : int
    ///     Number of the frame, 0 or more.
    /// reason : str
    ///     What is told of it; should name the frame.
    ///
    /// Returns
    /// -------
    /// Observation
    fn reject(
        &self,
        py: Python<'_>,
        object: &str,
        #[pyo3(from_py_with = whole)] frame: u64,
        reason: String,
    ) -> PyObservation {
        let inner = py.detach(|| self.lock().reject(object, frame, reason));
        PyObservation { inner }
    }

    /// The result for each object so far, in the order in which they first appeared.
    ///
    /// Returns
    /// -------
    /// list of ObjectResult
    fn results(&self) -> Vec<PyObjectResult> {
        self.lock().results().into_iter().map(|inner| PyObjectResult { inner }).collect()
    }

    /// Names of the objects so far, in the order in which they first appeared.
    #[getter]
    fn objects(&self) -> Vec<String> {
        self.lock().objects().map(str::to_owned).collect()
    }

    /// Whether the motion of any object was seen to change.
    #[getter]
    fn motion_changed(&self) -> bool {
        self.lock().motion_changed()
    }

    /// The motion model.
    #[getter]
    fn motion(&self) -> String {
        self.lock().settings().motion().to_string()
    }

    /// `filter` or `adaptive`.
    #[getter]
    fn method(&self) -> &'static str {
        self.lock().settings().method().name()
    }

    /// Camera scale f/Z0; None if none was given.
    #[getter]
    fn scale(&self) -> Option<f64> {
        self.lock().settings().scale.map(CameraScale::value)
    }

    /// Everything that the tracker knows, as bytes: 30 to 70 kB for each object. Pickling uses them too.
    ///
    /// Returns
    /// -------
    /// bytes
    ///     The first four are the version of the format.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     What is known of an object cannot be saved.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = py.detach(|| self.lock().to_bytes()).map_err(value_error)?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// A tracker that goes on where the one that gave the bytes was, to the last bit.
    ///
    /// Parameters
    /// ----------
    /// data : bytes
    ///     From `to_bytes` of the same version.
    ///
    /// Returns
    /// -------
    /// Tracker
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     Bytes of another version, damaged ones, or ones that describe no tracker.
    #[staticmethod]
    fn from_bytes(py: Python<'_>, data: &[u8]) -> PyResult<Self> {
        let inner = py.detach(|| Tracker::from_bytes(data)).map_err(value_error)?;
        Ok(Self { inner: Mutex::new(inner) })
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyBytes>,))> {
        Ok((slf.get_type().getattr("from_bytes")?, (slf.get().to_bytes(slf.py())?,)))
    }

    fn __copy__(&self) -> Self {
        Self { inner: Mutex::new(self.lock().clone()) }
    }

    fn __deepcopy__(&self, _memo: &Bound<'_, PyAny>) -> Self {
        self.__copy__()
    }

    fn __repr__(&self) -> String {
        let tracker = self.lock();
        let settings = tracker.settings();
        format!("Tracker({}, {}, {} object(s))", settings.motion(), settings.method(), tracker.objects().len())
    }
}

/// Something that a user should know of a result.
#[pyclass(frozen, name = "ResultWarning", module = "freeform_motion", get_all)]
#[derive(Debug)]
pub(crate) struct PyResultWarning {
    /// A name that is the same in every version.
    code: &'static str,
    /// A sentence for people.
    message: String,
}

impl From<&Warning> for PyResultWarning {
    fn from(warning: &Warning) -> Self {
        Self { code: warning.code(), message: warning.to_string() }
    }
}

#[pymethods]
impl PyResultWarning {
    fn __str__(&self) -> &str {
        &self.message
    }

    fn __repr__(&self) -> String {
        format!("ResultWarning({}: {})", self.code, self.message)
    }
}

/// The result of one frame of one object.
#[pyclass(frozen, name = "Observation", module = "freeform_motion")]
#[derive(Debug)]
pub(crate) struct PyObservation {
    pub(crate) inner: Observation,
}

#[pymethods]
impl PyObservation {
    /// Name of the object.
    #[getter]
    fn object(&self) -> &str {
        &self.inner.object
    }

    /// Number of the frame.
    #[getter]
    fn frame(&self) -> u64 {
        self.inner.frame
    }

    /// Time in seconds; None if the points are no outline.
    #[getter]
    fn time(&self) -> Option<f64> {
        self.inner.time
    }

    /// `waiting`, `acquiring`, `tracking` or `lost` (motion filter), `start` or `adapt` (adaptive); None if the frame was not used at all.
    #[getter]
    fn phase(&self) -> Option<&'static str> {
        self.inner.phase.map(ObjectPhase::name)
    }

    /// Whether the frame was used.
    #[getter]
    fn is_accepted(&self) -> bool {
        self.inner.is_accepted()
    }

    /// Why it was not used; None if it was.
    #[getter]
    fn rejection(&self) -> Option<String> {
        self.inner.rejection.as_ref().map(ToString::to_string)
    }

    /// The motion estimated after the frame, in space if a camera scale is given; None if it is not known.
    #[getter]
    fn estimate(&self) -> Option<PyEstimate> {
        self.inner.estimate.map(|estimate| PyEstimate::new(estimate, None))
    }

    /// Pose and motion in the image with their joint covariance (motion filter), the last known ones.
    #[getter]
    fn state(&self) -> Option<PyMotionState> {
        self.inner.state.clone().map(|inner| PyMotionState { inner })
    }

    /// Noise of this frame (motion filter), or root mean square distance of the points from the fitted curve (adaptive), image lengths.
    #[getter]
    fn residual(&self) -> Option<f64> {
        self.inner.residual
    }

    /// Squared innovation of the pose in units of its covariance (motion filter).
    #[getter]
    fn innovation(&self) -> Option<f64> {
        self.inner.innovation
    }

    /// How often the object had been given up and begun anew: poses of different segments have different first outlines.
    #[getter]
    fn segment(&self) -> usize {
        self.inner.segment
    }

    /// A warning that should not wait for the end.
    #[getter]
    fn warning(&self) -> Option<PyResultWarning> {
        self.inner.warning.as_ref().map(Into::into)
    }

    fn __repr__(&self) -> String {
        let Observation { object, frame, rejection, .. } = &self.inner;
        match rejection {
            None => format!("Observation({object:?}, frame {frame}, accepted)"),
            Some(rejection) => format!("Observation(rejected: {rejection})"),
        }
    }
}

/// The result for an object after all its frames so far.
#[pyclass(frozen, name = "ObjectResult", module = "freeform_motion")]
#[derive(Debug)]
pub(crate) struct PyObjectResult {
    inner: ObjectResult,
}

#[pymethods]
impl PyObjectResult {
    /// Name of the object.
    #[getter]
    fn object(&self) -> &str {
        &self.inner.object
    }

    /// `filter` or `adaptive`.
    #[getter]
    fn method(&self) -> &'static str {
        self.inner.method.name()
    }

    /// The motion model.
    #[getter]
    fn motion(&self) -> String {
        self.inner.motion.to_string()
    }

    /// Number of frames, rejected ones included.
    #[getter]
    fn frames(&self) -> usize {
        self.inner.frames
    }

    /// Frames that were not used.
    #[getter]
    fn frames_rejected(&self) -> usize {
        self.inner.frames_rejected
    }

    /// Why the first of them was not used.
    #[getter]
    fn first_rejection(&self) -> Option<String> {
        self.inner.first_rejection.as_ref().map(ToString::to_string)
    }

    /// The last known motion, in space if a camera scale is given; None if no motion was found.
    #[getter]
    fn estimate(&self) -> Option<PyEstimate> {
        self.inner.estimate.map(|estimate| PyEstimate::new(estimate, None))
    }

    /// Velocity of the middle of the object in the last frame, in space if a camera scale is given (motion filter).
    #[getter]
    fn velocity(&self) -> Option<PyPointVelocity> {
        self.inner.velocity.map(|inner| PyPointVelocity { inner })
    }

    /// Other turns in radians, anticlockwise if y points up, that explain the outlines as well, shape (n,); empty where there is none.
    #[getter]
    fn rival_turns<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let turns = self.inner.ambiguity.as_ref().map_or(&[][..], |ambiguity| &ambiguity.rival_turns);
        PyArray1::from_slice(py, turns)
    }

    /// Other angular velocities that explain the outlines as well because they have a symmetry, shape (n,), rad/s; empty where there is
    /// none.
    #[getter]
    fn aliases<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.inner.aliases)
    }

    /// Probabilities of the hypotheses of dynamics, `generator`, `velocity` and `accelerating`, which sum up to 1 (motion filter); None
    /// where they are not told.
    #[getter]
    fn dynamics<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        self.inner.dynamics.map(|weights| dynamics_weights(py, &weights)).transpose()
    }

    /// What a user should know, causes before consequences: each with a `code` for programs and a `message` for people.
    #[getter]
    fn warnings(&self) -> Vec<PyResultWarning> {
        self.inner.warnings.iter().map(Into::into).collect()
    }

    fn __repr__(&self) -> String {
        let ObjectResult { object, frames, frames_rejected, estimate, warnings, .. } = &self.inner;
        let codes: Vec<_> = warnings.iter().map(Warning::code).collect();
        let codes = if codes.is_empty() { String::new() } else { format!(", warnings: {}", codes.join(", ")) };
        let estimate = estimate.map_or("no motion found".to_owned(), |estimate| {
            let estimate = PyEstimate::new(estimate, None);
            estimate.text()
        });
        format!("ObjectResult({object:?}, {frames} frames, {frames_rejected} rejected, {estimate}{codes})")
    }
}
