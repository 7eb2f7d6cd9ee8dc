use std::sync::{Mutex, MutexGuard, PoisonError};

use freeform_motion::decompose::Line;
use freeform_motion::identify::{AdaptiveIdentifier, AdaptiveSettings};
use nalgebra::Complex;
use numpy::{PyArray2, PyArrayMethods as _, PyUntypedArrayMethods as _};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::arrays::wrong_shape;
use crate::errors::{type_error, value_error};
use crate::estimate::PyEstimate;
use crate::names::{adaptive_law, motion_model};

/// The paper's adaptive identifier, over matched complex lines frame by frame. `Pipeline` goes from outlines to motion.
///
/// Parameters
/// ----------
/// motion : str
///     `rigid`, `similarity`, `affine` or `projective`.
/// law : str
///     How the parameters are adapted: `structured`, `filtered` (least squares, settles sooner) or `printed` (as in the paper).
#[pyclass(frozen, name = "AdaptiveIdentifier", module = "freeform_motion")]
#[derive(Debug)]
pub(crate) struct PyAdaptiveIdentifier {
    inner: Mutex<AdaptiveIdentifier>,
}

impl PyAdaptiveIdentifier {
    fn lock(&self) -> MutexGuard<'_, AdaptiveIdentifier> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Lines from an array of shape (m, 2): l, then k.
fn lines(value: &Bound<'_, PyAny>) -> PyResult<Vec<Line>> {
    let array = value.py().import("numpy")?.getattr("asarray")?.call1((value,))?;
    let kind: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
    if !matches!(kind.as_str(), "i" | "u" | "f" | "c") {
        return Err(type_error(format!(
            "lines: complex numbers are needed, these are of type {}",
            array.getattr("dtype")?
        )));
    }
    let array = array.call_method1("astype", ("complex128",))?;
    let shape: Vec<usize> = array.getattr("shape")?.extract()?;
    match array.cast::<PyArray2<Complex<f64>>>() {
        Ok(array) if array.shape()[1] == 2 => {
            let array = array.try_readonly()?;
            Ok(array.as_array().rows().into_iter().map(|line| Line { l: line[0], k: line[1] }).collect())
        }
        _ => Err(wrong_shape("lines", "(m, 2)", &shape)),
    }
}

#[pymethods]
impl PyAdaptiveIdentifier {
    #[new]
    #[pyo3(signature = (motion = "rigid", *, law = "structured"))]
    fn new(motion: &str, law: &str) -> PyResult<Self> {
        let (model, law) = (motion_model(motion)?, adaptive_law(law)?);
        let settings = AdaptiveSettings { model, law, ..AdaptiveSettings::default() };
        Ok(Self { inner: Mutex::new(AdaptiveIdentifier::new(settings).map_err(value_error)?) })
    }

    /// Takes the conjugate pairs of the next frame.
    ///
    /// Parameters
    /// ----------
    /// time : float
    ///     Seconds, after the time of the frame before.
    /// lines : array_like, shape (m, 2), complex
    ///     A row (l, k) for one line of each pair, in the same order as in the frame before: see `Decomposition.conjugate_pairs` and
    ///     `Correspondence`.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     Time that does not increase, another number of pairs than before, numbers that are not finite. Nothing is then changed.
    fn step(&self, py: Python<'_>, time: f64, lines: &Bound<'_, PyAny>) -> PyResult<()> {
        let lines = self::lines(lines)?;
        py.detach(|| self.lock().step(time, &lines)).map_err(value_error)
    }

    /// The motion as identified so far; None before the lines were followed once. The laws give no standard deviations.
    #[getter]
    fn estimate(&self) -> Option<PyEstimate> {
        self.lock().estimate().map(|estimate| PyEstimate::new(estimate, None))
    }

    /// Number of frames taken.
    #[getter]
    fn frames(&self) -> usize {
        self.lock().frames()
    }

    /// Whether the lines tell of the motion at all.
    #[getter]
    fn is_observable(&self) -> bool {
        self.lock().is_observable()
    }

    /// Everything that the identifier knows, as bytes: 0.5 to 3 kB. Pickling uses them too.
    ///
    /// Returns
    /// -------
    /// bytes
    ///     The first four are the version of the format.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = py.detach(|| self.lock().to_bytes()).map_err(value_error)?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// An identifier that goes on where the one that gave the bytes was, to the last bit.
    ///
    /// Parameters
    /// ----------
    /// data : bytes
    ///     From `to_bytes` of the same version.
    ///
    /// Returns
    /// -------
    /// AdaptiveIdentifier
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     Bytes of another version, damaged ones, or ones that describe no identifier.
    #[staticmethod]
    fn from_bytes(py: Python<'_>, data: &[u8]) -> PyResult<Self> {
        let inner = py.detach(|| AdaptiveIdentifier::from_bytes(data)).map_err(value_error)?;
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
        format!("AdaptiveIdentifier({} frames)", self.lock().frames())
    }
}
