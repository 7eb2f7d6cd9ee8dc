use freeform_motion::outline_io::{
    Clipping, Contrast, DEFAULT_OBJECT, OutlineFrame, OutlineWriter, TraceSettings, WriteError, WriterOptions,
    read_picture, trace_mask,
};

use crate::args::OutlineArgs;
use crate::failure::{Failure, warn};
use crate::output::{Sink, refuse_overwriting};
use crate::progress::Progress;

/// Traces the outlines of pictures and writes them.
pub(crate) fn run(args: &OutlineArgs) -> Result<(), Failure> {
    args.images.iter().try_for_each(|image| refuse_overwriting(image, &[&args.output]))?;
    let mut sink = Sink::open(&args.output)?;
    let outcome = match trace_all(args, &mut sink) {
        Ok(outcome) => outcome,
        Err(WriteError::Io(error)) => return Err(sink.failure(&error)),
        Err(error) => return Err(Failure::unusable(error)),
    };
    // What was traced before a picture that cannot be read is kept.
    if outcome.traced > 0 {
        sink.finish()?;
    }
    match outcome {
        Outcome { unreadable: Some(failure), .. } => Err(failure),
        Outcome { traced: 0, first_reason: Some(reason), .. } => Err(Failure::no_result(reason)),
        _ => Ok(()),
    }
}

/// What became of the pictures.
struct Outcome {
    traced: u64,
    /// Why the first picture that shows no object shows none.
    first_reason: Option<String>,
    /// The picture that ended the work.
    unreadable: Option<Failure>,
}

fn trace_all(args: &OutlineArgs, sink: &mut Sink) -> Result<Outcome, WriteError> {
    let contrast = if args.dark { Contrast::DarkOnLight } else { Contrast::LightOnDark };
    let settings = TraceSettings { contrast, clipping: Clipping::Open, ..TraceSettings::default() };
    let mut outcome = Outcome { traced: 0, first_reason: None, unreadable: None };
    let mut writer = None;
    let progress = Progress::of_frames(Some(args.images.len() as u64));
    let mut sink = Some(sink);
    for (frame, image) in (0_u64..).zip(&args.images) {
        progress.advance();
        let picture = match read_picture(image) {
            Ok(picture) => picture,
            Err(error) => {
                outcome.unreadable = Some(Failure::unusable(error));
                break;
            }
        };
        let outline = match trace_mask(&picture, &settings) {
            Ok(traced) => traced.outline,
            Err(error) => {
                let reason = format!("{}: {error}", image.display());
                if args.images.len() > 1 {
                    warn(&reason);
                }
                outcome.first_reason.get_or_insert(reason);
                continue;
            }
        };
        // The header waits for the first outline, so that nothing is printed where there is none.
        if let Some(sink) = sink.take() {
            let options = WriterOptions { arc_column: true, ..WriterOptions::default() };
            writer = Some(OutlineWriter::new(sink, options)?);
        }
        let (time, object) = (frame as f64 / args.fps, DEFAULT_OBJECT.to_owned());
        if let Some(writer) = &mut writer {
            writer.write(&OutlineFrame { frame, time, object, outline })?;
            outcome.traced += 1;
        }
    }
    match writer {
        Some(mut writer) => writer.flush().map(|()| outcome),
        None => Ok(outcome),
    }
}
