use freeform_motion::curve_fit::{Fit, FitSettings, Fitter, Method, Outline};
use freeform_motion::decompose::Decomposition;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::arrays::array_of_points;
use crate::decomposition::PyDecomposition;
use crate::errors::{unknown_name, value_error, whole};
use crate::names::{degree, normalise};
use crate::outline::outline_of;
use crate::polynomial::PyImplicitPolynomial;

/// How far around an outline its curve is drawn, a share of its size.
const AROUND: f64 = 0.5;

/// Fits an implicit polynomial to an outline.
///
/// Parameters
/// ----------
/// outline : Outline or array_like, shape (n, 2)
///     The outline, or the points of a closed contour in order.
/// degree : int
///     2, 4, 6 or 8.
/// method : str
///     `bounded` for a curve that is closed by construction, `3l` or `gs3l`.
/// margin : float
///     How far a bounded curve stays from an unbounded one, in (0, 0.9].
/// ridge_weight : float
///     Weight of the rotation-invariant ridge of `bounded` and `gs3l`, at least 0.
/// offset : float
///     Distance of the outer level sets, in RMS radii of the outline, in (0, 1].
/// normal_half_window : float
///     Half width of the window that normals are regressed over, a share of the length of the outline, in [0, 0.25].
/// normalise : str
///     `similarity`, or `affine` for a closed outline: the fit of an affinely moved outline is then the moved fit.
///
/// Returns
/// -------
/// Fit
///
/// Raises
/// ------
/// ValueError
///     A setting out of range, or points that do not determine the coefficients.
#[pyfunction]
#[pyo3(signature = (outline, degree = 4, method = "bounded", *, margin = 0.02, ridge_weight = 0.0, offset = 0.1,
                    normal_half_window = 0.02, normalise = "similarity"))]
#[expect(clippy::too_many_arguments, reason = "keywords of a Python function")]
pub(crate) fn fit(
    py: Python<'_>,
    outline: &Bound<'_, PyAny>,
    #[pyo3(from_py_with = whole)] degree: usize,
    method: &str,
    margin: f64,
    ridge_weight: f64,
    offset: f64,
    normal_half_window: f64,
    normalise: &str,
) -> PyResult<PyFit> {
    let method = match method {
        "bounded" => Method::Bounded { margin, ridge_weight },
        "gs3l" => Method::GloballyStabilised { ridge_weight },
        "3l" => Method::ThreeLevel,
        _ => return Err(unknown_name("method", method, &["bounded", "gs3l", "3l"])),
    };
    let settings = FitSettings {
        degree: self::degree(degree)?,
        method,
        offset,
        normal_half_window,
        normalise: self::normalise(normalise)?,
    };
    let outline = outline_of(outline)?;
    let mut fitter = Fitter::new(settings).map_err(value_error)?;
    let inner = py.detach(|| fitter.fit(&outline)).map_err(value_error)?;
    Ok(PyFit { inner, outline })
}

/// A polynomial fitted to an outline, and how good it is.
#[pyclass(frozen, name = "Fit", module = "freeform_motion")]
#[derive(Debug)]
pub(crate) struct PyFit {
    inner: Fit,
    outline: Outline,
}

#[pymethods]
impl PyFit {
    /// The polynomial in image coordinates.
    #[getter]
    fn polynomial(&self) -> PyImplicitPolynomial {
        PyImplicitPolynomial { inner: self.inner.polynomial() }
    }

    /// The polynomial where the data has mean 0 and RMS radius 1 (`normalise="affine"`: the inertia of a disc). Better than `polynomial` for
    /// objects far from the origin.
    #[getter]
    fn working(&self) -> PyImplicitPolynomial {
        PyImplicitPolynomial { inner: *self.inner.working() }
    }

    /// Centre of the working coordinates: the mean of the points, shape (2,).
    #[getter]
    fn centre<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.inner.normalisation().centre.coords.as_slice())
    }

    /// Unit of length of the working coordinates: the RMS radius of the points.
    #[getter]
    fn radius(&self) -> f64 {
        self.inner.normalisation().radius
    }

    /// Whether the curve is closed and bounded.
    #[getter]
    fn is_bounded(&self) -> bool {
        self.inner.is_bounded()
    }

    /// Minimum of the leading form on the unit circle over its root mean square there: positive for a bounded curve.
    #[getter]
    fn boundedness_margin(&self) -> f64 {
        self.inner.diagnostics().boundedness_margin
    }

    /// Root mean square distance of the points from the curve, to first order, image lengths.
    #[getter]
    fn residual(&self) -> f64 {
        self.inner.diagnostics().geometric_residual
    }

    /// Condition number of the least-squares problem.
    #[getter]
    fn condition(&self) -> f64 {
        self.inner.diagnostics().condition
    }

    /// The curve near the outline as lines to be drawn.
    ///
    /// Returns
    /// -------
    /// list of ndarray, each of shape (m, 2)
    ///     Closed parts have their first point repeated.
    fn curve<'py>(&self, py: Python<'py>) -> Vec<Bound<'py, PyArray2<f64>>> {
        let parts = py.detach(|| self.inner.curve_within(&self.outline.bounding_box().widened(AROUND)));
        parts.into_iter().map(|part| array_of_points(py, part)).collect()
    }

    /// The complex lines of the curve, in image coordinates.
    ///
    /// Returns
    /// -------
    /// Decomposition
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     There is none, or it is not unique, as for a circle.
    fn decompose(&self) -> PyResult<PyDecomposition> {
        let working = Decomposition::of(self.inner.working()).map_err(value_error)?;
        let inner = working.moved(&self.inner.normalisation().image_from_working()).map_err(value_error)?;
        Ok(PyDecomposition { inner })
    }

    fn __repr__(&self) -> String {
        let bounded = if self.inner.is_bounded() { "bounded" } else { "not bounded" };
        let residual = freeform_motion::significant(self.residual(), 3);
        format!("Fit(degree {}, {bounded}, residual {residual})", self.inner.working().degree())
    }
}
