//! Between numpy arrays and the types of the library.
use nalgebra::{DMatrix, Matrix3, Point2};
use numpy::ndarray::Array2;
use numpy::{
    IntoPyArray as _, PyArray1, PyArray2, PyArrayDyn, PyArrayMethods as _, PyReadonlyArray2, PyUntypedArrayMethods as _,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::errors::type_error;

/// Points from an array of shape (n, 2) of any numeric type, or from what numpy makes one of.
pub(crate) fn points(value: &Bound<'_, PyAny>) -> PyResult<Vec<Point2<f64>>> {
    // Not one of a class of its own, such as a masked array.
    if let Ok(array) = value.cast_exact::<PyArray2<f64>>() {
        return points_of_array(&array.try_readonly()?);
    }
    let array = numbers(value, "points")?;
    match array.cast::<PyArray2<f64>>() {
        Ok(array) => points_of_array(&array.try_readonly()?),
        Err(_) => Err(wrong_shape("points", "(n, 2)", array.shape())),
    }
}

fn points_of_array(array: &PyReadonlyArray2<'_, f64>) -> PyResult<Vec<Point2<f64>>> {
    if array.shape()[1] != 2 {
        return Err(wrong_shape("points", "(n, 2)", array.shape()));
    }
    // A slice of a Fortran array has its entries in another order.
    if array.is_c_contiguous()
        && let Ok(values) = array.as_slice()
    {
        return Ok(values.chunks_exact(2).map(|xy| Point2::new(xy[0], xy[1])).collect());
    }
    Ok(array.as_array().rows().into_iter().map(|xy| Point2::new(xy[0], xy[1])).collect())
}

/// One point from an array of shape (2,).
pub(crate) fn point(value: &Bound<'_, PyAny>) -> PyResult<Point2<f64>> {
    let values = vector(value, "point")?;
    match values[..] {
        [x, y] => Ok(Point2::new(x, y)),
        _ => Err(wrong_shape("point", "(2,)", &[values.len()])),
    }
}

/// Numbers from an array of shape (n,).
pub(crate) fn vector(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<f64>> {
    let array = numbers(value, what)?;
    match array.cast::<PyArray1<f64>>() {
        Ok(array) => Ok(array.try_readonly()?.as_array().to_vec()),
        Err(_) => Err(wrong_shape(what, "(n,)", array.shape())),
    }
}

/// A matrix of shape (3, 3).
pub(crate) fn matrix3(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Matrix3<f64>> {
    let array = numbers(value, what)?;
    match array.cast::<PyArray2<f64>>() {
        Ok(matrix) if matrix.shape() == [3, 3] => {
            let view = matrix.try_readonly()?;
            let view = view.as_array();
            Ok(Matrix3::from_fn(|i, j| view[(i, j)]))
        }
        _ => Err(wrong_shape(what, "(3, 3)", array.shape())),
    }
}

/// What numpy makes an array of real numbers of, as float64.
fn numbers<'py>(value: &Bound<'py, PyAny>, what: &str) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let numpy = value.py().import("numpy")?;
    let masked = value.hasattr("mask")? && numpy.getattr("ma")?.getattr("is_masked")?.call1((value,))?.is_truthy()?;
    if masked {
        return Err(PyValueError::new_err(format!("{what}: some are masked")));
    }
    let array = numpy.getattr("asarray")?.call1((value,))?;
    let kind: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
    if !matches!(kind.as_str(), "i" | "u" | "f") {
        let dtype = array.getattr("dtype")?;
        return Err(type_error(format!("{what}: real numbers are needed, these are of type {dtype}")));
    }
    let array = array.call_method1("astype", ("float64",))?;
    Ok(array.cast_into::<PyArrayDyn<f64>>()?)
}

pub(crate) fn wrong_shape(what: &str, expected: &str, found: &[usize]) -> PyErr {
    let sides: Vec<String> = found.iter().map(ToString::to_string).collect();
    let comma = if sides.len() == 1 { "," } else { "" };
    PyValueError::new_err(format!("{what}: shape {expected} is needed, this is ({}{comma})", sides.join(", ")))
}

/// An array of shape (n, 2).
pub(crate) fn array_of_points<'py>(
    py: Python<'py>,
    points: impl IntoIterator<Item = Point2<f64>>,
) -> Bound<'py, PyArray2<f64>> {
    let values: Vec<f64> = points.into_iter().flat_map(|p| [p.x, p.y]).collect();
    array2(py, values.len() / 2, 2, |i, j| values[2 * i + j])
}

/// An array of shape (rows, columns).
pub(crate) fn array2<T: numpy::Element>(
    py: Python<'_>,
    rows: usize,
    columns: usize,
    entry: impl Fn(usize, usize) -> T,
) -> Bound<'_, PyArray2<T>> {
    Array2::from_shape_fn((rows, columns), |(i, j)| entry(i, j)).into_pyarray(py)
}

/// An array of the shape of a matrix.
pub(crate) fn array_of_matrix<'py>(py: Python<'py>, matrix: &DMatrix<f64>) -> Bound<'py, PyArray2<f64>> {
    array2(py, matrix.nrows(), matrix.ncols(), |i, j| matrix[(i, j)])
}

/// An array of shape (3, 3).
pub(crate) fn array_of_matrix3<'py>(py: Python<'py>, matrix: &Matrix3<f64>) -> Bound<'py, PyArray2<f64>> {
    array2(py, 3, 3, |i, j| matrix[(i, j)])
}
