use freeform_motion::riccati::CameraScale;
use freeform_motion::tracker::{NotStated, ObjectPhase, Observation};
use pyo3::prelude::*;

use crate::estimate::{PyEstimate, PyMotionState, PyPointVelocity, motion_covariance};
use crate::result_warning::PyResultWarning;

/// The result of one frame of one object.
#[pyclass(frozen, name = "Observation", module = "freeform_motion")]
#[derive(Debug)]
pub(crate) struct PyObservation {
    pub(crate) inner: Observation,
    /// Camera scale of the tracker.
    scale: Option<CameraScale>,
}

impl PyObservation {
    pub(crate) const fn new(inner: Observation, scale: Option<CameraScale>) -> Self {
        Self { inner, scale }
    }
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
        let Observation { estimate, state, .. } = &self.inner;
        let image = state.as_ref().map(motion_covariance);
        estimate.map(|estimate| {
            let covariance = image.map(|image| match self.scale {
                Some(scale) => scale.covariance_in_space(estimate.model(), &image),
                None => image,
            });
            PyEstimate::new(estimate, covariance)
        })
    }

    /// Why a parameter is not stated, as known after the frame: `unobservable` (the outlines do not show it), `ambiguous` (two turns explain
    /// them) or `unknown` (not known well enough); None where it is stated.
    fn not_stated(&self, name: &str) -> Option<&'static str> {
        self.inner.not_stated(name).map(NotStated::name)
    }

    /// Velocity of the middle of the object, in space if a camera scale is given (motion filter); None where it is not known.
    #[getter]
    fn velocity(&self) -> Option<PyPointVelocity> {
        self.inner.velocity.map(|inner| PyPointVelocity { inner })
    }

    /// Why the velocity is not stated, as of the parameters; None where it is.
    #[getter]
    fn velocity_not_stated(&self) -> Option<&'static str> {
        self.inner.velocity_not_stated().map(NotStated::name)
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

    /// Normalised innovation squared (NIS): the innovation of the pose, squared in units of its covariance (motion filter).
    #[getter]
    fn innovation(&self) -> Option<f64> {
        self.inner.innovation
    }

    /// Counted up from 0 where poses get another reference: the object was begun anew, the second frame shows far more of it than the first, its turn
    /// is shown for the first time, another of several turns is taken, or an edge proves not to be of it. Nobody knows how far the object had turned
    /// between poses of different segments.
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
