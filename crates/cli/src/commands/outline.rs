use freeform_motion::outline_io::{OutlineWriter, WriteError, WriterOptions};

use crate::args::OutlineArgs;
use crate::failure::{Failure, warn};
use crate::input::{Input, Item};
use crate::interrupt;
use crate::output::{Sink, refuse_overwriting};
use crate::overlay::{Drawn, Overlay, needs_pictures};
use crate::progress::Progress;

/// Traces the outlines of pictures and writes them.
pub(crate) fn run(args: &OutlineArgs) -> Result<(), Failure> {
    args.inputs.iter().try_for_each(|image| refuse_overwriting(image, &[&args.output]))?;
    let input = Input::open(&args.inputs, &args.pictures)?;
    if !input.has_pictures() {
        return Err(Failure::unusable(format_args!("{}: not a picture", input.name)));
    }
    interrupt::listen();
    let name = input.name.clone();
    let mut sink = Sink::open(&args.output)?;
    let outcome = match trace_all(args, input, &mut sink)? {
        Ok(outcome) => outcome,
        Err(WriteError::Io(error)) => return Err(sink.failure(&error)),
        Err(error) => return Err(Failure::unusable(error)),
    };
    match outcome {
        Outcome { outlines: 0, first_reason: Some((reason, true)) } => Err(Failure::unusable(reason)),
        Outcome { outlines: 0, first_reason: Some((reason, false)) } => Err(Failure::no_result(reason)),
        Outcome { outlines: 0, first_reason: None } => Err(Failure::no_result(format_args!("{name}: no pictures"))),
        _ => sink.finish(),
    }
}

/// What became of the pictures.
struct Outcome {
    outlines: u64,
    /// Why the first picture without an outline has none, and whether it is damaged.
    first_reason: Option<(String, bool)>,
}

type Written = Result<Outcome, WriteError>;

fn trace_all(args: &OutlineArgs, input: Input, sink: &mut Sink) -> Result<Written, Failure> {
    let mut overlay = args.overlay.as_deref().map(Overlay::open).transpose()?;
    if overlay.is_some() {
        needs_pictures(&input)?;
    }
    let mut outcome = Outcome { outlines: 0, first_reason: None };
    let progress = Progress::of_frames(input.frame_count(), args.quiet);
    let single = input.frame_count() == Some(1);
    let (mut writer, mut sink) = (None, Some(sink));
    let object_column = args.pictures.objects == crate::args::ObjectsChoice::All;
    for item in input {
        // What came after Ctrl-C may be cut short.
        if interrupt::was_asked_for() {
            break;
        }
        progress.advance();
        match item? {
            Item::Outline(frame, seen_in) => {
                // The header waits for the first outline, so that nothing is printed where there is none.
                if let Some(sink) = sink.take() {
                    let options = WriterOptions { arc_column: true, object_column };
                    match OutlineWriter::new(sink, options) {
                        Ok(new) => writer = Some(new),
                        Err(error) => return Ok(Err(error)),
                    }
                }
                if let Some(Err(error)) = writer.as_mut().map(|writer| writer.write(&frame)) {
                    return Ok(Err(error));
                }
                outcome.outlines += 1;
                if let (Some(overlay), Some(seen_in)) = (&mut overlay, &seen_in) {
                    let drawn = Drawn { outline: &frame.outline, accepted: true, fit: None, generator: None };
                    overlay.draw(seen_in, &drawn)?;
                }
            }
            Item::Rejected { reason, .. } => outcome.leave_out(args, &progress, single, reason, false),
            Item::Missing { reason, is_damage } => outcome.leave_out(args, &progress, single, reason, is_damage),
        }
    }
    if let Some(overlay) = overlay {
        overlay.finish()?;
    }
    Ok(match writer {
        Some(mut writer) => writer.flush().map(|()| outcome),
        None => Ok(outcome),
    })
}

impl Outcome {
    /// Takes note of a picture without an outline. That of a single one is told in the end.
    fn leave_out(&mut self, args: &OutlineArgs, progress: &Progress, single: bool, reason: String, is_damage: bool) {
        if !args.quiet && !single {
            progress.pause(|| warn(&reason));
        }
        self.first_reason.get_or_insert((reason, is_damage));
    }
}
