use std::sync::{Mutex, MutexGuard, PoisonError};

use freeform_motion::{Pipeline, PipelineSettings};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::errors::value_error;
use crate::estimate::PyEstimate;
use crate::names::{adaptive_law, motion_model};
use crate::outline::outline_of;
use crate::result_warning::PyResultWarning;

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

    /// Everything that the pipeline knows, as bytes: 1.5 to 15 kB. Pickling uses them too.
    ///
    /// Returns
    /// -------
    /// bytes
    ///     The first four are the version of the format.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = py.detach(|| self.lock().to_bytes()).map_err(value_error)?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// A pipeline that goes on where the one that gave the bytes was, to the last bit.
    ///
    /// Parameters
    /// ----------
    /// data : bytes
    ///     From `to_bytes` of the same version.
    ///
    /// Returns
    /// -------
    /// Pipeline
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     Bytes of another version, damaged ones, or ones that describe no pipeline.
    #[staticmethod]
    fn from_bytes(py: Python<'_>, data: &[u8]) -> PyResult<Self> {
        let inner = py.detach(|| Pipeline::from_bytes(data)).map_err(value_error)?;
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
        let pipeline = self.lock();
        format!("Pipeline({} frames, {} rejected)", pipeline.frames(), pipeline.frames_rejected())
    }
}
