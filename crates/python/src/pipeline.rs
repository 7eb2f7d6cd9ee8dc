use std::sync::{Mutex, MutexGuard, PoisonError};

use freeform_motion::{Pipeline, PipelineSettings};
use pyo3::prelude::*;

use crate::errors::value_error;
use crate::estimate::PyEstimate;
use crate::names::{adaptive_law, motion_model};
use crate::outline::outline_of;
use crate::tracker::PyResultWarning;

/// The method of the paper, from outlines to motion: fit a curve, decompose it into lines, match the lines, identify the motion.
///
/// Parameters
/// ----------
/// motion : str
///     `rigid`, `similarity`, `affine` or `projective`.
/// law : str, optional
///     How the parameters are adapted: `structured`, `filtered` (least squares, settles sooner) or `printed` (as in the paper). The default is
///     `structured` for rigid motions and similarities and `filtered` for the others.
#[pyclass(frozen, name = "Pipeline", module = "freeform_motion")]
#[derive(Debug)]
pub(crate) struct PyPipeline {
    inner: Mutex<Pipeline>,
}

impl PyPipeline {
    fn lock(&self) -> MutexGuard<'_, Pipeline> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl PyPipeline {
    #[new]
    #[pyo3(signature = (motion = "rigid", *, law = None))]
    fn new(motion: &str, law: Option<&str>) -> PyResult<Self> {
        let mut settings = PipelineSettings::for_model(motion_model(motion)?);
        if let Some(law) = law {
            settings.identify.law = adaptive_law(law)?;
        }
        Ok(Self { inner: Mutex::new(Pipeline::new(settings).map_err(value_error)?) })
    }

    /// Takes the next outline of the object.
    ///
    /// Parameters
    /// ----------
    /// time : float
    ///     Seconds, after the time of the frame before.
    /// outline : Outline or array_like, shape (n, 2)
    ///     The outline, or the points of a closed contour in order.
    ///
    /// Returns
    /// -------
    /// Estimate or None
    ///     The motion as identified so far; None before the lines were followed once.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     A frame that gives nothing. It counts as rejected, and the next one may be pushed.
    fn push(&self, py: Python<'_>, time: f64, outline: &Bound<'_, PyAny>) -> PyResult<Option<PyEstimate>> {
        let outline = outline_of(outline)?;
        let result = py.detach(|| self.lock().push(time, &outline)).map_err(value_error)?;
        Ok(result.estimate.map(|estimate| PyEstimate::new(estimate, None)))
    }

    /// The motion as identified so far; None before the lines were followed once.
    #[getter]
    fn estimate(&self) -> Option<PyEstimate> {
        self.lock().estimate().map(|estimate| PyEstimate::new(estimate, None))
    }

    /// Frames taken, rejected ones included.
    #[getter]
    fn frames(&self) -> usize {
        self.lock().frames()
    }

    /// Frames that gave nothing.
    #[getter]
    fn frames_rejected(&self) -> usize {
        self.lock().frames_rejected()
    }

    /// What a user should know of the result.
    #[getter]
    fn warnings(&self) -> Vec<PyResultWarning> {
        self.lock().warnings().iter().map(Into::into).collect()
    }

    fn __repr__(&self) -> String {
        let pipeline = self.lock();
        format!("Pipeline({} frames, {} rejected)", pipeline.frames(), pipeline.frames_rejected())
    }
}
