use std::io::Write as _;

use freeform_motion::curve_fit::{FitSettings, Method, Outline};
use freeform_motion::identify::{CurveFilterSettings, FilterSettings};
use freeform_motion::outline_io::OutlineFrame;
use freeform_motion::riccati::AffineMotion;

use super::{FittedOutline, command_line};
use crate::args::{IdentifyArgs, IdentifyFormat, IdentifyMethod, TrackOptions};
use crate::batch::Pace;
use crate::failure::{Failure, plain, warn};
use crate::identifier::{curve_settings, filter_settings, pipeline_settings, process_noise};
use crate::input::{Input, Missing};
use crate::interrupt;
use crate::output::{
    Findings, Report, Sink, TraceWriter, WholeFile, parameter_figure, refuse_overwriting, write_identify_json,
    write_identify_table, write_parameters, write_report, write_trajectory,
};
use crate::overlay::{CurveFitter, ObservedOverlay};
use crate::tracking::{Estimate, Event, ObjectResult, Observation, REASONS_KEPT, Tracking};
use crate::trajectory::Trajectory;

/// What was found of one object over time, kept for figures.
#[derive(Debug)]
pub(crate) struct History {
    pub(crate) object: String,
    /// Time of the first frame in seconds.
    pub(crate) start: Option<f64>,
    /// Time in seconds and what was known then.
    pub(crate) estimates: Vec<(f64, Estimate)>,
    /// Time in seconds and root mean square residual, of frames that were used.
    pub(crate) residuals: Vec<[f64; 2]>,
    /// Time in seconds and squared innovation, of frames that were used.
    pub(crate) innovations: Vec<[f64; 2]>,
    /// Number and time in seconds of every frame that was rejected, as far as its time is known.
    pub(crate) rejected: Vec<(u64, Option<f64>)>,
    /// The latest outline that was not rejected, with its curve; `None` where the method fits none.
    pub(crate) latest: Option<(FittedOutline, Outline)>,
}

impl History {
    /// Adds a frame to the history of its object.
    pub(crate) fn take(
        histories: &mut Vec<Self>,
        observation: &Observation,
        frame: Option<&OutlineFrame>,
        curves: &mut CurveFitter,
    ) {
        let position = histories.iter().position(|history| history.object == observation.object);
        let position = position.unwrap_or_else(|| {
            histories.push(Self {
                object: observation.object.clone(),
                start: None,
                estimates: Vec::new(),
                residuals: Vec::new(),
                innovations: Vec::new(),
                rejected: Vec::new(),
                latest: None,
            });
            histories.len() - 1
        });
        let history = &mut histories[position];
        history.start = history.start.or(observation.time);
        if let (Some(time), Some(estimate)) = (observation.time, observation.estimate) {
            history.estimates.push((time, estimate));
        }
        if !observation.is_accepted() {
            history.rejected.push((observation.frame, observation.time));
            return;
        }
        if let Some(time) = observation.time {
            history.residuals.extend(observation.residual.map(|residual| [time, residual]));
            history.innovations.extend(observation.innovation.map(|innovation| [time, innovation]));
        }
        if let Some((frame, fit)) = frame.and_then(|frame| Some((frame, curves.of(observation, frame)?))) {
            history.latest = Some((FittedOutline::new(frame, fit), frame.outline.clone()));
        }
    }
}

/// Pictures without an outline.
#[derive(Debug, Default)]
pub(crate) struct LeftOut {
    pub(crate) count: u64,
    /// Why, of the first of them.
    pub(crate) reasons: Vec<String>,
}

impl LeftOut {
    fn take(&mut self, missing: &Missing) {
        self.count += 1;
        if self.reasons.len() < REASONS_KEPT {
            self.reasons.push(missing.reason.clone());
        }
    }
}

/// Identifies the motion of every object of a sequence.
pub(crate) fn run(args: &IdentifyArgs) -> Result<(), Failure> {
    let outputs: Vec<_> =
        [&args.trace, &args.trajectory, &args.svg, &args.report].into_iter().flatten().map(AsRef::as_ref).collect();
    args.inputs.iter().try_for_each(|input| refuse_overwriting(input, &outputs))?;
    if args.trajectory.is_some() && args.options.method == IdentifyMethod::Adaptive {
        return Err(Failure::unusable(
            "--trajectory: the adaptive method tells no poses, use --method filter or curve",
        ));
    }
    if args.options.degree.is_some() && args.options.method == IdentifyMethod::Filter && !args.quiet {
        warn("--degree: the motion filter fits no polynomial, the degree changes nothing");
    }
    let mut tracking = Tracking::new(&args.options)?;
    let mut input = Input::open(&args.inputs, &args.pictures)?;
    let name = input.name.clone();
    let truth = args.truth.or_else(|| input.truth.map(|truth| truth.seen_at(args.options.scale)));

    let mut trace = match &args.trace {
        Some(path) => {
            let file = WholeFile::create(path)?;
            Some(TraceWriter::new(file, args.options.motion.model()).map_err(|error| file_failure(path, &error))?)
        }
        None => None,
    };
    let mut trajectory = match &args.trajectory {
        Some(path) => Some((WholeFile::create(path)?, Trajectory::default())),
        None => None,
    };
    let mut overlay =
        ObservedOverlay::open(args.overlay.as_deref(), &args.inputs, &input, &args.options, &args.pictures)?;
    interrupt::listen();
    let mut curves = CurveFitter::new(&args.options)?;
    let keeps_history = args.svg.is_some() || args.report.is_some();
    let mut histories = Vec::new();
    let mut left_out = LeftOut::default();
    let failure = tracking.read(&mut input, Pace::Ahead, args.quiet, |event| {
        if let Some(overlay) = &mut overlay {
            overlay.take(&event)?;
        }
        let (observation, frame) = match event {
            Event::Observed { observation, frame, .. } => (observation, frame),
            Event::Missing(missing) => {
                left_out.take(missing);
                return Ok(());
            }
        };
        if let (Some(trace), Some(path)) = (&mut trace, &args.trace) {
            trace.write(observation).map_err(|error| file_failure(path, &error))?;
        }
        if let Some((_, trajectory)) = &mut trajectory {
            trajectory.take(observation);
        }
        if keeps_history {
            History::take(&mut histories, observation, frame, &mut curves);
        }
        Ok(())
    })?;

    if let Some(overlay) = overlay {
        overlay.finish()?;
    }
    let results = tracking.results();
    let is_found = results.iter().any(|result| result.estimate.is_some());
    let failure = if is_found { failure } else { Some(failure.unwrap_or_else(|| nothing_found(&name, &results))) };
    if let Some(path) = &args.report {
        let mut listed = settings(&args.options, &name);
        if input.has_pictures() {
            listed.extend(args.pictures.listed());
        }
        let reason = failure.as_ref().map(Failure::text);
        let report = Report {
            title: format!("Motion in {name}"),
            command: command_line(),
            settings: listed,
            meaning_of_b: meaning_of_b(args, &input),
            findings: vec![Findings { results: &results, histories: &histories }],
            truth: truth.as_ref(),
            no_motion: reason.filter(|_| !is_found),
            read_error: reason.filter(|_| is_found),
            left_out: &left_out,
        };
        WholeFile::write(path, &write_report(&report))?;
    }
    if !is_found {
        return failure.map_or(Ok(()), Err);
    }
    for result in results.iter().filter(|_| !args.quiet) {
        result.warnings.iter().for_each(|warning| warn(&format!("object {}: {warning}", result.object)));
    }
    let format = if args.json { IdentifyFormat::Json } else { args.format };
    let note = input.has_pictures().then(|| meaning_of_b(args, &input));
    let printed = print(format, &results, truth.as_ref(), note.as_deref());
    if let (Some(trace), Some(path)) = (trace, &args.trace) {
        trace.into_inner().map_err(|error| file_failure(path, &error))?.finish()?;
    }
    if let (Some((mut file, mut trajectory)), Some(path)) = (trajectory, &args.trajectory) {
        if args.smooth && tracking.motion_changed() {
            warn(
                "--smooth: the motion changed on the way, which the smoother takes for constant; the poses are as filtered",
            );
        } else if args.smooth {
            trajectory.smooth(&process_noise(&args.options)).map_err(Failure::unusable)?;
        }
        let written = write_trajectory(&mut file, &trajectory, args.options.motion.model(), args.options.scale);
        written.map_err(|error| file_failure(path, &error))?;
        file.finish()?;
    }
    if let Some(path) = &args.svg {
        WholeFile::write(path, &parameter_figure(&histories, args.options.motion.model(), truth.as_ref()))?;
    }
    printed?;
    failure.map_or(Ok(()), Err)
}

/// Unit and origin of b, for reading.
fn meaning_of_b(args: &IdentifyArgs, input: &Input) -> String {
    let (origin, unit) = if input.has_pictures() {
        args.pictures.origin_and_speed_unit()
    } else {
        ("the origin of the coordinates", "in their lengths/s".to_owned())
    };
    let scale = args.options.scale.map_or_else(String::new, |scale| format!(", over f/Z0 = {scale}"));
    format!("velocity at {origin}, {unit}{scale}")
}

fn print(
    format: IdentifyFormat,
    results: &[ObjectResult],
    truth: Option<&AffineMotion>,
    meaning_of_b: Option<&str>,
) -> Result<(), Failure> {
    let mut sink = Sink::stdout();
    let written = match format {
        IdentifyFormat::Table => {
            let table = write_identify_table(&mut sink, results, truth);
            table.and_then(|()| meaning_of_b.map_or(Ok(()), |text| writeln!(sink, "b: {text}")))
        }
        IdentifyFormat::Json => write_identify_json(&mut sink, results),
        IdentifyFormat::Csv => write_parameters(&mut sink, results),
    };
    written.and_then(|()| sink.flush()).map_err(|error| sink.failure(&error))
}

/// Why no object has a result, on one line.
fn nothing_found(name: &str, results: &[ObjectResult]) -> Failure {
    let Some(first) = results.first() else {
        return Failure::no_result(format_args!("{name}: no outline in the file"));
    };
    let ObjectResult { object, frames, frames_rejected, .. } = first;
    let used = frames - frames_rejected;
    if used < 2 && *frames_rejected == 0 {
        return Failure::no_result(format_args!(
            "{name}: no motion of object {object:?}: {used} frame(s), at least 2 are needed"
        ));
    }
    match first.first_rejection.as_ref().or(first.warnings.first()) {
        Some(reason) => Failure::no_result(format_args!(
            "{name}: no motion of object {object:?}: {frames_rejected} of {frames} frame(s) rejected, {reason}"
        )),
        None => Failure::no_result(format_args!(
            "{name}: no motion of object {object:?}: {used} frame(s), at least 2 are needed"
        )),
    }
}

/// The settings as a report lists them.
pub(crate) fn settings(options: &TrackOptions, input: &str) -> Vec<(&'static str, String)> {
    let scale = options.scale.map_or_else(|| "none: b in the image".to_owned(), |scale| scale.to_string());
    let mut listed = vec![
        ("Input", input.to_owned()),
        ("Motion model", options.motion.model().to_string()),
        ("Method", options.method.name().to_owned()),
    ];
    match options.method {
        IdentifyMethod::Filter => {
            let FilterSettings { smallest_agreement, patience, .. } = filter_settings(options);
            listed.push(("Agreement needed", format!("{} % of the points of a frame", 100.0 * smallest_agreement)));
            listed.push(("Searched for anew", format!("after {patience} rejected frames")));
        }
        IdentifyMethod::Curve => {
            let CurveFilterSettings { degree, offset, patience, .. } = curve_settings(options);
            listed.push(("Degree of the curve", degree.to_string()));
            listed.push(("Level-set offset", format!("{offset} RMS radii")));
            listed.push(("Searched for anew", format!("after {patience} rejected frames")));
        }
        IdentifyMethod::Adaptive => listed.extend(fit_settings(&pipeline_settings(options).fit)),
    }
    listed.push(("Camera scale f/Z0", scale));
    listed
}

/// How curves are fitted, as a report lists it.
pub(crate) fn fit_settings(fit: &FitSettings) -> [(&'static str, String); 3] {
    let method = match fit.method {
        Method::ThreeLevel => "3L".to_owned(),
        Method::GloballyStabilised { ridge_weight } => format!("GS3L, ridge {ridge_weight}"),
        Method::Bounded { margin, ridge_weight } => format!("3L, bounded with margin {margin}, ridge {ridge_weight}"),
    };
    [
        ("Degree of the curve", fit.degree.to_string()),
        ("Curve fit", method),
        ("Level-set offset", format!("{} RMS radii", fit.offset)),
    ]
}

pub(crate) fn file_failure(path: &std::path::Path, error: &std::io::Error) -> Failure {
    Failure::unusable(format_args!("{}: {}", path.display(), plain(error)))
}
