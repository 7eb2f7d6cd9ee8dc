use std::io::Write as _;

use crate::args::TrackArgs;
use crate::batch::Pace;
use crate::failure::Failure;
use crate::input::Input;
use crate::interrupt;
use crate::output::{Sink, track_line};
use crate::overlay::{ObservedOverlay, needs_pictures};
use crate::tracking::Tracking;

/// Identifies as a stream.
pub(crate) fn run(args: &TrackArgs) -> Result<(), Failure> {
    let mut tracking = Tracking::new(&args.options)?;
    let mut input = Input::open(&args.inputs, &args.pictures)?;
    let mut overlay = match &args.overlay {
        Some(path) => {
            needs_pictures(&input)?;
            Some(ObservedOverlay::open(path, &args.options)?)
        }
        None => None,
    };
    interrupt::listen();
    let name = input.name.clone();
    let mut sink = Sink::stdout();
    let mut accepted = 0_u64;
    let mut first_reason = None;
    let failure = tracking.read(&mut input, Pace::FrameByFrame, args.quiet, |observation, frame, seen_in| {
        accepted += u64::from(observation.is_accepted());
        first_reason = first_reason.take().or_else(|| observation.rejected_because.clone());
        if let Some(overlay) = &mut overlay {
            overlay.take(&observation, frame, seen_in)?;
        }
        let line = track_line(&observation).map_err(Failure::unusable)?;
        writeln!(sink, "{line}").and_then(|()| sink.flush()).map_err(|error| sink.failure(&error))
    })?;
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
