use freeform_motion::curve_fit::{ClosedOutline, OpenArc, OpenOutline, Outline, OutlineError, outward_normals};
use nalgebra::{Affine2, Point2};
use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::arrays::{array_of_points, array2, matrix3, points, vector};
use crate::errors::value_error;

/// What one frame shows of one object: a closed contour, or open arcs of it.
///
/// Parameters
/// ----------
/// points : array_like, shape (n, 2)
///     Points in the order of the contour, either way round, of any numeric type and in any length unit. A last point that repeats the
///     first is dropped.
/// deviations : array_like, shape (n,), optional
///     Standard deviations of the points along the normal of the contour, in the unit of the points: positive numbers. Filters weigh the
///     points by them.
///
/// Raises
/// ------
/// ValueError
///     Fewer than 3 points, a coordinate that is not finite, all points on one line; standard deviations that are not positive and
///     finite, or not one for each point.
/// TypeError
///     What is given are no real numbers.
#[pyclass(frozen, name = "Outline", module = "freeform_motion")]
#[derive(Debug, Clone)]
pub(crate) struct PyOutline {
    pub(crate) inner: Outline,
}

/// An outline from what stands for one: an `Outline`, or the points of a closed contour.
pub(crate) fn outline_of(value: &Bound<'_, PyAny>) -> PyResult<Outline> {
    match value.cast_exact::<PyOutline>() {
        Ok(outline) => Ok(outline.get().inner.clone()),
        Err(_) => closed(points(value)?, None),
    }
}

fn closed(mut points: Vec<Point2<f64>>, mut deviations: Option<Vec<f64>>) -> PyResult<Outline> {
    if let Some(found) = deviations.as_ref().map(Vec::len).filter(|found| *found != points.len()) {
        return Err(value_error(OutlineError::DeviationCount { found, points: points.len() }));
    }
    if points.len() > 1 && points.first() == points.last() {
        points.pop();
        deviations.as_mut().map(Vec::pop);
    }
    let outline = Outline::closed(points).map_err(value_error)?;
    match deviations {
        Some(deviations) => outline.with_deviations(deviations).map_err(value_error),
        None => Ok(outline),
    }
}

/// Standard deviations from an array of shape (n,).
fn deviations_of(value: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    vector(value, "deviations")
}

#[pymethods]
impl PyOutline {
    #[new]
    #[pyo3(signature = (points, deviations = None))]
    fn new(points: &Bound<'_, PyAny>, deviations: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let deviations = deviations.map(deviations_of).transpose()?;
        Ok(Self { inner: closed(crate::arrays::points(points)?, deviations)? })
    }

    /// An open outline of a partly hidden object.
    ///
    /// Parameters
    /// ----------
    /// arcs : sequence of array_like, each of shape (n, 2)
    ///     The pieces that are seen, in their order along the contour. Each may run either way round.
    /// deviations : sequence of array_like, each of shape (n,), optional
    ///     Standard deviations of the points along the normal of the contour, in the unit of the points: one array for each arc.
    ///
    /// Returns
    /// -------
    /// Outline
    #[staticmethod]
    #[pyo3(signature = (arcs, deviations = None))]
    fn from_arcs(arcs: &Bound<'_, PyAny>, deviations: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let mut pieces = Vec::new();
        for arc in arcs.try_iter()? {
            pieces.push(OpenArc::new(points(&arc?)?).map_err(value_error)?);
        }
        if let Some(deviations) = deviations {
            let lists = deviations.try_iter()?.map(|list| deviations_of(&list?)).collect::<PyResult<Vec<_>>>()?;
            if lists.len() != pieces.len() {
                let (found, expected) = (lists.len(), pieces.len());
                return Err(PyValueError::new_err(format!("deviations: {found} array(s) for {expected} arc(s)")));
            }
            let stating = pieces.into_iter().zip(lists).map(|(arc, list)| arc.with_deviations(list));
            pieces = stating.collect::<Result<_, _>>().map_err(value_error)?;
        }
        Ok(Self { inner: OpenOutline::new(pieces).map_err(value_error)?.into() })
    }

    /// All points, shape (n, 2); the arcs one after the other.
    #[getter]
    fn points<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        array_of_points(py, self.inner.points().copied())
    }

    /// The connected pieces, each of shape (n, 2): the boundary and the contours of holes and marks
    /// if the outline is closed, one per arc otherwise.
    #[getter]
    fn pieces<'py>(&self, py: Python<'py>) -> Vec<Bound<'py, PyArray2<f64>>> {
        self.inner.pieces().map(|piece| array_of_points(py, piece.points.iter().copied())).collect()
    }

    /// Standard deviations of the points along the normal of the contour, shape (n,), in the unit of the points and in their order; None
    /// where they are not known.
    #[getter]
    fn deviations<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        Some(PyArray1::from_vec(py, self.inner.deviations()?.collect()))
    }

    /// Whether this is the whole contour.
    #[getter]
    fn is_closed(&self) -> bool {
        matches!(self.inner, Outline::Closed(_))
    }

    /// Area of the polygon through all points, positive where they run counter-clockwise with y upwards.
    #[getter]
    fn signed_area(&self) -> f64 {
        self.inner.signed_area()
    }

    /// Mean of the points, shape (2,).
    #[getter]
    fn centroid<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let centroid = self.inner.centroid();
        PyArray1::from_vec(py, vec![centroid.x, centroid.y])
    }

    /// Root mean square distance of the points from their mean.
    #[getter]
    fn rms_radius(&self) -> f64 {
        self.inner.rms_radius()
    }

    /// This outline with every point moved by an affine map of the plane, and its standard deviation as the map stretches what lies across
    /// the contour there.
    ///
    /// Parameters
    /// ----------
    /// matrix : array_like, shape (3, 3)
    ///     The map in homogeneous coordinates; its last row is (0, 0, 1).
    ///
    /// Returns
    /// -------
    /// Outline
    fn moved(&self, matrix: &Bound<'_, PyAny>) -> PyResult<Self> {
        Ok(Self { inner: self.inner.moved(&affine(matrix)?).map_err(value_error)? })
    }

    /// Outward unit normals at the points, regressed over their neighbours.
    ///
    /// Parameters
    /// ----------
    /// half_window : float
    ///     Half width of the window, a share of the length of the outline, in [0, 0.25].
    ///
    /// Returns
    /// -------
    /// ndarray, shape (n, 2)
    #[pyo3(signature = (half_window = 0.02))]
    fn normals<'py>(&self, py: Python<'py>, half_window: f64) -> PyResult<Bound<'py, PyArray2<f64>>> {
        if !(0.0..=0.25).contains(&half_window) {
            return Err(PyValueError::new_err(format!("half window {half_window} is outside [0, 0.25]")));
        }
        let normals = outward_normals(&self.inner, half_window);
        Ok(array2(py, normals.len(), 2, |i, j| normals[i][j]))
    }

    fn __len__(&self) -> usize {
        self.inner.point_count()
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.inner == other.inner
    }

    fn __repr__(&self) -> String {
        let points = self.inner.point_count();
        match &self.inner {
            Outline::Closed(_) => format!("Outline({points} points)"),
            Outline::Open(open) => format!("Outline({points} points on {} open arc(s))", open.arcs().len()),
        }
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let outline = slf.get();
        let from_pieces = slf.get_type().getattr("_from_pieces")?;
        let arguments = (outline.pieces(py), outline.is_closed(), outline.deviations(py));
        Ok((from_pieces, arguments.into_pyobject(py)?))
    }

    /// As it was: no point is dropped and no arc turned.
    #[staticmethod]
    #[pyo3(signature = (pieces, is_closed, deviations = None))]
    fn _from_pieces(
        pieces: Vec<Bound<'_, PyAny>>,
        is_closed: bool,
        deviations: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let pieces = pieces.iter().map(points).collect::<PyResult<Vec<_>>>()?;
        let outline: Outline = if is_closed {
            let mut contours = pieces.into_iter();
            let boundary = ClosedOutline::new(contours.next().unwrap_or_default()).map_err(value_error)?;
            boundary.with_inner(contours.collect()).map_err(value_error)?.into()
        } else {
            let arcs = pieces.into_iter().map(OpenArc::new).collect::<Result<_, _>>().map_err(value_error)?;
            OpenOutline::in_sequence(arcs).map_err(value_error)?.into()
        };
        let inner = match deviations {
            Some(deviations) => outline.with_deviations(deviations_of(deviations)?).map_err(value_error)?,
            None => outline,
        };
        Ok(Self { inner })
    }
}

/// An affine map from a matrix of shape (3, 3).
pub(crate) fn affine(value: &Bound<'_, PyAny>) -> PyResult<Affine2<f64>> {
    let matrix = matrix3(value, "map")?;
    if matrix.iter().any(|entry| !entry.is_finite()) || matrix.row(2) != nalgebra::RowVector3::new(0.0, 0.0, 1.0) {
        return Err(PyValueError::new_err("map: finite numbers with a last row of 0, 0, 1 are needed"));
    }
    Ok(Affine2::from_matrix_unchecked(matrix))
}
