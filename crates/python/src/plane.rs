use freeform_motion::{Rectification, riccati};
use nalgebra::Projective2;
use numpy::PyArray2;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arrays::{array_of_matrix3, matrix3, points};
use crate::errors::value_error;

/// The projective map that takes points to points: exactly for four pairs, in the least-squares sense for more.
///
/// From points of a picture to where they are on a plane it is what `rectify` of `identify`, `track` and `Tracker` takes.
///
/// Parameters
/// ----------
/// picture, plane : array_like, shape (n, 2)
///     The points, n at least 4, and what they are taken to, in the same order.
///
/// Returns
/// -------
/// ndarray, shape (3, 3)
///
/// Raises
/// ------
/// ValueError
///     Fewer than four pairs; points that leave the map open, such as three of four on one line; points in another order.
///
/// Examples
/// --------
/// >>> import freeform_motion as ff
/// >>> sheet = ff.homography([[102, 391], [418, 402], [371, 120], [160, 117]], [[0, 0], [21, 0], [21, 29.7], [0, 29.7]])
/// >>> corner = sheet @ [371, 120, 1]
/// >>> (corner[:2] / corner[2]).round(6).tolist()
/// [21.0, 29.7]
#[pyfunction]
pub(crate) fn homography<'py>(
    py: Python<'py>,
    picture: &Bound<'py, PyAny>,
    plane: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let (picture, plane) = (points(picture)?, points(plane)?);
    if picture.len() != plane.len() {
        return Err(PyValueError::new_err(format!("{} and {} points", picture.len(), plane.len())));
    }
    let pairs: Vec<_> = picture.into_iter().zip(plane).collect();
    let map = riccati::homography(&pairs).map_err(value_error)?;
    Ok(array_of_matrix3(py, map.matrix()))
}

/// The map from a picture to a plane from a matrix of shape (3, 3).
pub(crate) fn rectification(value: &Bound<'_, PyAny>) -> PyResult<Rectification> {
    let map = matrix3(value, "rectify")?;
    Rectification::new(&Projective2::from_matrix_unchecked(map)).map_err(value_error)
}
