use std::sync::{Mutex, MutexGuard, PoisonError};

use freeform_motion::outline_io::OutlineFrame;
use freeform_motion::riccati::CameraScale;
use freeform_motion::tracker::MethodSettings;
use freeform_motion::{Tracker, TrackerSettings, VelocityUnit};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::errors::{value_error, whole};
use crate::label_tracer::PyLabelTracer;
use crate::motion_filter::FilterArguments;
use crate::names::{camera_scale, method, motion_model, object_name};
use crate::object_result::PyObjectResult;
use crate::observation::PyObservation;
use crate::outline::outline_of;
use crate::plane::rectification;
use crate::result_warning::PyResultWarning;

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

/// The results of a tracker: of what was traced in masks in the unit of these, and with what is to be known of where all outlines come from.
#[pyfunction]
#[pyo3(signature = (tracker, tracer = None, origin = Vec::new()))]
#[expect(clippy::needless_pass_by_value, reason = "arguments from Python")]
pub(crate) fn results_of(
    tracker: &PyTracker,
    tracer: Option<PyRef<'_, PyLabelTracer>>,
    origin: Vec<PyRef<'_, PyResultWarning>>,
) -> Vec<PyObjectResult> {
    let tracker = tracker.lock();
    let settings = tracker.settings();
    let unit = match tracer.filter(|_| settings.rectification.is_none()) {
        Some(tracer) => tracer.velocity_unit(settings.scale.is_some()),
        None => VelocityUnit::default(),
    };
    let origin: Vec<PyResultWarning> = origin.iter().map(|warning| (**warning).clone()).collect();
    let results = tracker.results().into_iter().map(PyObjectResult::from);
    results.map(|result| result.with_velocities_in(unit).with_warnings(&origin)).collect()
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
    /// object : str or int
    ///     Name of the object; a whole number such as a label stands for its digits.
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
        #[pyo3(from_py_with = object_name)] object: String,
        #[pyo3(from_py_with = whole)] frame: u64,
        time: f64,
        outline: &Bound<'_, PyAny>,
    ) -> PyResult<PyObservation> {
        let outline = OutlineFrame { frame, time, object, outline: outline_of(outline)? };
        let (inner, scale) = py.detach(|| {
            let mut tracker = self.lock();
            (tracker.push(&outline), tracker.settings().scale)
        });
        Ok(PyObservation::new(inner, scale))
    }

    /// Does a part of the work that waits for the next outlines, in every object, while nothing else is to be done: see `MotionFilter.prepare`.
    /// Results are the same to the last bit whether, when and how often it is called.
    ///
    /// Returns
    /// -------
    /// bool
    ///     Whether more is waiting.
    fn prepare(&self, py: Python<'_>) -> bool {
        py.detach(|| self.lock().prepare())
    }

    /// Records a frame of an object whose points are no outline. It counts as rejected.
    ///
    /// Parameters
    /// ----------
    /// object : str or int
    ///     Name of the object; a whole number such as a label stands for its digits.
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
        #[pyo3(from_py_with = object_name)] object: String,
        #[pyo3(from_py_with = whole)] frame: u64,
        reason: String,
    ) -> PyObservation {
        let inner = py.detach(|| self.lock().reject(&object, frame, reason));
        PyObservation::new(inner, None)
    }

    /// The result for each object so far, in the order in which they first appeared.
    ///
    /// Returns
    /// -------
    /// list of ObjectResult
    fn results(&self) -> Vec<PyObjectResult> {
        self.lock().results().into_iter().map(Into::into).collect()
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

    /// Everything that the tracker knows, as bytes: 45 to 90 kB for each object, and more for some frames while its motion is being found.
    /// Pickling uses them too.
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
