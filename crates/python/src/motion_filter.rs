use std::sync::{Mutex, MutexGuard, PoisonError};

use freeform_motion::estimate::ProcessNoise;
use freeform_motion::outline_filter::{FilterSettings, FilterStep, MotionFilter, Phase};
use freeform_motion::outline_of_pixel_polygon;
use freeform_motion::tracker::ObjectPhase;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::arrays::{array_of_matrix3, array_of_points};
use crate::errors::{value_error, whole};
use crate::estimate::{PyEstimate, PyMotionState, PyPointVelocity};
use crate::names::{dynamics, dynamics_weights, motion_model, unstated_name, wrong_family_name};
use crate::outline::outline_of;

/// Identifies the motion of one object from its outlines, one frame after the other, in constant memory.
///
/// Pose, motion and outline are estimated together, with standard deviations. Frames that do not fit are rejected and counted.
///
/// Parameters
/// ----------
/// motion : str
///     The motion model: `rigid`, `similarity`, `affine` or `projective`.
/// process_noise : tuple of float
///     How fast the motion may change, as standard deviations per square root of a second: of its rates in 1/s, and of the velocity of
///     the object's centre in lengths per second. Zeros leave it to the frames to show changes.
/// adaptive : bool
///     Whether changes of a motion without process noise are followed. If False, the motion is taken for constant.
/// dynamics : str
///     What is assumed of how the motion goes on from frame to frame: `generator` (the velocity of the object's middle turns with the
///     object), `velocity` (it stays), `accelerating` (accelerations change slowly), or `auto` for all of them side by side, weighted by
///     their likelihoods. Without effect with process noise, without `adaptive`, and on projective motion.
/// edge_uncertainty : float
///     How far all of a side of the outlines may lie off in every frame, image lengths, such as by a shadow or by a threshold. It widens
///     the standard deviations.
/// mask_pixel : float
///     Size of a pixel of the masks that the outlines come from, image lengths; 0 leaves it to the points of the first outline, which lie on
///     pixels or on the lines between them if they come from a picture. An outline of a mask is off by the rounding to pixels, which stays while
///     the object moves by less than one: it widens the standard deviations, the less the farther the object moves. `identify` and `track`
///     of masks set it by themselves.
/// smallest_agreement : float
///     Smallest share of the points of a frame that must lie on the known outline, in (0, 1).
/// patience : int
///     Frames rejected in a row after which the object is searched for again.
///
/// Examples
/// --------
/// >>> import freeform_motion as ff
/// >>> motion_filter = ff.MotionFilter()
/// >>> for frame in ff.simulate("bird", omega=1.5, seconds=1.0):
/// ...     step = motion_filter.step(frame.time, frame.outline)
/// >>> abs(motion_filter.estimate["omega"].value - 1.5) < 0.01
/// True
#[pyclass(frozen, name = "MotionFilter", module = "freeform_motion")]
#[derive(Debug)]
pub(crate) struct PyMotionFilter {
    inner: Mutex<MotionFilter>,
}

impl PyMotionFilter {
    /// Held by no thread that waits for the interpreter.
    fn lock(&self) -> MutexGuard<'_, MotionFilter> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Arguments of a constructor that are settings of the filter, but for the motion model.
pub(crate) struct FilterArguments<'a> {
    pub(crate) process_noise: (f64, f64),
    pub(crate) adaptive: bool,
    pub(crate) dynamics: &'a str,
    pub(crate) edge_uncertainty: f64,
    pub(crate) mask_pixel: f64,
    pub(crate) smallest_agreement: f64,
    pub(crate) patience: usize,
}

impl FilterArguments<'_> {
    pub(crate) fn settings(&self, motion: &str) -> PyResult<FilterSettings> {
        let Self {
            process_noise: (rates, velocities),
            adaptive,
            edge_uncertainty,
            mask_pixel,
            smallest_agreement,
            patience,
            ..
        } = *self;
        Ok(FilterSettings {
            model: motion_model(motion)?,
            process_noise: ProcessNoise { rates, velocities },
            adaptive,
            dynamics: dynamics(self.dynamics)?,
            edge_uncertainty,
            mask_pixel,
            smallest_agreement,
            patience,
        })
    }
}

#[pymethods]
impl PyMotionFilter {
    #[new]
    #[pyo3(signature = (motion = "rigid", *, process_noise = (0.0, 0.0), adaptive = true, dynamics = "auto",
                        edge_uncertainty = 0.0, mask_pixel = 0.0, smallest_agreement = 0.7, patience = 2),
           text_signature = "(motion='rigid', *, process_noise=(0.0, 0.0), adaptive=True, dynamics='auto', edge_uncertainty=0.0, \
                             mask_pixel=0.0, smallest_agreement=0.7, patience=2)")]
    #[expect(clippy::too_many_arguments, reason = "keywords of a Python class")]
    fn new(
        motion: &str,
        process_noise: (f64, f64),
        adaptive: bool,
        dynamics: &str,
        edge_uncertainty: f64,
        mask_pixel: f64,
        smallest_agreement: f64,
        #[pyo3(from_py_with = whole)] patience: usize,
    ) -> PyResult<Self> {
        let arguments = FilterArguments {
            process_noise,
            adaptive,
            dynamics,
            edge_uncertainty,
            mask_pixel,
            smallest_agreement,
            patience,
        };
        let settings = arguments.settings(motion)?;
        Ok(Self { inner: Mutex::new(MotionFilter::new(settings).map_err(value_error)?) })
    }

    /// Takes the outline seen at a time.
    ///
    /// Parameters
    /// ----------
    /// time : float
    ///     Seconds, after the time of the frame before.
    /// outline : Outline or array_like, shape (n, 2)
    ///     An outline, or the points of a closed contour in order. Contours without standard deviations whose coordinates are all whole numbers,
    ///     with fewer than 40 points or a side of more than four times the mean length, are polygons with the corners of a mask, also in an
    ///     `Outline`: points are put along their sides, one for each pixel.
    ///
    /// Returns
    /// -------
    /// FilterStep
    ///     Whether the frame was used, and how it compares with the known outline.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     Points that are no outline, or a time that does not increase. The filter is then unchanged.
    fn step(&self, py: Python<'_>, time: f64, outline: &Bound<'_, PyAny>) -> PyResult<PyFilterStep> {
        let outline = outline_of(outline)?;
        let outline = outline_of_pixel_polygon(&outline).unwrap_or(outline);
        let inner = py.detach(|| self.lock().step(time, &outline)).map_err(value_error)?;
        Ok(PyFilterStep { inner })
    }

    /// Does a part of the work that waits for the next frame; whether more is waiting. Called between frames it makes the longest steps shorter; results
    /// are the same to the last bit.
    fn prepare(&self, py: Python<'_>) -> bool {
        py.detach(|| self.lock().prepare())
    }

    /// The motion estimated so far, with its covariance; None before the second accepted frame, and before the third where the first shows a
    /// part of the outline.
    #[getter]
    fn estimate(&self) -> Option<PyEstimate> {
        let filter = self.lock();
        filter.estimate().map(|estimate| PyEstimate::new(estimate, filter.covariance()))
    }

    /// Pose and motion with their joint covariance; None where `estimate` is.
    #[getter]
    fn state(&self) -> Option<PyMotionState> {
        self.lock().state().map(|inner| PyMotionState { inner })
    }

    /// Velocity of the middle of the object; it may be known while `b` is not, as for a circle. None where it is not known.
    #[getter]
    fn velocity(&self) -> Option<PyPointVelocity> {
        self.lock().velocity().map(|inner| PyPointVelocity { inner })
    }

    /// The map of the image from the first outline to its present place, shape (3, 3); None before the first frame.
    #[getter]
    fn pose<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray2<f64>>> {
        self.lock().pose().map(|pose| array_of_matrix3(py, pose.matrix()))
    }

    /// The outline as now known, image coordinates, shape (n, 2). The points are not in order if the map has grown.
    #[getter]
    fn outline_points<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        array_of_points(py, self.lock().outline_points())
    }

    /// `waiting`, `acquiring`, `tracking` or `lost`.
    #[getter]
    fn phase(&self) -> &'static str {
        phase_name(self.lock().phase())
    }

    /// Standard deviation of the noise on the points, image lengths; None before the first frame.
    #[getter]
    fn noise(&self) -> Option<f64> {
        self.lock().noise()
    }

    /// Frames used.
    #[getter]
    fn frames_accepted(&self) -> usize {
        self.lock().frames_accepted()
    }

    /// Frames that did not fit.
    #[getter]
    fn frames_rejected(&self) -> usize {
        self.lock().frames_rejected()
    }

    /// Whether the frames have shown a change of the motion.
    #[getter]
    fn motion_changed(&self) -> bool {
        self.lock().motion_changed()
    }

    /// How often the object was given up and the filter begun anew.
    #[getter]
    fn restarts(&self) -> usize {
        self.lock().restarts()
    }

    /// Other turns of the object, in radians, anticlockwise if y points up, that explain the frames about as well as the one taken.
    #[getter]
    fn rival_turns(&self) -> Vec<f64> {
        self.lock().rival_turns().to_vec()
    }

    /// Other angular velocities that explain the outlines as well because they have a symmetry, shape (n,), rad/s; of affine and projective motion
    /// mean ones, (a2 - a3) / 2. Empty where there is none.
    #[getter]
    fn aliases<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let aliases = self.lock().aliases();
        PyArray1::from_vec(py, aliases)
    }

    /// Probabilities of the hypotheses of dynamics, `generator`, `velocity` and `accelerating`, which sum up to 1; None where they are not
    /// told: before the third frame, with process noise, and for a projective motion that the outline does not show all of, as that of an ellipse.
    #[getter]
    fn dynamics<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let weights = self.lock().dynamics();
        weights.map(|weights| dynamics_weights(py, &weights)).transpose()
    }

    /// What the outlines do beyond doubt that the motion model does not: `growth`, `shear`, `perspective`, `rolling_shutter`, `lens` or `shape`.
    /// None if nothing. Standard deviations are widened by what it may do.
    #[getter]
    fn wrong_family(&self) -> Option<&'static str> {
        self.lock().wrong_family().map(wrong_family_name)
    }

    /// Why no value is stated although frames were taken: `lost`, or `too_many_rejected` where the frames that were taken are too few of
    /// all. None where values are stated.
    #[getter]
    fn unstated(&self) -> Option<&'static str> {
        self.lock().unstated().map(unstated_name)
    }

    /// The motion model.
    #[getter]
    fn motion(&self) -> String {
        self.lock().settings().model.to_string()
    }

    /// Everything that the filter knows, as bytes: 45 to 90 kB, and more for some frames while the motion is being found. Pickling uses them too.
    ///
    /// Returns
    /// -------
    /// bytes
    ///     The first four are the version of the format.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = py.detach(|| self.lock().to_bytes()).map_err(value_error)?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// A filter that goes on where the one that gave the bytes was, to the last bit.
    ///
    /// Parameters
    /// ----------
    /// data : bytes
    ///     From `to_bytes` of the same version.
    ///
    /// Returns
    /// -------
    /// MotionFilter
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     Bytes of another version, damaged ones, or ones that describe no filter.
    #[staticmethod]
    fn from_bytes(py: Python<'_>, data: &[u8]) -> PyResult<Self> {
        let inner = py.detach(|| MotionFilter::from_bytes(data)).map_err(value_error)?;
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
        let filter = self.lock();
        let (accepted, rejected) = (filter.frames_accepted(), filter.frames_rejected());
        let phase = phase_name(filter.phase());
        format!("MotionFilter({}, {phase}, {accepted} frames accepted, {rejected} rejected)", filter.settings().model)
    }
}

fn phase_name(phase: Phase) -> &'static str {
    ObjectPhase::from(phase).name()
}

/// The result of one frame.
#[pyclass(frozen, name = "FilterStep", module = "freeform_motion")]
#[derive(Debug)]
pub(crate) struct PyFilterStep {
    inner: FilterStep,
}

#[pymethods]
impl PyFilterStep {
    /// Time of the frame in seconds.
    #[getter]
    fn time(&self) -> f64 {
        self.inner.time
    }

    /// Phase after the frame: `acquiring`, `tracking` or `lost`.
    #[getter]
    fn phase(&self) -> &'static str {
        phase_name(self.inner.phase)
    }

    /// Whether the frame was used.
    #[getter]
    fn is_accepted(&self) -> bool {
        self.inner.is_accepted()
    }

    /// Why it was not used; None if it was.
    #[getter]
    fn rejection(&self) -> Option<String> {
        self.inner.rejection.map(|rejection| rejection.to_string())
    }

    /// Share of the points that lie on the known outline, in [0, 1]; None if there was nothing to compare with.
    #[getter]
    fn agreement(&self) -> Option<f64> {
        self.inner.measurement.map(|measurement| measurement.agreement)
    }

    /// Squared innovation of the pose in units of its covariance: about the number of motion parameters if the motion goes on.
    #[getter]
    fn innovation(&self) -> Option<f64> {
        self.inner.measurement.map(|measurement| measurement.innovation)
    }

    /// Standard deviation of the noise of this frame, image lengths.
    #[getter]
    fn noise(&self) -> Option<f64> {
        self.inner.measurement.and_then(|measurement| measurement.noise)
    }

    /// Points beyond the known ends of the outline.
    #[getter]
    fn new_points(&self) -> Option<usize> {
        self.inner.measurement.map(|measurement| measurement.new_points)
    }

    fn __bool__(&self) -> bool {
        self.inner.is_accepted()
    }

    fn __repr__(&self) -> String {
        let phase = phase_name(self.inner.phase);
        match self.inner.rejection {
            None => format!("FilterStep(time = {}, {phase}, accepted)", self.inner.time),
            Some(rejection) => format!("FilterStep(time = {}, {phase}, rejected: {rejection})", self.inner.time),
        }
    }
}
