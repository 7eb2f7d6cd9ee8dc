use std::io::Write as _;

use freeform_drawing::{Findings, MeaningOfB, OBJECTS_PLAYED, Report, write_report};
use freeform_motion::outline_io::OutlineUncertainty;
use freeform_motion::tracker::{NotStated, ObjectResult, write_results};
use freeform_motion::{Tracker, Truth, Warning};

use super::identify_files::Files;
use super::listed_settings::{settings, version};
use crate::args::{DynamicsChoice, IdentifyArgs, IdentifyFormat, IdentifyMethod, MotionChoice};
use crate::awaited::Waiting;
use crate::command_line::command_line;
use crate::failure::{Failure, warn, warn_of};
use crate::handful::{Line, Rest, handful};
use crate::hints::Hints;
use crate::input::Input;
use crate::interrupt;
use crate::left_out::LeftOut;
use crate::output::{
    Sink, WholeFile, refuse_other_format, refuse_overwriting, refuse_standard_output, write_identify_json,
    write_identify_table,
};
use crate::overlay::InputOverlay;
use crate::picture_input::PictureInput;
use crate::progress::Verbosity;
use crate::reader::{Event, follow};

/// Objects whose states are kept in memory: 60 kB each where outlines are small, up to half a megabyte.
const STATES_IN_MEMORY: usize = 1024;

/// Where more is found than the motion at the end.
const POSES_OVER_TIME: &str = "poses over time: --trajectory FILE";

/// Identifies the motion of every object of a sequence.
pub(crate) fn run(args: &IdentifyArgs) -> Result<(), Failure> {
    check(args)?;
    // Options are refused before an input is waited for.
    let mut tracker = tracker(args, None)?;
    let verbosity = Verbosity::of_flag(args.quiet);
    let of_objects = (&args.options, &args.pictures);
    let mut input = Input::open_to_track(&args.inputs, of_objects, Waiting::UntilInterrupted, verbosity)?;
    if let Some(uncertainty) = input.pictures().and_then(PictureInput::outline_uncertainty) {
        tracker = self::tracker(args, Some(uncertainty))?;
    }
    let truth = true_motion(args, &input);
    let mut files = Files::create(args, truth.as_ref())?;
    let mut overlay = InputOverlay::open(args.drawings.overlay.as_deref(), &args.inputs, &input, &args.options)?;
    interrupt::listen();
    if let Ok(file) = tempfile::tempfile() {
        tracker.keep_states_in(file, STATES_IN_MEMORY);
    }

    let (mut left_out, mut hints) = (LeftOut::default(), Hints::default());
    let failure = follow(&mut tracker, &mut input, verbosity, |event| {
        if let Some(overlay) = &mut overlay {
            overlay.take(event)?;
        }
        match event {
            Event::Object(observation, seen) => {
                let frame = seen.as_ref().map(|(frame, _)| frame);
                hints.take(observation, frame);
                files.take(observation, frame)
            }
            Event::Gap(missing) => {
                left_out.take(missing);
                missing.seen_in.iter().for_each(|seen| files.histories.pass(seen.time));
                Ok(())
            }
        }
    })?;
    overlay.map_or(Ok(()), InputOverlay::finish)?;
    files.histories.close();

    let outcome = Outcome::new(args, &input, &tracker, truth, left_out, failure);
    if !args.quiet && !input.has_pictures() {
        hints.told(outcome.failure.is_none() && outcome.lacks_values()).iter().for_each(|hint| warn(hint));
    }
    outcome.warn_of_objects_not_drawn(&files);
    let report = files.report.take().filter(|_| outcome.is_anything_read());
    let reported = report.map_or(Ok(()), |file| outcome.report(file, &files));
    let printed = outcome.print(files.has_poses);
    files.finish(&tracker, outcome.truth.as_ref(), &outcome.results, &outcome.b)?;
    printed?;
    reported?;
    outcome.failure.map_or(Ok(()), Err)
}

/// A tracker with all options, for outlines that may lie off as pictures say.
fn tracker(args: &IdentifyArgs, by_pictures: Option<OutlineUncertainty>) -> Result<Tracker, Failure> {
    let mut tracker = Tracker::new(args.tracker_settings(by_pictures)?).map_err(Failure::unusable)?;
    if args.smooth {
        tracker.record_expected_states();
    }
    // A report plays few objects, drawings show all of them.
    let objects = match (&args.drawings.overlay, &args.report) {
        (Some(_), _) => usize::MAX,
        (None, Some(_)) => OBJECTS_PLAYED,
        (None, None) => 0,
    };
    Ok(tracker.with_known_outlines(objects))
}

/// The truth that results are shown beside: that of the options, or of the file where it is that of what is identified.
fn true_motion(args: &IdentifyArgs, input: &Input) -> Option<Truth> {
    let of_file = input.truth().filter(|_| args.truth.is_none());
    let is_elsewhere = args.options.rectify.is_some();
    if !args.quiet && of_file.is_some() && is_elsewhere {
        warn("the truth in the file is that in the picture, not in the plane of --rectify, so it is not shown");
    }
    let of_file = of_file.filter(|_| !is_elsewhere).map(|truth| truth.seen_at(args.options.scale));
    let truth = args.truth.map(Truth::from).or(of_file);
    let family = args.options.motion.family();
    if !args.quiet && truth.is_some_and(|truth| truth.parameters_in(family).is_none()) {
        let origin = if args.truth.is_some() { "--truth" } else { "the truth in the file" };
        warn(&format!("{origin} is no {family} motion, so it is not shown"));
    }
    truth
}

/// Refuses options that cannot be combined.
fn check(args: &IdentifyArgs) -> Result<(), Failure> {
    let candidates = &args.pictures.candidates;
    let outputs = [&args.trace, &args.trajectory, &args.svg, &args.report, &args.drawings.overlay, candidates];
    let outputs: Vec<_> = outputs.into_iter().flatten().map(AsRef::as_ref).collect();
    refuse_overwriting(&args.options.files_read(&args.pictures, &args.inputs), &outputs)?;
    refuse_standard_output(&outputs)?;
    refuse_other_format(args.svg.as_deref())?;
    args.options.check()?;
    if args.trajectory.is_some() && args.options.method == IdentifyMethod::Adaptive {
        return Err(Failure::unusable("--trajectory: the adaptive method gives no poses; use --method filter"));
    }
    if args.options.degree.is_some() && args.options.method == IdentifyMethod::Filter && !args.quiet {
        warn("--degree: the motion filter fits no polynomial; the degree is used only for the curve in drawings");
    }
    if args.options.dynamics != DynamicsChoice::Auto && args.options.motion == MotionChoice::Plane && !args.quiet {
        warn("--dynamics: not used for a plane in space, whose velocities are taken for constant");
    }
    Ok(())
}

/// What has come of an input.
struct Outcome<'a> {
    args: &'a IdentifyArgs,
    input: &'a Input,
    results: Vec<ObjectResult>,
    /// Whether any object has a motion.
    is_found: bool,
    truth: Option<Truth>,
    b: MeaningOfB,
    left_out: LeftOut,
    /// What ended the reading before its time, or why there is no motion.
    failure: Option<Failure>,
}

impl<'a> Outcome<'a> {
    fn new(
        args: &'a IdentifyArgs,
        input: &'a Input,
        tracker: &Tracker,
        truth: Option<Truth>,
        left_out: LeftOut,
        failure: Option<Failure>,
    ) -> Self {
        let origin = input.result_origin();
        let results: Vec<ObjectResult> = tracker.results().into_iter().map(|result| origin.told(result)).collect();
        let is_found = results.iter().any(|result| result.parameters().is_some());
        let failure = failure.or_else(|| (!is_found).then(|| nothing_found(&input.name, &results)));
        let b = input.meaning_of_b(&args.options);
        Self { args, input, results, is_found, truth, b, left_out, failure }
    }

    fn is_anything_read(&self) -> bool {
        !self.results.is_empty() || self.left_out.readable > 0
    }

    fn warn_of_objects_not_drawn(&self, files: &Files<'_>) {
        let left_out = files.histories.left_out(self.results.len());
        left_out.iter().filter(|_| !self.args.quiet).for_each(|left_out| warn(left_out));
    }

    /// Writes the report.
    fn report(&self, file: WholeFile, files: &Files<'_>) -> Result<(), Failure> {
        let Self { args, input, results, is_found, .. } = self;
        let mut listed = settings(&args.options, &input.name);
        listed.extend(input.pictures().map(PictureInput::listed).unwrap_or_default());
        listed.extend(input.closing_warnings().into_iter().map(|(_, warning)| ("Warning", warning)));
        listed.push(version());
        let reason = self.failure.as_ref().map(Failure::text);
        let all_poses = format!("--trajectory writes those of all {}.", results.len());
        let report = Report {
            title: format!("Motion in {}", input.name),
            command: command_line(),
            settings: listed,
            meaning_of_b: self.b.clone(),
            findings: vec![Findings { results, histories: &files.histories }],
            truth: self.truth.as_ref(),
            no_motion: reason.filter(|_| !is_found),
            read_error: reason.filter(|_| *is_found),
            left_out: Some(&self.left_out.listed),
            all_poses: Some(&all_poses),
        };
        file.finish_by(|file| write_report(file, &report))
    }

    /// Prints the results and what they warn of, or only what the failure does not say.
    fn print(&self, has_poses: bool) -> Result<(), Failure> {
        if !self.is_found {
            self.warn_of_order();
            return Ok(());
        }
        if !self.args.quiet {
            handful(&self.results, Rest::ListedByJson).iter().for_each(Line::print);
        }
        let Self { args, results, b, .. } = self;
        let mut sink = Sink::stdout();
        let written = match if args.json { IdentifyFormat::Json } else { args.format } {
            IdentifyFormat::Table => {
                let table = write_identify_table(&mut sink, results, self.truth.as_ref(), b);
                let table = table.and_then(|()| if self.says_b() { writeln!(sink, "b: {b}") } else { Ok(()) });
                // The motion at the end is not all that is known.
                let is_pointed_to = has_poses && args.trajectory.is_none() && self.lacks_motion();
                table.and_then(|()| if is_pointed_to { writeln!(sink, "{POSES_OVER_TIME}") } else { Ok(()) })
            }
            IdentifyFormat::Json => {
                write_identify_json(&mut sink, results, b, &self.left_out, &self.input.closing_warnings())
            }
            IdentifyFormat::Csv => write_results(&mut sink, results, b.short_unit),
        };
        written.and_then(|()| sink.flush()).map_err(|error| sink.failure(&error))
    }

    /// Whether a parameter, or the velocity of the middle, of any object is not stated for another reason than that the outlines do not show it, as
    /// a circle does not show its turn.
    fn lacks_values(&self) -> bool {
        self.results.iter().any(|result| {
            let mut reasons =
                result.unstated().into_iter().map(|(_, reason)| reason).chain(result.velocity_not_stated());
            reasons.any(|reason| reason != NotStated::Unobservable)
        })
    }

    /// Whether a parameter of any object is not known at the end that may have been known before.
    fn lacks_motion(&self) -> bool {
        self.results.iter().any(|result| {
            let names = result.motion.parameter_names();
            names.iter().any(|name| result.not_stated(name) == Some(NotStated::Unknown))
        })
    }

    /// Whether the table needs to say what b is: that of a file is in its own coordinates.
    fn says_b(&self) -> bool {
        let is_in_picture = self.args.options.motion.family().model().is_some();
        (self.input.has_pictures() || self.args.options.rectify.is_some()) && is_in_picture
    }

    /// Says which points are out of order, where nothing was found: the failure has the other reasons.
    fn warn_of_order(&self) {
        for result in self.results.iter().filter(|_| !self.args.quiet) {
            let order = result.warnings.iter().filter(|warning| matches!(warning, Warning::PointsOutOfOrder { .. }));
            order.for_each(|warning| warn_of(warning.code(), &format!("object {}: {warning}", result.object)));
        }
    }
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
            "{name}: no motion of object {object:?}: {used} frame(s), at least 2 are needed, and 3 where the first shows a part of the outline"
        )),
    }
}
