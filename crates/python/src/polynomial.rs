use freeform_motion::curve_fit::ImplicitPolynomial;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::arrays::{array2, points, vector};
use crate::errors::{value_error, whole};
use crate::names::degree;
use crate::outline::affine;

/// Implicit polynomial `f(x, y) = sum a_ij x^i y^j` of even degree n, whose curve is `f = 0`. A fitted one is negative inside.
///
/// Parameters
/// ----------
/// degree : int
///     2, 4, 6 or 8.
/// coefficients : array_like, shape ((n + 1)(n + 2) / 2,)
///     In graded order: 1; x, y; x^2, x y, y^2; ...
#[pyclass(frozen, name = "ImplicitPolynomial", module = "freeform_motion")]
#[derive(Debug)]
pub(crate) struct PyImplicitPolynomial {
    pub(crate) inner: ImplicitPolynomial,
}

#[pymethods]
impl PyImplicitPolynomial {
    #[new]
    fn new(#[pyo3(from_py_with = whole)] degree: usize, coefficients: &Bound<'_, PyAny>) -> PyResult<Self> {
        let coefficients = vector(coefficients, "coefficients")?;
        let inner = ImplicitPolynomial::new(self::degree(degree)?, &coefficients).map_err(value_error)?;
        Ok(Self { inner })
    }

    /// Degree n.
    #[getter]
    fn degree(&self) -> usize {
        self.inner.degree().value()
    }

    /// Coefficients in graded order, shape ((n + 1)(n + 2) / 2,).
    #[getter]
    fn coefficients<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.inner.coefficients())
    }

    /// Values of f.
    ///
    /// Parameters
    /// ----------
    /// points : array_like, shape (m, 2)
    ///
    /// Returns
    /// -------
    /// ndarray, shape (m,)
    fn evaluate<'py>(&self, py: Python<'py>, points: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let points = self::points(points)?;
        let values = py.detach(|| points.iter().map(|p| self.inner.evaluate(p)).collect());
        Ok(PyArray1::from_vec(py, values))
    }

    /// Gradients of f.
    ///
    /// Parameters
    /// ----------
    /// points : array_like, shape (m, 2)
    ///
    /// Returns
    /// -------
    /// ndarray, shape (m, 2)
    fn gradient<'py>(&self, py: Python<'py>, points: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let points = self::points(points)?;
        let gradients: Vec<_> = py.detach(|| points.iter().map(|p| self.inner.gradient(p)).collect());
        Ok(array2(py, gradients.len(), 2, |i, j| gradients[i][j]))
    }

    /// The polynomial whose curve is this one moved by an affine map of the plane.
    ///
    /// Parameters
    /// ----------
    /// matrix : array_like, shape (3, 3)
    ///     The map in homogeneous coordinates; its last row is (0, 0, 1).
    ///
    /// Returns
    /// -------
    /// ImplicitPolynomial
    fn moved(&self, matrix: &Bound<'_, PyAny>) -> PyResult<Self> {
        Ok(Self { inner: self.inner.moved(&affine(matrix)?).map_err(value_error)? })
    }

    fn __repr__(&self) -> String {
        format!("ImplicitPolynomial(degree {})", self.inner.degree())
    }
}
