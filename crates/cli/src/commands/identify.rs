use std::io::Write as _;
use std::path::Path;

use freeform_motion::curve_fit::{FitSettings, Method};
use freeform_motion::estimate::MotionEstimate;
use freeform_motion::outline_filter::FilterSettings;
use freeform_motion::outline_io::OutlineFrame;
use freeform_motion::riccati::MotionModel;
use freeform_motion::tracker::{MethodSettings, ObjectResult, Observation, SmoothingError, Trajectory};
use freeform_motion::{Tracker, Warning};

use crate::args::{DynamicsChoice, IdentifyArgs, IdentifyFormat, IdentifyMethod, MotionChoice, TrackOptions};
use crate::command_line::command_line;
use crate::failure::{Failure, plain, warn};
use crate::handful::handful;
use crate::history::{Histories, OBJECTS_PLAYED, Purpose};
use crate::input::{Input, Waiting};
use crate::interrupt;
use crate::left_out::LeftOut;
use crate::meaning_of_b::MeaningOfB;
use crate::output::{
    Findings, Report, Sink, Study, TraceWriter, WholeFile, parameter_figure, refuse_overwriting,
    refuse_standard_output, write_identify_json, write_identify_table, write_parameters, write_report,
    write_trajectory,
};
use crate::overlay::{CurveFitter, ObservedOverlay};
use crate::picture_input::PictureInput;
use crate::reader::{Event, follow};
use crate::truth::Truth;

/// Objects whose states are kept in memory: 25 kB each where outlines are small, up to half a megabyte.
const STATES_IN_MEMORY: usize = 1024;

/// Identifies the motion of every object of a sequence.
pub(crate) fn run(args: &IdentifyArgs) -> Result<(), Failure> {
    check(args)?;
    let mut tracker = Tracker::new(args.tracker_settings(None)?).map_err(Failure::unusable)?;
    let mut input = Input::open(&args.inputs, &args.pictures, Waiting::UntilInterrupted)?;
    if let Some(error) = input.pictures().and_then(PictureInput::outline_error) {
        tracker = Tracker::new(args.tracker_settings(Some(error))?).map_err(Failure::unusable)?;
    }
    if args.report.is_some() {
        tracker = tracker.with_known_outlines(OBJECTS_PLAYED);
    }
    let name = input.name.clone();
    let of_file = input.truth().filter(|_| args.truth.is_none());
    if !args.quiet && of_file.is_some() && args.options.rectify.is_some() {
        warn("the truth in the file is that in the picture, not in the plane of --rectify, so it is not shown");
    }
    let of_file = of_file.filter(|_| args.options.rectify.is_none());
    let truth = args.truth.map(Truth::from).or_else(|| of_file.map(|truth| truth.seen_at(args.options.scale)));
    let family = args.options.motion.family();
    if !args.quiet && truth.is_some_and(|truth| truth.parameters_in(family).is_none()) {
        let origin = if args.truth.is_some() { "--truth" } else { "the truth in the file" };
        warn(&format!("{origin} is no {family} motion, so it is not shown"));
    }
    let mut files = Files::create(args, truth.as_ref())?;
    let report_file = args.report.as_deref().map(WholeFile::create).transpose()?;
    let mut overlay = ObservedOverlay::open(args.overlay.as_deref(), &args.inputs, &input, &args.options)?;
    interrupt::listen();
    if let Ok(file) = tempfile::tempfile() {
        tracker.keep_states_in(file, STATES_IN_MEMORY);
    }
    let mut left_out = LeftOut::default();
    let failure = follow(&mut tracker, &mut input, args.quiet, |event| {
        if let Some(overlay) = &mut overlay {
            overlay.take(event)?;
        }
        match event {
            Event::Object(observation, seen) => files.take(observation, seen.as_ref().map(|(frame, _)| frame)),
            Event::Gap(missing) => {
                left_out.take(missing);
                Ok(())
            }
        }
    })?;

    if let Some(overlay) = overlay {
        overlay.finish()?;
    }
    files.histories.close();
    let results = tracker.results();
    if let Some(left_out) = files.histories.left_out(results.len()).filter(|_| !args.quiet) {
        warn(&left_out);
    }
    let is_found = results.iter().any(|result| result.parameters().is_some());
    let failure = if is_found { failure } else { Some(failure.unwrap_or_else(|| nothing_found(&name, &results))) };
    let b = match input.pictures() {
        _ if args.options.rectify.is_some() => MeaningOfB::in_plane(),
        Some(pictures) => pictures.meaning_of_b(args.options.scale),
        None => MeaningOfB::in_coordinates(args.options.scale),
    };
    let is_anything_read = !results.is_empty() || left_out.readable > 0;
    let mut reported = Ok(());
    if let Some(file) = report_file.filter(|_| is_anything_read) {
        let mut listed = settings(&args.options, &name);
        listed.extend(input.pictures().map(PictureInput::listed).unwrap_or_default());
        let reason = failure.as_ref().map(Failure::text);
        let report = Report {
            title: format!("Motion in {name}"),
            command: command_line(),
            settings: listed,
            meaning_of_b: b.clone(),
            findings: vec![Findings { results: &results, histories: &files.histories }],
            truth: truth.as_ref(),
            no_motion: reason.filter(|_| !is_found),
            read_error: reason.filter(|_| is_found),
            left_out: &left_out,
        };
        reported = file.finish_by(|file| write_report(file, &report));
    }
    let printed = if is_found {
        if !args.quiet {
            handful(&results).iter().for_each(|warning| warn(warning));
        }
        print(
            args,
            &results,
            truth.as_ref(),
            &b,
            &left_out,
            (input.has_pictures() || args.options.rectify.is_some()) && family.model().is_some(),
        )
    } else {
        // The failure has the other reasons.
        for result in results.iter().filter(|_| !args.quiet) {
            let order = result.warnings.iter().filter(|warning| matches!(warning, Warning::PointsOutOfOrder { .. }));
            order.for_each(|warning| warn(&format!("object {}: {warning}", result.object)));
        }
        Ok(())
    };
    files.finish(&tracker, truth.as_ref(), &results)?;
    printed?;
    reported?;
    failure.map_or(Ok(()), Err)
}

/// Refuses options that cannot be combined.
fn check(args: &IdentifyArgs) -> Result<(), Failure> {
    let candidates = &args.pictures.candidates;
    let outputs = [&args.trace, &args.trajectory, &args.svg, &args.report, &args.overlay, candidates];
    let outputs: Vec<_> = outputs.into_iter().flatten().map(AsRef::as_ref).collect();
    refuse_overwriting(&args.options.files_read(&args.pictures, &args.inputs), &outputs)?;
    refuse_standard_output(&outputs)?;
    args.options.check()?;
    if args.trajectory.is_some() && args.options.method == IdentifyMethod::Adaptive {
        return Err(Failure::unusable("--trajectory: the adaptive method gives no poses; use --method filter"));
    }
    if args.options.degree.is_some() && args.options.method == IdentifyMethod::Filter && !args.quiet {
        warn("--degree: the motion filter fits no polynomial; the degree is used only for the curve in drawings");
    }
    if args.options.dynamics != DynamicsChoice::Auto
        && args.options.motion.model() == MotionModel::Projective
        && !args.quiet
    {
        warn(match args.options.motion {
            MotionChoice::Plane => "--dynamics: not used for a plane in space, whose velocities are taken for constant",
            _ => {
                "--dynamics: not used for projective motion, whose generator is taken for constant until it is seen to change"
            }
        });
    }
    Ok(())
}

/// What is written frame by frame, or kept for figures. Files are begun before the work, which is not to be lost where there
/// is no place for them.
struct Files<'a> {
    args: &'a IdentifyArgs,
    trace: Option<(&'a Path, TraceWriter<WholeFile>)>,
    trajectory: Option<(&'a Path, WholeFile, Trajectory)>,
    svg: Option<WholeFile>,
    curves: CurveFitter,
    histories: Histories,
}

impl<'a> Files<'a> {
    fn create(args: &'a IdentifyArgs, truth: Option<&Truth>) -> Result<Self, Failure> {
        let study = (args.options.method == IdentifyMethod::Adaptive).then(|| study(args, truth));
        let trace = args.trace.as_deref().map(|path| {
            let writer = TraceWriter::new(WholeFile::create(path)?, args.options.motion.family(), study);
            writer.map(|writer| (path, writer)).map_err(|error| file_failure(path, &error))
        });
        let trajectory = args.trajectory.as_deref();
        let trajectory = trajectory.map(|path| Ok((path, WholeFile::create(path)?, Trajectory::default())));
        let svg = args.svg.as_deref().map(WholeFile::create).transpose()?;
        let (trace, trajectory) = (trace.transpose()?, trajectory.transpose()?);
        Ok(Self {
            args,
            trace,
            trajectory,
            svg,
            curves: CurveFitter::new(&args.options)?,
            histories: Histories::new(match args.report {
                Some(_) => Purpose::Report(args.options.rectification()),
                None => Purpose::Figures,
            }),
        })
    }

    /// Takes what a frame of an object gave.
    fn take(&mut self, observation: &Observation, frame: Option<&OutlineFrame>) -> Result<(), Failure> {
        if let Some((path, trace)) = &mut self.trace {
            trace.write(observation).map_err(|error| file_failure(path, &error))?;
        }
        if let Some((_, _, trajectory)) = &mut self.trajectory {
            trajectory.take(observation);
        }
        if self.args.svg.is_some() || self.args.report.is_some() {
            self.histories.take(observation, frame, &mut self.curves);
        }
        Ok(())
    }

    /// Moves the files to their destinations. A file without content is not written.
    fn finish(self, tracker: &Tracker, truth: Option<&Truth>, results: &[ObjectResult]) -> Result<(), Failure> {
        let Self { args, trace, trajectory, svg, histories, .. } = self;
        let model = args.options.motion.model();
        let not_written = |options: &[(&str, bool)], reason: &str| {
            let names: Vec<&str> = options.iter().filter(|(_, is_given)| *is_given).map(|(name, _)| *name).collect();
            if !names.is_empty() && !args.quiet {
                warn(&format!("{}: not written, {reason}", names.join(", ")));
            }
        };
        if results.iter().all(|result| result.frames == result.frames_rejected) {
            let options =
                [("--trace", trace.is_some()), ("--trajectory", trajectory.is_some()), ("--svg", svg.is_some())];
            not_written(&options, "no outline could be used");
            return Ok(());
        }
        if let Some((path, trace)) = trace {
            trace.into_inner().map_err(|error| file_failure(path, &error))?.finish()?;
        }
        if let Some((path, mut file, mut trajectory)) = trajectory {
            if args.smooth {
                match trajectory.smooth(tracker) {
                    Err(changed @ SmoothingError::MotionChanged) => {
                        warn(&format!("--smooth: {changed}; the poses are not smoothed"));
                    }
                    smoothed => smoothed.map_err(Failure::unusable)?,
                }
            }
            let written = write_trajectory(&mut file, &trajectory, model, args.options.scale);
            written.map_err(|error| file_failure(path, &error))?;
            file.finish()?;
        }
        if results.iter().all(|result| result.parameters().is_none()) {
            not_written(&[("--svg", svg.is_some())], "there is no motion to draw");
        } else if let Some(file) = svg {
            file.finish_with(parameter_figure(&histories.list, args.options.motion.family(), truth).as_bytes())?;
        }
        Ok(())
    }
}

/// What the Lyapunov function of the adaptive law needs to know of the truth.
fn study(args: &IdentifyArgs, truth: Option<&Truth>) -> Study {
    let model = args.options.motion.model();
    let constant = truth.filter(|truth| truth.constant_parameters_in(model.into()).is_some());
    let truth = constant.map(|truth| {
        let in_image = args.options.scale.unwrap_or_default().generator_in_image(&truth.motion.generator());
        MotionEstimate::new(model, &model.parameters_of(&in_image)[..model.parameter_count()], None)
    });
    Study { truth }
}

fn print(
    args: &IdentifyArgs,
    results: &[ObjectResult],
    truth: Option<&Truth>,
    b: &MeaningOfB,
    left_out: &LeftOut,
    says_b: bool,
) -> Result<(), Failure> {
    let mut sink = Sink::stdout();
    let format = if args.json { IdentifyFormat::Json } else { args.format };
    let written = match format {
        IdentifyFormat::Table => {
            let table = write_identify_table(&mut sink, results, truth, b);
            table.and_then(|()| if says_b { writeln!(sink, "b: {b}") } else { Ok(()) })
        }
        IdentifyFormat::Json => write_identify_json(&mut sink, results, b, left_out),
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
    let rejection = first.first_rejection.as_ref().map(ToString::to_string);
    match rejection.or_else(|| first.warnings.first().map(ToString::to_string)) {
        Some(reason) => Failure::no_result(format_args!(
            "{name}: no motion of object {object:?}: {frames_rejected} of {frames} frame(s) rejected, {reason}"
        )),
        None => Failure::no_result(format_args!(
            "{name}: no motion of object {object:?}: {used} frame(s), at least 2 are needed"
        )),
    }
}

/// Names and values of the settings, for a report.
pub(crate) fn settings(options: &TrackOptions, input: &str) -> Vec<(&'static str, String)> {
    let scale = options.scale.map_or_else(|| "none: b in the image".to_owned(), |scale| scale.to_string());
    let mut listed = vec![("Input", input.to_owned()), ("Motion model", options.motion.family().to_string())];
    let settings = options.tracker_settings();
    listed.push(("Method", settings.method().to_string()));
    match settings.method {
        MethodSettings::Filter(FilterSettings { smallest_agreement, patience, .. })
        | MethodSettings::Plane(_, FilterSettings { smallest_agreement, patience, .. }) => {
            listed.push(("Agreement needed", format!("{} % of the points of a frame", 100.0 * smallest_agreement)));
            listed.push(("Searched for anew", format!("after {patience} rejected frames")));
            listed.push(("Degree of the curve drawn", options.degree_drawn().to_string()));
        }
        MethodSettings::Adaptive(settings) => listed.extend(fit_settings(&settings.fit)),
    }
    match options.perspective.camera() {
        Some(camera) => {
            let principal = camera.principal();
            listed.push(("Focal length", format!("{} pixels", camera.focal())));
            listed.push(("Principal point", format!("{},{}", principal.x, principal.y)));
        }
        None => listed.push(("Camera scale f/Z0", scale)),
    }
    if options.rectify.is_some() {
        listed.push(("Coordinates", "of the plane that --rectify leads to".to_owned()));
    }
    listed
}

/// Names and values of the settings of the curve fit, for a report.
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
