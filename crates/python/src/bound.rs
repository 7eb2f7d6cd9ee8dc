use std::sync::{Mutex, MutexGuard, PoisonError};

use freeform_motion::estimate::{BoundCovariance, BoundaryPoint, CramerRaoBound};
use nalgebra::Vector2;
use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arrays::{array_of_matrix, points, vector};
use crate::errors::value_error;
use crate::estimate::or_nan;
use crate::names::motion_model;

/// The Cramer-Rao bound of motion identification from outlines: no unbiased estimator of a constant motion has a smaller covariance, the
/// shape being known and the initial pose not.
///
/// Parameters
/// ----------
/// motion : str
///     The motion model: `rigid`, `similarity`, `affine` or `projective`.
/// parameters : array_like, shape (k,)
///     The true motion, in the order of the model.
///
/// Examples
/// --------
/// >>> import freeform_motion as ff
/// >>> bound = ff.CramerRaoBound("rigid", [1.5, 0.0, 0.0])
/// >>> for frame in ff.simulate("bird", omega=1.5, seconds=1.0, noise=0.0):
/// ...     bound.add_frame(frame.time, frame.outline.points, frame.outline.normals(), noise=0.005)
/// >>> bool(1e-4 < bound.std[0] < 1e-2)
/// True
#[pyclass(frozen, name = "CramerRaoBound", module = "freeform_motion")]
#[derive(Debug)]
pub(crate) struct PyCramerRaoBound {
    inner: Mutex<CramerRaoBound>,
}

impl PyCramerRaoBound {
    fn lock(&self) -> MutexGuard<'_, CramerRaoBound> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn bound(&self) -> PyResult<BoundCovariance> {
        self.lock().covariance().map_err(value_error)
    }
}

#[pymethods]
impl PyCramerRaoBound {
    #[new]
    fn new(motion: &str, parameters: &Bound<'_, PyAny>) -> PyResult<Self> {
        let bound = CramerRaoBound::new(motion_model(motion)?, &vector(parameters, "parameters")?);
        Ok(Self { inner: Mutex::new(bound.map_err(value_error)?) })
    }

    /// Adds the boundary points seen at a time.
    ///
    /// Parameters
    /// ----------
    /// time : float
    ///     Seconds.
    /// points : array_like, shape (n, 2)
    ///     Points of the boundary in the image.
    /// normals : array_like, shape (n, 2)
    ///     Unit normals of the boundary there.
    /// noise : float
    ///     Standard deviation of the noise of each point in every direction, image lengths.
    /// weight : float
    ///     How many observations each point stands for.
    #[pyo3(signature = (time, points, normals, noise, weight = 1.0))]
    fn add_frame(
        &self,
        py: Python<'_>,
        time: f64,
        points: &Bound<'_, PyAny>,
        normals: &Bound<'_, PyAny>,
        noise: f64,
        weight: f64,
    ) -> PyResult<()> {
        let (points, normals) = (self::points(points)?, self::points(normals)?);
        if points.len() != normals.len() {
            return Err(PyValueError::new_err(format!("{} points and {} normals", points.len(), normals.len())));
        }
        let boundary = points.into_iter().zip(normals).map(|(point, normal)| {
            let normal = Vector2::new(normal.x, normal.y);
            BoundaryPoint { point, normal }
        });
        let boundary: Vec<BoundaryPoint> = boundary.collect();
        py.detach(|| self.lock().add_frame(time, boundary, noise, weight)).map_err(value_error)
    }

    /// Smallest covariance of the parameters, shape (k, k), as if unobservable directions were known.
    #[getter]
    fn covariance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        Ok(array_of_matrix(py, &self.bound()?.covariance))
    }

    /// Smallest standard deviation of each parameter, shape (k,); NaN where it is not observable.
    #[getter]
    fn std<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(PyArray1::from_vec(py, or_nan(self.bound()?.standard_deviations())))
    }

    /// Whether each parameter is observable, shape (k,), bool.
    #[getter]
    fn observable<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<bool>>> {
        Ok(PyArray1::from_vec(py, self.bound()?.observable))
    }
}
