use freeform_motion::decompose::{AffineInvariants, Correspondence, Decomposition, Line, RelatedPoints};
use nalgebra::Complex;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::arrays::{array_of_points, array2};
use crate::errors::value_error;
use crate::outline::affine;
use crate::polynomial::PyImplicitPolynomial;

/// An implicit polynomial of degree n as a sum of products of complex lines `x + l y + k`.
///
/// `f = c_n prod (x + l_ni y + k_ni) + c_(n-2) prod (x + l_(n-2)i y + k_(n-2)i) + ... + c_0`. For an outline, `Fit.decompose` is more
/// accurate: it works in coordinates centred on the object.
///
/// Parameters
/// ----------
/// polynomial : ImplicitPolynomial
///
/// Raises
/// ------
/// ValueError
///     There is no decomposition, or it is not unique.
#[pyclass(frozen, name = "Decomposition", module = "freeform_motion")]
#[derive(Debug)]
pub(crate) struct PyDecomposition {
    pub(crate) inner: Decomposition,
}

/// Lines as an array of shape (m, 2): l, then k.
fn array_of_lines<'py>(py: Python<'py>, lines: &[Line]) -> Bound<'py, PyArray2<Complex<f64>>> {
    array2(py, lines.len(), 2, |i, j| if j == 0 { lines[i].l } else { lines[i].k })
}

#[pymethods]
impl PyDecomposition {
    #[new]
    fn new(polynomial: &PyImplicitPolynomial) -> PyResult<Self> {
        Ok(Self { inner: Decomposition::of(&polynomial.inner).map_err(value_error)? })
    }

    /// Degree n.
    #[getter]
    fn degree(&self) -> usize {
        self.inner.degree().value()
    }

    /// Coefficients c_n, c_(n-2), ..., c_0, shape (n / 2 + 1,).
    #[getter]
    fn coefficients<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let levels = self.inner.levels().chain([0]);
        PyArray1::from_vec(py, levels.map(|level| self.inner.coefficient(level)).collect())
    }

    /// c_(n-2) / c_n: the paper's alpha for a quartic.
    #[getter]
    fn alpha(&self) -> f64 {
        self.inner.alpha()
    }

    /// c_0 / c_n: the paper's beta for a quartic.
    #[getter]
    fn beta(&self) -> f64 {
        self.inner.beta()
    }

    /// The lines of a level.
    ///
    /// Parameters
    /// ----------
    /// level : int, optional
    ///     n, n - 2, ..., 2; n if left out.
    ///
    /// Returns
    /// -------
    /// ndarray, shape (level, 2), complex
    ///     A row (l, k) for each line; conjugate lines follow each other. Empty if there is no such level.
    #[pyo3(signature = (level = None))]
    fn lines<'py>(&self, py: Python<'py>, level: Option<usize>) -> Bound<'py, PyArray2<Complex<f64>>> {
        array_of_lines(py, self.inner.level(level.unwrap_or(self.degree())))
    }

    /// One line of every conjugate pair of a level: that with the positive imaginary part of l. What `AdaptiveIdentifier` takes.
    ///
    /// Parameters
    /// ----------
    /// level : int, optional
    ///     n, n - 2, ..., 2; n if left out.
    ///
    /// Returns
    /// -------
    /// ndarray, shape (m, 2), complex
    #[pyo3(signature = (level = None))]
    fn conjugate_pairs<'py>(&self, py: Python<'py>, level: Option<usize>) -> Bound<'py, PyArray2<Complex<f64>>> {
        let lines: Vec<Line> = self.inner.conjugate_pairs(level.unwrap_or(self.degree())).copied().collect();
        array_of_lines(py, &lines)
    }

    /// The related points, which move with the curve, highest level first, shape (m, 2).
    #[getter]
    fn related_points<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let related = RelatedPoints::of(&self.inner);
        array_of_points(py, related.as_slice().iter().map(|related| related.point))
    }

    /// Values of the monic polynomial at the related points, shape (m,). Only their ratios mean something.
    #[getter]
    fn related_values<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let related = RelatedPoints::of(&self.inner);
        PyArray1::from_vec(py, related.as_slice().iter().map(|related| related.value).collect())
    }

    /// Affine invariants of the curve, a vector of unit length; None where they cannot be told.
    #[getter]
    fn invariants<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        AffineInvariants::of(&self.inner).map(|invariants| PyArray1::from_slice(py, invariants.values()))
    }

    /// The decomposition of the curve moved by an affine map of the plane.
    ///
    /// Parameters
    /// ----------
    /// matrix : array_like, shape (3, 3)
    ///     The map in homogeneous coordinates; its last row is (0, 0, 1).
    ///
    /// Returns
    /// -------
    /// Decomposition
    fn moved(&self, matrix: &Bound<'_, PyAny>) -> PyResult<Self> {
        Ok(Self { inner: self.inner.moved(&affine(matrix)?).map_err(value_error)? })
    }

    /// The polynomial multiplied out.
    ///
    /// Returns
    /// -------
    /// ImplicitPolynomial
    fn expand(&self) -> PyImplicitPolynomial {
        PyImplicitPolynomial { inner: self.inner.expand() }
    }

    fn __repr__(&self) -> String {
        format!("Decomposition(degree {})", self.inner.degree())
    }
}

/// Which conjugate pair of lines of a later frame is which one of an earlier frame.
///
/// Parameters
/// ----------
/// earlier, later : Decomposition
/// object_size : float
///     A length in the unit of the outlines, such as the RMS radius.
///
/// Raises
/// ------
/// ValueError
///     Different numbers of pairs, or none.
#[pyclass(frozen, name = "Correspondence", module = "freeform_motion")]
#[derive(Debug)]
pub(crate) struct PyCorrespondence {
    inner: Correspondence,
}

#[pymethods]
impl PyCorrespondence {
    #[new]
    fn new(earlier: &PyDecomposition, later: &PyDecomposition, object_size: f64) -> PyResult<Self> {
        let inner = Correspondence::between(&earlier.inner, &later.inner, object_size).map_err(value_error)?;
        Ok(Self { inner })
    }

    /// `permutation[i]` is the pair of the later frame that pair i of the earlier one has become, shape (m,).
    #[getter]
    fn permutation<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        PyArray1::from_iter(py, self.inner.permutation().iter().map(|&pair| pair as i64))
    }

    /// Whether the order of the values at the related points and continuity give the same permutation.
    #[getter]
    fn agrees(&self) -> bool {
        self.inner.agrees()
    }
}
