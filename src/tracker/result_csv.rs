use std::io::{self, Write};

use freeform_estimate::{MotionEstimate, PointVelocity};
use freeform_identify::AdaptiveDiagnostics;

use super::{
    family::MotionFamily,
    not_stated::NotStated,
    observation::{ObjectPhase, Observation},
    result::{ObjectResult, VELOCITY_NAMES},
    settings::Method,
};
use crate::VelocityUnit;
use crate::adaptive_progress::AdaptiveProgress;

/// Writes a trace as CSV: one row per object and frame with the parameters as identified so far. The columns are `object`, `frame`, `time`, `phase`,
/// `accepted`, then each parameter and its standard deviation (`_std`); with the motion filter, but of a plane in space, `v1`, `v1_std`, `v2` and
/// `v2_std`, the velocity of the middle of the object; `reason`, why the frame was not accepted; `unstated`, which values are empty and why, such
/// as `omega ambiguous; b1 ambiguous`, with the words of [`NotStated`]; and, with `v1` and `v2`, `point_x` and `point_y`: where that middle is.
///
/// ```
/// use freeform_motion::outline_io::{DEFAULT_OBJECT, OutlineFrame};
/// use freeform_motion::riccati::MotionModel;
/// use freeform_motion::sim_camera::{PaperExperiment, SequenceLength, Settings, Simulator};
/// use freeform_motion::tracker::TraceWriter;
/// use freeform_motion::{Tracker, TrackerSettings};
///
/// let settings = Settings { length: SequenceLength::Frames(3), ..Settings::default() };
/// let simulator = Simulator::new(PaperExperiment::FLIGHT_BIRD.scene(0.1)?, settings)?;
/// let mut tracker = Tracker::new(TrackerSettings::default())?;
/// let mut trace = TraceWriter::new(Vec::new(), MotionModel::Rigid.into(), None)?;
/// for (frame, seen) in (0..).zip(simulator.frames()) {
///     let outline = OutlineFrame { frame, time: seen.time, object: DEFAULT_OBJECT.to_owned(), outline: seen.outline };
///     trace.write(&tracker.push(&outline))?;
/// }
/// let text = String::from_utf8(trace.into_inner()?)?;
/// assert!(text.starts_with("object,frame,time,phase,accepted,omega,omega_std,b1,b1_std,b2,b2_std,v1,v1_std,v2,v2_std,reason,unstated,point_x,point_y\n"));
/// assert!(text.lines().nth(1).unwrap().ends_with(",omega unknown; b1 unknown; b2 unknown; v1 unknown; v2 unknown,,"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct TraceWriter<W: Write> {
    writer: csv::Writer<W>,
    family: MotionFamily,
    adaptive: Option<AdaptiveColumns>,
}

/// What a trace has of the adaptive law besides its parameters: columns `error`, `energy`, `lyapunov` and `excitation`.
#[derive(Debug, Clone, Default)]
pub struct AdaptiveColumns {
    /// The true motion in the image, where it is known and constant; the Lyapunov function is empty without it.
    pub truth: Option<MotionEstimate>,
}

impl AdaptiveColumns {
    const NAMES: [&str; 4] = ["error", "energy", "lyapunov", "excitation"];

    fn cells(&self, progress: Option<&AdaptiveProgress>) -> [String; 4] {
        let Some(progress) = progress else { return [const { String::new() }; 4] };
        let AdaptiveDiagnostics { error, energy, .. } = progress.diagnostics;
        let lyapunov = self.truth.as_ref().map(|truth| progress.lyapunov_function(truth));
        [Some(error), Some(energy), lyapunov, Some(progress.diagnostics.excitation())].map(optional)
    }
}

impl<W: Write> TraceWriter<W> {
    /// Begins a trace with its header, with columns for what the adaptive law is doing, if that is asked for.
    ///
    /// # Errors
    ///
    /// Those of the sink.
    pub fn new(sink: W, family: MotionFamily, adaptive: Option<AdaptiveColumns>) -> io::Result<Self> {
        let mut header: Vec<String> = ["object", "frame", "time", "phase", "accepted"].map(str::to_owned).into();
        header.extend(family.parameter_names().iter().flat_map(|name| [(*name).to_owned(), format!("{name}_std")]));
        header.extend(adaptive.iter().flat_map(|_| AdaptiveColumns::NAMES.map(str::to_owned)));
        let mut trace = Self { writer: csv::Writer::from_writer(sink), family, adaptive };
        if trace.has_velocity() {
            header.extend(velocity_columns());
        }
        // The last columns, so that those before them are where they always were.
        header.extend(["reason", "unstated"].map(str::to_owned));
        if trace.has_velocity() {
            header.extend(POINT_COLUMNS.map(str::to_owned));
        }
        trace.writer.write_record(&header).map_err(io::Error::from)?;
        Ok(trace)
    }

    /// Whether there are columns for the velocity of the middle.
    fn has_velocity(&self) -> bool {
        self.family.has_velocity(if self.adaptive.is_some() { Method::Adaptive } else { Method::Filter })
    }

    /// Writes what a frame of an object gave.
    ///
    /// # Errors
    ///
    /// Those of the sink.
    pub fn write(&mut self, observation: &Observation) -> io::Result<()> {
        let mut row = vec![
            text_cell(&observation.object),
            observation.frame.to_string(),
            optional(observation.time),
            observation.phase.map_or("", ObjectPhase::name).to_owned(),
            observation.is_accepted().to_string(),
        ];
        match observation.parameters() {
            Some(found) => row.extend(found.iter().flat_map(|p| [optional(p.value), optional(p.standard_deviation)])),
            None => row.extend(std::iter::repeat_n(String::new(), 2 * self.family.parameter_names().len())),
        }
        row.extend(self.adaptive.iter().flat_map(|adaptive| adaptive.cells(observation.progress.as_ref())));
        let mut velocity_unstated = None;
        if self.has_velocity() {
            row.extend(velocity_cells(observation.velocity.as_ref()));
            velocity_unstated = observation.velocity_not_stated();
        }
        row.push(observation.rejection.as_ref().map_or_else(String::new, ToString::to_string));
        let parameters = observation.unstated(self.family);
        row.push(NotStated::cell(parameters.into_iter().chain(of_velocity(velocity_unstated))));
        if self.has_velocity() {
            row.extend(point_cells(observation.velocity.as_ref()));
        }
        self.writer.write_record(&row).map_err(io::Error::from)
    }

    /// Writes out what is buffered and hands the sink back.
    ///
    /// # Errors
    ///
    /// Those of the sink.
    pub fn into_inner(self) -> io::Result<W> {
        self.writer.into_inner().map_err(csv::IntoInnerError::into_error)
    }
}

/// What begins a formula, also in the wide letters of East Asia, which some spreadsheets take for the others.
const BEGINS_FORMULA: [char; 10] = ['=', '+', '-', '@', '\t', '\r', '\u{ff1d}', '\u{ff0b}', '\u{ff0d}', '\u{ff20}'];

/// A name as a cell that no spreadsheet takes for a formula: with a `'` before what would begin one, also behind marks of byte order, which
/// some leave out. Numbers stay as they are.
pub(super) fn text_cell(name: &str) -> String {
    let seen = name.trim_start_matches('\u{feff}');
    let begins_formula = seen.starts_with(BEGINS_FORMULA) && seen.parse::<f64>().is_err();
    if begins_formula { format!("'{name}") } else { name.to_owned() }
}

/// Names of the columns of the velocity of the middle.
pub(super) fn velocity_columns() -> impl Iterator<Item = String> {
    VELOCITY_NAMES.into_iter().flat_map(|name| [name.to_owned(), format!("{name}_std")])
}

/// What is in them.
pub(super) fn velocity_cells(velocity: Option<&PointVelocity>) -> [String; 4] {
    let Some(velocity) = velocity.filter(|velocity| velocity.is_finite()) else { return Default::default() };
    let deviations = velocity.standard_deviations();
    [velocity.velocity.x, deviations.x, velocity.velocity.y, deviations.y].map(|number| number.to_string())
}

/// Names of the columns of the point that `v1` and `v2` are the velocity of, where it is in that frame.
pub const POINT_COLUMNS: [&str; 2] = ["point_x", "point_y"];

/// What is in them.
pub(super) fn point_cells(velocity: Option<&PointVelocity>) -> [String; 2] {
    let Some(velocity) = velocity.filter(|velocity| velocity.is_finite()) else { return Default::default() };
    [velocity.point.x, velocity.point.y].map(|number| number.to_string())
}

/// Both components with why they are not stated, if they are not.
pub(super) fn of_velocity(reason: Option<NotStated>) -> impl Iterator<Item = (&'static str, NotStated)> {
    VELOCITY_NAMES.into_iter().filter_map(move |name| Some((name, reason?)))
}

fn optional(value: Option<f64>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}

/// Writes results as CSV with one row per object and parameter, then `v1` and `v2`, the velocity of the middle of the object (motion filter). The column
/// `reason` says why there is no value: `ambiguous`, `unobservable` or `unknown`. `unit_of_velocity` is that of b, v1 and v2.
///
/// # Errors
///
/// Those of the sink.
pub fn write_results(
    sink: &mut impl Write,
    results: &[ObjectResult],
    unit_of_velocity: VelocityUnit,
) -> io::Result<()> {
    let mut writer = csv::Writer::from_writer(sink);
    let header = [
        "object",
        "method",
        "motion",
        "frames",
        "frames_rejected",
        "parameter",
        "value",
        "std",
        "unit",
        "observable",
        "reason",
    ];
    writer.write_record(header).map_err(io::Error::from)?;
    for result in results {
        let found = result.parameters().unwrap_or_default();
        let units = result.motion.units().iter().zip(result.motion.parameter_kinds());
        let units = units.map(|(unit, kind)| unit_of_velocity.of_parameter(*kind, unit));
        for (index, (name, unit)) in result.motion.parameter_names().iter().zip(units).enumerate() {
            let known = found.get(index).map(|p| [p.value, p.standard_deviation]).unwrap_or_default();
            write_row(&mut writer, result, [*name, unit], known, result.not_stated(name))?;
        }
        if !result.has_velocity() && result.velocity.is_none() {
            continue;
        }
        for (index, name) in VELOCITY_NAMES.iter().enumerate() {
            let velocity = result.velocity.as_ref();
            let known = velocity.map(|v| [v.velocity[index], v.standard_deviations()[index]].map(Some));
            let known = known.unwrap_or_default();
            write_row(&mut writer, result, [*name, unit_of_velocity.in_data()], known, result.velocity_not_stated())?;
        }
    }
    writer.flush()
}

fn write_row(
    writer: &mut csv::Writer<impl Write>,
    result: &ObjectResult,
    [name, unit]: [&str; 2],
    [value, deviation]: [Option<f64>; 2],
    reason: Option<NotStated>,
) -> io::Result<()> {
    let row = [
        text_cell(&result.object),
        result.method.name().to_owned(),
        result.motion.to_string(),
        result.frames.to_string(),
        result.frames_rejected.to_string(),
        name.to_owned(),
        optional(value),
        optional(deviation),
        unit.to_owned(),
        value.is_some().to_string(),
        reason.map_or("", NotStated::name).to_owned(),
    ];
    writer.write_record(&row).map_err(io::Error::from)
}

#[cfg(test)]
mod tests {
    use super::text_cell;

    #[test]
    fn a_name_cannot_become_a_formula() {
        for (name, cell) in [
            ("=1+1", "'=1+1"),
            ("+a", "'+a"),
            ("-2+3", "'-2+3"),
            ("@SUM(A1)", "'@SUM(A1)"),
            ("\u{ff1d}1\u{ff0b}1", "'\u{ff1d}1\u{ff0b}1"),
            ("\u{feff}=1", "'\u{feff}=1"),
            ("-1", "-1"),
            ("a=b", "a=b"),
        ] {
            assert_eq!(text_cell(name), cell);
        }
    }
}
