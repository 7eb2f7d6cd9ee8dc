//! Whole recordings from a table, and what becomes of every frame as columns again.
use std::collections::HashMap;
use std::ffi::CString;
use std::sync::{Mutex, PoisonError};

use freeform_motion::estimate::{MotionEstimate, PointVelocity};
use freeform_motion::outline_io::{OutlineFrame, ReadError, ReadErrorKind, Span};
use freeform_motion::riccati::MotionModel;
use freeform_motion::tracker::{
    Followed, Method, NotStated, Observation, POINT_COLUMNS, ReadAhead, Recorded, Tracker, Trajectory, VELOCITY_NAMES,
};
use numpy::{IntoPyArray as _, PyArray1};
use pyo3::exceptions::{PyUserWarning, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};

use crate::estimate::or_nan;
use crate::observation::PyObservation;
use crate::outline::PyOutline;
use crate::table_arrays::{TableArrays, TableOutlines};
use crate::tracker::PyTracker;

/// Frames after which Python is asked whether to go on.
const FRAMES_BETWEEN_SIGNALS: usize = 64;

/// An item of a recording that is no frame: why its reading ended.
type Gap = Result<std::convert::Infallible, ReadError>;

/// Lets a tracker follow a recording from a table. `progress` is called with the number of frames done since it was called last.
#[pyfunction]
#[pyo3(signature = (tracker, table, progress = None))]
pub(crate) fn identify_table(
    py: Python<'_>,
    tracker: &PyTracker,
    table: TableArrays<'_>,
    progress: Option<Py<PyAny>>,
) -> PyResult<()> {
    follow(py, tracker, table.outlines()?, progress.as_ref(), |_| {})
}

/// The outlines of a table, each with the name of its object; frames whose points are no outline are left out.
#[pyfunction]
pub(crate) fn outlines_of_table(py: Python<'_>, table: TableArrays<'_>) -> PyResult<Vec<(String, PyOutline)>> {
    let outlines = table.outlines()?;
    py.detach(|| {
        let mut found = Vec::new();
        for outline in outlines {
            match recorded(outline) {
                Recorded::Outline(frame, ()) => found.push((frame.object, PyOutline { inner: frame.outline })),
                Recorded::Gap(Err(error)) => return Err(PyValueError::new_err(table_error(&error))),
                _ => {}
            }
        }
        Ok(found)
    })
}

/// Lets a tracker follow a recording from a table. Returns columns with one row per object and frame.
#[pyfunction]
#[pyo3(signature = (tracker, table, smooth = false, progress = None))]
pub(crate) fn track_table<'py>(
    py: Python<'py>,
    tracker: &PyTracker,
    table: TableArrays<'py>,
    smooth: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let mut recording = begun(tracker, smooth);
    follow(py, tracker, table.outlines()?, progress.as_ref(), |observation| recording.take(observation))?;
    recording.columns(py, tracker, smooth)
}

/// A recording of what a tracker follows from now on, which may be smoothed.
fn begun(tracker: &PyTracker, smooth: bool) -> Recording {
    let mut tracker = tracker.lock();
    if smooth {
        tracker.record_expected_states();
    }
    Recording::new(&tracker)
}

/// What became of the frames that a tracker was given one by one, as columns.
#[pyclass(frozen, name = "Recorder", module = "freeform_motion")]
#[derive(Debug)]
pub(crate) struct PyRecorder {
    recording: Mutex<Recording>,
    smooth: bool,
}

#[pymethods]
impl PyRecorder {
    #[new]
    #[pyo3(signature = (tracker, smooth = false))]
    fn new(tracker: &PyTracker, smooth: bool) -> Self {
        Self { recording: Mutex::new(begun(tracker, smooth)), smooth }
    }

    /// Adds the observation of a frame.
    fn take(&self, observation: &PyObservation) {
        self.recording.lock().unwrap_or_else(PoisonError::into_inner).take(&observation.inner);
    }

    /// Columns with one row per observation; afterwards it is empty.
    fn columns<'py>(&self, py: Python<'py>, tracker: &PyTracker) -> PyResult<Bound<'py, PyDict>> {
        let empty = Recording::new(&tracker.lock());
        let recording = std::mem::replace(&mut *self.recording.lock().unwrap_or_else(PoisonError::into_inner), empty);
        recording.columns(py, tracker, self.smooth)
    }
}

/// Follows all outlines of a table, several objects on several threads, without the interpreter.
fn follow(
    py: Python<'_>,
    tracker: &PyTracker,
    outlines: TableOutlines<'_>,
    progress: Option<&Py<PyAny>>,
    mut observe: impl FnMut(&Observation) + Send,
) -> PyResult<()> {
    py.detach(|| {
        let mut frames = 0_usize;
        let recording = outlines.map(recorded);
        // Not behind its lock: the interpreter is waited for below.
        let mut following = tracker.lock().clone();
        following.follow_recording(recording, ReadAhead::default(), |followed| {
            let observation = match followed {
                Followed::Object(observation, _) => observation,
                Followed::Gap(Err(error)) => return Err(PyValueError::new_err(table_error(&error))),
                Followed::Gap(Ok(never)) => match never {},
            };
            observe(&observation);
            frames += 1;
            if frames.is_multiple_of(FRAMES_BETWEEN_SIGNALS) {
                Python::attach(|py| {
                    py.check_signals()?;
                    progress.map_or(Ok(()), |progress| progress.call1(py, (FRAMES_BETWEEN_SIGNALS,)).map(drop))
                })?;
            }
            Ok(())
        })?;
        *tracker.lock() = following;
        let rest = frames % FRAMES_BETWEEN_SIGNALS;
        progress.map_or(Ok(()), |progress| Python::attach(|py| progress.call1(py, (rest,)).map(drop)))
    })
}

/// Points that are not an outline are a frame without one; any other error ends the reading.
fn recorded(outline: Result<OutlineFrame, ReadError>) -> Recorded<(), Gap> {
    match outline {
        Ok(frame) => Recorded::Outline(frame, ()),
        Err(error) => match &error.kind {
            ReadErrorKind::Degenerate { object, frame, .. } => {
                let (object, frame) = (object.clone(), *frame);
                Recorded::NoOutline { object, frame, reason: table_error(&error) }
            }
            _ => Recorded::Gap(Err(error)),
        },
    }
}

/// An error with its place in the table, rows counted from 0.
fn table_error(error: &ReadError) -> String {
    let column = error.place.column.map_or(String::new(), |column| format!(", column {column}"));
    match error.place.span {
        Some(Span::Rows(first, last) | Span::Lines(first, last)) if first == last => {
            format!("row {first}{column}: {}", error.kind)
        }
        Some(Span::Rows(first, last) | Span::Lines(first, last)) => {
            format!("rows {first} to {last}{column}: {}", error.kind)
        }
        None => error.kind.to_string(),
    }
}

/// What is kept of every frame.
#[derive(Debug)]
pub(crate) struct Recording {
    method: Method,
    model: MotionModel,
    trajectory: Trajectory,
    phases: Vec<&'static str>,
    /// Of the adaptive method, which gives no poses: the motions, and which of their parameters are not stated and why.
    motions: Vec<(Option<MotionEstimate>, String)>,
}

impl Recording {
    /// Of what a tracker will observe.
    fn new(tracker: &Tracker) -> Self {
        let settings = tracker.settings();
        // The picture of a plane in space moves by projective maps.
        let model = settings.motion().model().unwrap_or(MotionModel::Projective);
        let (trajectory, phases, motions) = (Trajectory::default(), Vec::new(), Vec::new());
        Self { method: settings.method(), model, trajectory, phases, motions }
    }

    pub(crate) fn take(&mut self, observation: &Observation) {
        self.trajectory.take(observation);
        self.phases.push(observation.phase.map_or("", |phase| phase.name()));
        if self.method == Method::Adaptive {
            self.motions.push((observation.estimate, NotStated::cell(observation.unstated(self.model))));
        }
    }

    /// One row per observation, in their order.
    pub(crate) fn columns<'py>(
        mut self,
        py: Python<'py>,
        tracker: &PyTracker,
        smooth: bool,
    ) -> PyResult<Bound<'py, PyDict>> {
        let tracker = tracker.lock();
        let scale = tracker.settings().scale;
        let model = self.model;
        if smooth {
            let not_smoothed: Vec<String> = self.trajectory.smooth(&tracker).iter().map(ToString::to_string).collect();
            if let Some(first) = not_smoothed.first() {
                let others = match not_smoothed.len() - 1 {
                    0 => String::new(),
                    others => format!("; nor are those of {others} more object(s)"),
                };
                let message = CString::new(format!("{first}{others}").replace('\0', " "))?;
                // Level 2 is the line that calls `track`.
                PyErr::warn(py, &py.get_type::<PyUserWarning>(), &message, 2)?;
            }
        }
        let rows = self.trajectory.rows();
        let table = PyDict::new(py);
        let names: HashMap<&str, usize> = tracker.objects().zip(0..).collect();
        let objects: Vec<i64> =
            rows.iter().map(|row| names.get(row.object.as_str()).map_or(-1, |i| *i as i64)).collect();
        table.set_item("object", objects.into_pyarray(py))?;
        table.set_item("frame", PyArray1::from_iter(py, rows.iter().map(|row| row.frame)))?;
        table.set_item("time", PyArray1::from_vec(py, or_nan(rows.iter().map(|row| row.time))))?;
        table.set_item("phase", self.phases)?;
        table.set_item("accepted", PyArray1::from_iter(py, rows.iter().map(|row| row.accepted)))?;
        let segments: Vec<i64> = rows.iter().map(|row| row.segment as i64).collect();
        let (motions, velocities, unstated): (Vec<_>, Option<Vec<_>>, Vec<String>);
        if self.method == Method::Filter {
            let poses = self.trajectory.poses(scale);
            for (index, name) in Trajectory::pose_names(model).iter().enumerate() {
                let of = |pick: fn(&freeform_motion::estimate::PoseParameter) -> f64| {
                    or_nan(poses.iter().map(|known| known.as_ref().map(|known| pick(&known.pose[index]))))
                };
                table.set_item(*name, of(|parameter| parameter.value).into_pyarray(py))?;
                table.set_item(format!("{name}_std"), of(|parameter| parameter.standard_deviation).into_pyarray(py))?;
            }
            let of_rows = rows.iter().zip(&poses);
            unstated = of_rows.map(|(row, known)| NotStated::cell(row.unstated(known.as_ref(), model))).collect();
            velocities = Some(poses.iter().map(|known| known.as_ref()?.velocity).collect());
            motions = poses.into_iter().map(|known| known.map(|known| known.motion)).collect();
        } else {
            (motions, unstated) = self.motions.into_iter().unzip();
            velocities = None;
        }
        set_motions(&table, model, &motions)?;
        // The columns that came later are behind all others, as in the tables of the program.
        table.set_item("segment", PyArray1::from_iter(py, segments))?;
        if let Some(velocities) = &velocities {
            set_velocities(&table, velocities)?;
        }
        let reasons = rows.iter().map(|row| row.rejection.as_ref().map_or_else(String::new, ToString::to_string));
        table.set_item("reason", texts(py, reasons))?;
        table.set_item("unstated", texts(py, unstated))?;
        if let Some(velocities) = velocities {
            set_points(&table, &velocities)?;
        }
        Ok(table)
    }
}

/// Texts of which many are the same: each is one object.
fn texts<'py>(py: Python<'py>, texts: impl IntoIterator<Item = String>) -> Vec<Bound<'py, PyString>> {
    let mut known: HashMap<String, Bound<'py, PyString>> = HashMap::new();
    let mut shared = |text: String| match known.get(&text) {
        Some(same) => same.clone(),
        None => {
            let made = PyString::new(py, &text);
            known.insert(text, made.clone());
            made
        }
    };
    texts.into_iter().map(&mut shared).collect()
}

/// Columns for the velocity of the middle and for its standard deviations, NaN where it is not stated.
fn set_velocities(table: &Bound<'_, PyDict>, velocities: &[Option<PointVelocity>]) -> PyResult<()> {
    let stated = || velocities.iter().map(|velocity| velocity.filter(PointVelocity::is_finite));
    for (index, name) in VELOCITY_NAMES.into_iter().enumerate() {
        let values = stated().map(|velocity| Some(velocity?.velocity[index]));
        let deviations = stated().map(|velocity| Some(velocity?.standard_deviations()[index]));
        table.set_item(name, or_nan(values).into_pyarray(table.py()))?;
        table.set_item(format!("{name}_std"), or_nan(deviations).into_pyarray(table.py()))?;
    }
    Ok(())
}

/// Columns for the point that these velocities belong to, NaN where they are not stated.
fn set_points(table: &Bound<'_, PyDict>, velocities: &[Option<PointVelocity>]) -> PyResult<()> {
    for (index, name) in POINT_COLUMNS.into_iter().enumerate() {
        let stated = velocities.iter().map(|velocity| velocity.filter(PointVelocity::is_finite));
        let values = stated.map(|velocity| Some(velocity?.point[index]));
        table.set_item(name, or_nan(values).into_pyarray(table.py()))?;
    }
    Ok(())
}

/// A column for every parameter and one for its standard deviation, NaN where there is none.
fn set_motions(table: &Bound<'_, PyDict>, model: MotionModel, motions: &[Option<MotionEstimate>]) -> PyResult<()> {
    for (index, name) in model.parameter_names().iter().enumerate() {
        let parameter =
            |motion: &Option<MotionEstimate>| motion.as_ref().and_then(|motion| motion.parameters().nth(index));
        let values = motions.iter().map(|motion| parameter(motion)?.value);
        let deviations = motions.iter().map(|motion| parameter(motion)?.standard_deviation);
        table.set_item(*name, or_nan(values).into_pyarray(table.py()))?;
        table.set_item(format!("{name}_std"), or_nan(deviations).into_pyarray(table.py()))?;
    }
    Ok(())
}
