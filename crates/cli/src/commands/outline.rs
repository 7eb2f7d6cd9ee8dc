use freeform_motion::outline_io::{TableFormat, TableWriter, WriteError, WriterOptions};

use crate::args::OutlineArgs;
use crate::failure::{Failure, warn};
use crate::input::{Input, Waiting};
use crate::interrupt;
use crate::left_out::MissingWarnings;
use crate::output::{Sink, refuse_overwriting};
use crate::overlay::{Drawn, Overlay};
use crate::progress::Progress;
use crate::seen::{Item, Missing};

/// Traces the outlines of pictures, or takes those of a file, and writes them.
pub(crate) fn run(args: &OutlineArgs) -> Result<(), Failure> {
    let outputs: Vec<_> = std::iter::once(&args.output)
        .chain(&args.overlay)
        .chain(&args.pictures.candidates)
        .map(AsRef::as_ref)
        .collect();
    refuse_overwriting(&args.pictures.files_read(&args.inputs), &outputs)?;
    // A pipe that nobody reads is waited for here, which the first signal ends.
    let mut sink = Sink::open(&args.output)?;
    let input = Input::open(&args.inputs, &args.pictures, Waiting::UntilInterrupted)?;
    if !input.has_pictures() && args.overlay.is_some() {
        return Err(Failure::unusable(format_args!("{}: not a picture, there is nothing to draw on", input.name)));
    }
    let name = input.name.clone();
    interrupt::listen();
    if !args.quiet {
        input.tell();
    }
    let outcome = match trace_all(args, input, &mut sink)? {
        Ok(outcome) => outcome,
        Err(WriteError::Io(error)) => return Err(sink.failure(&error)),
        Err(error) => return Err(Failure::unusable(error)),
    };
    match outcome {
        Outcome { outlines: 0, first_missing: Some(missing) } => Err(missing.into_failure()),
        Outcome { outlines: 0, first_missing: None } => Err(Failure::no_result(format_args!("{name}: no outline"))),
        _ => sink.finish(),
    }
}

/// What became of the pictures.
struct Outcome {
    outlines: u64,
    first_missing: Option<Missing>,
}

type Written = Result<Outcome, WriteError>;

fn trace_all(args: &OutlineArgs, mut input: Input, sink: &mut Sink) -> Result<Written, Failure> {
    let mut overlay = args.overlay.as_deref().map(|path| Overlay::open(path, &args.inputs)).transpose()?;
    let mut outcome = Outcome { outlines: 0, first_missing: None };
    let progress = Progress::of_frames(input.frame_count(), args.quiet || sink.is_disturbed_by_progress());
    let single = input.frame_count() == Some(1);
    let (mut writer, mut sink) = (None, Some(sink));
    // What a file holds is not known before all of it has been read.
    let object_column = input.pictures().is_none_or(|pictures| pictures.options().follows_all());
    let contour_column = input.pictures().is_none_or(|pictures| pictures.options().traces_contours());
    // A copy of a table says no less than the table.
    let deviation_column = args.deviations || input.has_deviation_column();
    let comments = std::mem::take(&mut input.comments);
    let mut warnings = MissingWarnings::default();
    for item in input.by_ref() {
        // What came after Ctrl-C may be cut short.
        if interrupt::was_asked_for() {
            break;
        }
        progress.advance();
        match item? {
            Item::Outline(frame, seen_in) => {
                // The header waits for the first outline, so that nothing is printed where there is none.
                if let Some(sink) = sink.take() {
                    let options = WriterOptions {
                        arc_column: true,
                        object_column,
                        contour_column,
                        deviation_column,
                        resolution: None,
                    };
                    match TableWriter::new(sink, TableFormat::of(&args.output), options, &comments) {
                        Ok(new) => writer = Some(new),
                        Err(error) => return Ok(Err(error)),
                    }
                }
                if let Some(Err(error)) = writer.as_mut().map(|writer| writer.write(&frame)) {
                    return Ok(Err(error));
                }
                outcome.outlines += 1;
                if let (Some(overlay), Some(seen_in)) = (&mut overlay, &seen_in) {
                    let name = object_column.then_some(frame.object.as_str());
                    let drawn = Drawn { outline: &frame.outline, name, accepted: true, fit: None, generator: None };
                    overlay.draw(seen_in, &drawn)?;
                }
            }
            Item::NoOutline { reason, .. } if !args.quiet => progress.pause(|| warn(&reason)),
            Item::NoOutline { .. } => {}
            Item::Gap(missing) => {
                // The reason of a single picture is told in the end.
                if let Some(warning) = warnings.take(&missing).filter(|_| !args.quiet && !single) {
                    progress.pause(|| warn(&warning));
                }
                if let (Some(overlay), Some(seen_in)) = (&mut overlay, &missing.seen_in) {
                    overlay.draw_nothing(seen_in)?;
                }
                outcome.first_missing.get_or_insert(missing);
            }
        }
    }
    if !args.quiet {
        progress.pause(|| input.tell_in_the_end());
    }
    warnings.finish().filter(|_| !args.quiet).for_each(|warning| progress.pause(|| warn(&warning)));
    if let Some(overlay) = overlay {
        overlay.finish()?;
    }
    Ok(match writer {
        Some(writer) => writer.finish().map(|_| outcome),
        None => Ok(outcome),
    })
}
