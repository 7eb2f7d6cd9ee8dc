use std::io::Write as _;

use freeform_motion::Tracker;
use freeform_motion::tracker::Poses;

use crate::args::TrackArgs;
use crate::awaited::Waiting;
use crate::failure::{Failure, warn_of};
use crate::input::Input;
use crate::interrupt;
use crate::output::{Sink, closing_line, refuse_overwriting, refuse_standard_output, track_line};
use crate::overlay::InputOverlay;
use crate::picture_input::PictureInput;
use crate::progress::Verbosity;
use crate::reader::{Event, follow_stream};
use crate::stream_warnings::StreamWarnings;

/// Identifies as a stream.
pub(crate) fn run(args: &TrackArgs) -> Result<(), Failure> {
    let outputs: Vec<_> = args.drawings.overlay.iter().chain(&args.pictures.candidates).map(AsRef::as_ref).collect();
    refuse_overwriting(&args.options.files_read(&args.pictures, &args.inputs), &outputs)?;
    refuse_standard_output(&outputs)?;
    args.options.check()?;
    let shown = if args.drawings.overlay.is_some() { usize::MAX } else { 0 };
    let tracker = |settings| Tracker::new(settings).map(|tracker| tracker.with_known_outlines(shown));
    let mut following = tracker(args.options.tracker_settings()).map_err(Failure::unusable)?;
    let verbosity = Verbosity::of_flag(args.quiet);
    let of_objects = (&args.options, &args.pictures);
    let mut input = Input::open_to_track(&args.inputs, of_objects, Waiting::None, verbosity)?;
    if let Some(error) = input.pictures().and_then(PictureInput::outline_uncertainty) {
        let settings = args.options.tracker_settings_for(error);
        following = tracker(settings).map_err(Failure::unusable)?;
    }
    let mut overlay = InputOverlay::open(args.drawings.overlay.as_deref(), &args.inputs, &input, &args.options)?;
    interrupt::listen();
    let name = input.name.clone();
    let origin = input.result_origin();
    let mut warnings = StreamWarnings::new(verbosity);
    let stated = (following.settings().method(), following.settings().motion());
    let b = input.meaning_of_b(&args.options);
    let mut poses = Poses::new(following.settings().scale);
    let mut sink = Sink::stdout();
    let mut accepted = 0_u64;
    let mut first_reason = None;
    let failure = follow_stream(&mut following, &mut input, verbosity, |event| {
        let event = match event {
            Ok(event) => event,
            Err(left) => {
                poses.forget(&left.seen.object);
                let result = origin.told(left.result.clone());
                warnings.of_left(&result);
                return write_line(&mut sink, &closing_line(&left.seen, &result, &b).map_err(Failure::unusable)?);
            }
        };
        if let Some(overlay) = &mut overlay {
            overlay.take(event)?;
        }
        let Event::Object(observation, _) = event else { return Ok(()) };
        if let Some(warning) = observation.warning.as_ref().filter(|_| !args.quiet) {
            warn_of(warning.code(), &format!("object {}: {warning}", observation.object));
        }
        accepted += u64::from(observation.is_accepted());
        first_reason = first_reason.take().or_else(|| observation.rejection.clone());
        let pose = poses.take(observation);
        write_line(&mut sink, &track_line(observation, pose.as_deref(), stated, &b).map_err(Failure::unusable)?)
    })?;
    // By now the rows of a table have said how they were found.
    let origin = input.result_origin();
    if accepted > 0 {
        warnings.of_present(following.results().into_iter().map(|result| origin.told(result)).collect());
    }
    if let Some(overlay) = overlay {
        overlay.finish()?;
    }
    if let Some(failure) = failure {
        return Err(failure);
    }
    sink.finish()?;
    match (accepted, first_reason) {
        (0, Some(reason)) => Err(Failure::no_result(format_args!("no frame could be used: {reason}"))),
        (0, None) => Err(Failure::no_result(format_args!("{name}: no outline in the file"))),
        _ => Ok(()),
    }
}

/// Writes a line, which is to be read at once.
fn write_line(sink: &mut Sink, line: &str) -> Result<(), Failure> {
    writeln!(sink, "{line}").and_then(|()| sink.flush()).map_err(|error| sink.failure(&error))
}
