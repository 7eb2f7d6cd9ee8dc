use freeform_motion::curve_fit::{ClosedOutline, Outline, PixelGrid};
use freeform_motion::named_shape;
use freeform_motion::riccati::{AffineMotion, ProjectiveMotion, RigidMotion};
use freeform_motion::sim_camera::{
    BuiltInShape, Camera, Frame, Mask, Occlusion, Scene, SequenceLength, Settings, Shape, Simulator,
};
use nalgebra::Vector2;
use numpy::ndarray::Array3;
use numpy::{IntoPyArray as _, PyArray2, PyArray3};
use pyo3::exceptions::{PyIndexError, PyMemoryError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyRange;

use crate::arrays::{array_of_matrix3, array_of_points, points};
use crate::errors::{type_error, value_error, whole};
use crate::outline::PyOutline;

/// Points of the outline that a mask is drawn from.
const MASK_CORNERS: usize = 2000;

/// Most points of one outline, as in files.
const MOST_POINTS: usize = 1 << 22;

/// Share of the picture that is left free around the object.
const MARGIN: f64 = 0.05;

/// Simulates the outlines of a moving object.
///
/// The object has unit size in the image (the largest distance between two of its points is 1) and starts at the origin. Each frame has
/// new random points of the outline. The motion is given in space; the image moves with b times `scale`.
///
/// Parameters
/// ----------
/// shape : str or array_like, shape (n, 2)
///     Name of a built-in shape, a file (CSV polygon, or mask as PNG, BMP or GIF), or the corners of a polygon in order.
/// omega : float
///     Angular velocity in rad/s, positive clockwise (y up).
/// b : tuple of float
///     Velocity at the origin in lengths per second.
/// affine : tuple of 6 floats, optional
///     An affine motion a1, a2, a3, a4, b1, b2 instead of omega and b.
/// projective : tuple of 8 floats, optional
///     A projective motion a1, a2, a3, a4, b1, b2, c1, c2 instead of these.
/// scale : float
///     Camera scale f/Z0: image lengths per space length.
/// fps, seconds : float
///     Frames per second, and the length of the sequence.
/// points : int
///     Points on the whole outline.
/// noise : float
///     Standard deviation of the noise on each coordinate, image lengths.
/// occlusion : float
///     Share of the outline that is hidden, at a random place in every frame.
/// outliers : float
///     Share of the points that are outliers.
/// seed : int
///     Seed of all random numbers.
///
/// Returns
/// -------
/// Simulation
///     A sequence of frames, each with `time` and `outline`.
#[pyfunction]
#[pyo3(signature = (shape = None, *, omega = 1.0, b = (0.0, 0.0), affine = None, projective = None, scale = 1.0, fps = 30.0,
                    seconds = 4.0, points = 400, noise = 0.005, occlusion = 0.0, outliers = 0.0, seed = 0),
       text_signature = "(shape=None, *, omega=1.0, b=(0.0, 0.0), affine=None, projective=None, scale=1.0, fps=30.0, seconds=4.0, \
                         points=400, noise=0.005, occlusion=0.0, outliers=0.0, seed=0)")]
#[expect(clippy::too_many_arguments, reason = "keywords of a Python function")]
pub(crate) fn simulate(
    shape: Option<&Bound<'_, PyAny>>,
    omega: f64,
    b: (f64, f64),
    affine: Option<[f64; 6]>,
    projective: Option<[f64; 8]>,
    scale: f64,
    fps: f64,
    seconds: f64,
    #[pyo3(from_py_with = whole)] points: usize,
    noise: f64,
    occlusion: f64,
    outliers: f64,
    #[pyo3(from_py_with = whole)] seed: u64,
) -> PyResult<PySimulation> {
    check_points(points)?;
    let rigid = RigidMotion { omega, b1: b.0, b2: b.1 };
    let motion = match (affine, projective) {
        (None, None) => ProjectiveMotion::from(rigid),
        (Some([a1, a2, a3, a4, b1, b2]), None) => AffineMotion { a1, a2, a3, a4, b1, b2 }.into(),
        (None, Some([a1, a2, a3, a4, b1, b2, c1, c2])) => ProjectiveMotion { a1, a2, a3, a4, b1, b2, c1, c2 },
        (Some(_), Some(_)) => return Err(PyValueError::new_err("an affine or a projective motion, not both")),
    };
    if motion.generator().iter().any(|entry| !entry.is_finite()) {
        return Err(PyValueError::new_err("the motion is not finite"));
    }
    let scene = Scene::new(shape_of(shape)?, motion, Camera::new(scale).map_err(value_error)?);
    let settings = Settings {
        fps,
        length: SequenceLength::Seconds(seconds),
        points,
        noise,
        occlusion: Occlusion { fraction: occlusion, ..Occlusion::default() },
        outliers,
        seed,
        ..Settings::default()
    };
    Ok(PySimulation { inner: Simulator::new(scene, settings).map_err(value_error)? })
}

fn check_points(points: usize) -> PyResult<()> {
    if points > MOST_POINTS {
        return Err(PyValueError::new_err(format!("{points} points, more than {MOST_POINTS}")));
    }
    Ok(())
}

fn shape_of(value: Option<&Bound<'_, PyAny>>) -> PyResult<Shape> {
    let Some(value) = value else { return Ok(BuiltInShape::Bird.shape()) };
    let Ok(name) = value.extract::<String>() else {
        let polygon = points(value).map_err(|_| type_error("shape: a name or an array of shape (n, 2) is needed"))?;
        return Ok(Shape::from_polygon(&polygon).map_err(value_error)?.normalised());
    };
    named_shape(&name).map_err(value_error)
}

/// A simulated sequence: its frames by number, without the dropped ones.
#[pyclass(frozen, name = "Simulation", module = "freeform_motion", sequence)]
#[derive(Debug)]
pub(crate) struct PySimulation {
    inner: Simulator,
}

#[pymethods]
impl PySimulation {
    /// The generator of the motion in the image at time 0, shape (3, 3).
    #[getter]
    fn generator<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        array_of_matrix3(py, &self.inner.image_motion().generator())
    }

    /// The map from the shape to the image at a time.
    ///
    /// Parameters
    /// ----------
    /// time : float
    ///     Seconds, not negative.
    ///
    /// Returns
    /// -------
    /// ndarray, shape (3, 3)
    fn true_pose<'py>(&self, py: Python<'py>, time: f64) -> PyResult<Bound<'py, PyArray2<f64>>> {
        if !(time.is_finite() && time >= 0.0) {
            return Err(PyValueError::new_err(format!("time {time} is not a number from 0")));
        }
        Ok(array_of_matrix3(py, self.inner.true_pose(time).matrix()))
    }

    /// Exact points of the outline at a time, equally spaced.
    ///
    /// Parameters
    /// ----------
    /// time : float
    ///     Seconds, not negative.
    /// count : int
    ///     Number of points.
    ///
    /// Returns
    /// -------
    /// ndarray, shape (count, 2)
    #[pyo3(signature = (time = 0.0, count = 400))]
    fn true_outline<'py>(
        &self,
        py: Python<'py>,
        time: f64,
        #[pyo3(from_py_with = whole)] count: usize,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        check_points(count)?;
        Ok(array_of_points(py, self.inner.scene().true_outline(time, count)))
    }

    /// Masks of the moving object, as a segmentation would give them: 1 where a pixel is at least half covered, else 0.
    ///
    /// All frames are drawn to one scale, such that the whole path of the object fits into the picture, y upwards from the lower edge.
    /// Noise, occlusion and outliers of the outlines have no part in them.
    ///
    /// Parameters
    /// ----------
    /// height, width : int
    ///     Size of the masks in pixels.
    ///
    /// Returns
    /// -------
    /// ndarray, shape (frames, height, width), uint8
    #[pyo3(signature = (height = 240, width = 320))]
    fn masks<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = whole)] height: usize,
        #[pyo3(from_py_with = whole)] width: usize,
    ) -> PyResult<Bound<'py, PyArray3<u8>>> {
        let masks = py.detach(|| self.draw(height, width))?;
        Ok(masks.into_pyarray(py))
    }

    fn __len__(&self) -> usize {
        self.inner.frame_count()
    }

    fn __iter__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let numbers = PyRange::new(slf.py(), 0, slf.get().inner.frame_count() as isize)?;
        slf.py().import("builtins")?.getattr("map")?.call1((slf.getattr("__getitem__")?, numbers))
    }

    fn __getitem__(&self, index: isize) -> PyResult<PySimulatedFrame> {
        let count = self.inner.frame_count();
        let position = if index < 0 { index + count as isize } else { index };
        let frame = usize::try_from(position).ok().and_then(|position| self.inner.frame(position));
        frame
            .map(|inner| PySimulatedFrame { inner })
            .ok_or_else(|| PyIndexError::new_err(format!("no frame {index} of {count}")))
    }

    fn __repr__(&self) -> String {
        format!("Simulation({:?}, {} frames)", self.inner.scene().shape().name(), self.inner.frame_count())
    }
}

impl PySimulation {
    fn draw(&self, height: usize, width: usize) -> PyResult<Array3<u8>> {
        let count = self.inner.frame_count();
        let outline = |frame: usize| {
            let time = frame as f64 / self.inner.settings().fps;
            let points = self.inner.scene().true_outline(time, MASK_CORNERS);
            ClosedOutline::new(points).map(Outline::from).map_err(value_error)
        };
        let mut bounds = outline(0)?.bounding_box();
        for frame in 1..count {
            bounds = bounds.extended(outline(frame)?.points());
        }
        let room = [width as f64, height as f64].map(|pixels| pixels * (1.0 - 2.0 * MARGIN));
        let size = bounds.size();
        let pixel = (size.x / room[0]).max(size.y / room[1]);
        let middle = [0.5 * width as f64, 0.5 * height as f64];
        let grid = PixelGrid::new(middle, bounds.centre(), Vector2::new(pixel, -pixel));
        let pixels = count.checked_mul(height).and_then(|pixels| pixels.checked_mul(width)).unwrap_or(usize::MAX);
        let mut masks = Vec::new();
        if masks.try_reserve_exact(pixels).is_err() {
            return Err(PyMemoryError::new_err(format!("no memory for {count} masks of {height} x {width} pixels")));
        }
        for frame in 0..count {
            let mask = Mask::of_outline(&outline(frame)?, [width, height], &grid).map_err(value_error)?;
            masks.extend(mask.binary().grey.iter().map(|grey| u8::from(*grey > 0)));
        }
        Array3::from_shape_vec((count, height, width), masks).map_err(value_error)
    }
}

/// One frame of a simulation.
#[pyclass(frozen, name = "SimulatedFrame", module = "freeform_motion")]
#[derive(Debug)]
pub(crate) struct PySimulatedFrame {
    inner: Frame,
}

#[pymethods]
impl PySimulatedFrame {
    /// Number of the frame.
    #[getter]
    fn index(&self) -> usize {
        self.inner.index
    }

    /// Time in seconds.
    #[getter]
    fn time(&self) -> f64 {
        self.inner.time
    }

    /// What is seen of the contour.
    #[getter]
    fn outline(&self) -> PyOutline {
        PyOutline { inner: self.inner.outline.clone() }
    }

    fn __repr__(&self) -> String {
        format!("SimulatedFrame({}, time = {})", self.inner.index, self.inner.time)
    }
}
