use std::sync::{Mutex, MutexGuard, PoisonError};

use freeform_motion::recognise::{Evidence, RecogniseSettings, Recogniser, Recognition};
use numpy::PyArray2;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arrays::array_of_matrix3;
use crate::errors::value_error;
use crate::outline::outline_of;

/// Compares outlines with known ones, whatever the affine maps between them.
///
/// Parameters
/// ----------
/// tracing : float
///     How well an outline is known at best, in radii of the disc that has its inertia, in (0, 0.1]: pixels and corners cut leave
///     differences that are no noise.
/// unknown : float
///     Probability before anything is seen that an object is none of the known ones, in (0, 1).
///
/// Examples
/// --------
/// >>> import freeform_motion as ff
/// >>> recogniser = ff.Recogniser()
/// >>> for name in ("plane", "phone", "hat"):
/// ...     recogniser.learn(name, ff.simulate(name).true_outline())
/// >>> seen = ff.Outline(ff.simulate("phone").true_outline()).moved([[0.9, 0.5, 3], [-0.3, 1.2, 1], [0, 0, 1]])
/// >>> recogniser.recognise(seen).name
/// 'phone'
#[pyclass(frozen, name = "Recogniser", module = "freeform_motion")]
#[derive(Debug)]
pub(crate) struct PyRecogniser {
    inner: Mutex<Recogniser>,
}

impl PyRecogniser {
    /// Held by no thread that waits for the interpreter.
    fn lock(&self) -> MutexGuard<'_, Recogniser> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl PyRecogniser {
    #[new]
    #[pyo3(signature = (*, tracing = 0.005, unknown = 0.5))]
    fn new(tracing: f64, unknown: f64) -> PyResult<Self> {
        let inner = Recogniser::new(RecogniseSettings { tracing, unknown }).map_err(value_error)?;
        Ok(Self { inner: Mutex::new(inner) })
    }

    /// Learns an outline under a name. Several outlines may bear one name.
    ///
    /// Parameters
    /// ----------
    /// name : str
    /// outline : Outline or array_like, shape (n, 2)
    ///     The whole outline.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     An outline of which a part is hidden, or that encloses no region.
    fn learn(&self, py: Python<'_>, name: String, outline: &Bound<'_, PyAny>) -> PyResult<()> {
        let outline = outline_of(outline)?;
        py.detach(|| self.lock().learn(name, &outline)).map_err(value_error)
    }

    /// Names of the known outlines in the order in which they were learnt.
    #[getter]
    fn names(&self) -> Vec<String> {
        self.lock().names().map(str::to_owned).collect()
    }

    /// Which known outline one outline is. `Evidence` takes several frames of an object.
    ///
    /// Parameters
    /// ----------
    /// outline : Outline or array_like, shape (n, 2)
    ///
    /// Returns
    /// -------
    /// Recognition
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     As `learn`; or nothing is known.
    fn recognise(slf: &Bound<'_, Self>, outline: &Bound<'_, PyAny>) -> PyResult<PyRecognition> {
        let evidence = PyEvidence::new(slf.clone().unbind());
        evidence.add(slf.py(), outline)?;
        evidence.recognition(slf.py()).ok_or_else(|| PyValueError::new_err("no outline is known"))
    }

    fn __len__(&self) -> usize {
        self.lock().names().len()
    }

    fn __repr__(&self) -> String {
        format!("Recogniser({} known outline(s))", self.__len__())
    }
}

/// What several frames of one object tell of which known outline it has.
///
/// Parameters
/// ----------
/// recogniser : Recogniser
///     What the frames are compared with.
#[pyclass(frozen, name = "Evidence", module = "freeform_motion")]
#[derive(Debug)]
pub(crate) struct PyEvidence {
    recogniser: Py<PyRecogniser>,
    inner: Mutex<(Evidence, Refused)>,
}

/// Frames that could not be compared.
#[derive(Debug, Clone, Default)]
struct Refused {
    frames: usize,
    first: Option<String>,
}

impl PyEvidence {
    fn lock(&self) -> MutexGuard<'_, (Evidence, Refused)> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl PyEvidence {
    #[new]
    fn new(recogniser: Py<PyRecogniser>) -> Self {
        Self { recogniser, inner: Mutex::default() }
    }

    /// Takes one more frame.
    ///
    /// Parameters
    /// ----------
    /// outline : Outline or array_like, shape (n, 2)
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     An outline of which a part is hidden, or that encloses no region. It is counted as rejected.
    fn add(&self, py: Python<'_>, outline: &Bound<'_, PyAny>) -> PyResult<()> {
        let outline = outline_of(outline)?;
        let compared = py.detach(|| self.recogniser.get().lock().compare(&outline));
        let mut inner = self.lock();
        let (evidence, refused) = &mut *inner;
        match compared {
            Ok(comparisons) => {
                evidence.add(&comparisons);
                Ok(())
            }
            Err(error) => {
                refused.frames += 1;
                refused.first.get_or_insert_with(|| error.to_string());
                Err(value_error(error))
            }
        }
    }

    /// What the frames tell together; None before the first one, or where nothing is known.
    #[getter]
    fn recognition(&self, py: Python<'_>) -> Option<PyRecognition> {
        let (evidence, refused) = self.lock().clone();
        let recogniser = self.recogniser.get();
        let (names, settings) = (recogniser.names(), *recogniser.lock().settings());
        let inner = py.detach(|| evidence.recognition(&settings))?;
        Some(PyRecognition { inner, names, frames: evidence.frames(), refused })
    }

    fn __repr__(&self) -> String {
        let (evidence, refused) = &*self.lock();
        format!("Evidence({} frames, {} rejected)", evidence.frames(), refused.frames)
    }
}

/// Which known outline an object has.
#[pyclass(frozen, name = "Recognition", module = "freeform_motion")]
#[derive(Debug)]
pub(crate) struct PyRecognition {
    inner: Recognition,
    names: Vec<String>,
    frames: usize,
    refused: Refused,
}

#[pymethods]
impl PyRecognition {
    /// Name of the known outline; None where it is more likely to be none of them.
    #[getter]
    fn name(&self) -> Option<&str> {
        self.inner.known.map(|known| self.names[known].as_str())
    }

    /// Probability of that, in [0, 1].
    #[getter]
    fn probability(&self) -> f64 {
        self.inner.probability
    }

    /// The affine map from the known outline to the one seen in the last frame, in homogeneous coordinates, shape (3, 3); None where the
    /// object is none of the known ones.
    #[getter]
    fn map<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray2<f64>>> {
        let known = self.inner.known?;
        let candidate = self.inner.candidates.iter().find(|candidate| candidate.known == known)?;
        candidate.map.map(|map| array_of_matrix3(py, map.matrix()))
    }

    /// Names of all known outlines with their probabilities, most probable first.
    #[getter]
    fn candidates(&self) -> Vec<(String, f64)> {
        let named = self.inner.candidates.iter();
        named.map(|candidate| (self.names[candidate.known].clone(), candidate.probability)).collect()
    }

    /// Frames that were compared.
    #[getter]
    fn frames(&self) -> usize {
        self.frames
    }

    /// Frames that could not be compared, as where a part of the outline is hidden.
    #[getter]
    fn frames_rejected(&self) -> usize {
        self.refused.frames
    }

    /// Why the first of them could not; None if there is none.
    #[getter]
    fn first_rejection(&self) -> Option<&str> {
        self.refused.first.as_deref()
    }

    fn __repr__(&self) -> String {
        let name = self.name().map_or("none of them".to_owned(), |name| format!("{name:?}"));
        format!("Recognition({name}, probability {:.3})", self.inner.probability)
    }
}
