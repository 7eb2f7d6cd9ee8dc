use freeform_motion::outline_io::{OutlineFrame, read_shape};
use freeform_motion::recognise::{EvidenceByObject, ObjectEvidence, RecogniseSettings, Recogniser};
use rayon::prelude::*;

use super::side_by_side::SideBySide;
use crate::args::{RecogniseArgs, RecogniseFormat};
use crate::awaited::Waiting;
use crate::failure::{Failure, warn};
use crate::input::Input;
use crate::left_out::MissingWarnings;
use crate::output::{
    RecognisedObject, Sink, refuse_overwriting, refuse_standard_output, write_recognised_json, write_recognised_table,
};
use crate::progress::{Progress, Verbosity};
use crate::seen::Item;

/// Names every object of the input.
pub(crate) fn run(args: &RecogniseArgs) -> Result<(), Failure> {
    let candidates: Vec<_> = args.pictures.candidates.iter().map(AsRef::as_ref).collect();
    let read = [args.pictures.files_read(&args.inputs), args.known.clone()].concat();
    refuse_overwriting(&read, &candidates)?;
    refuse_standard_output(&candidates)?;
    let recogniser = learnt(args)?;
    let input = Input::open(&args.inputs, &args.pictures, Waiting::Allowed, Verbosity::Usual)?;
    let name = input.name.clone();
    input.tell_tracing();
    let mut sink = Sink::stdout();
    let Compared { objects, mut reasons, warnings, failure } = compare_all(input, &recogniser, &sink);
    reasons.extend(objects.iter().filter_map(|object| refusal(&name, object)));
    let recognised: Vec<_> = objects.iter().filter_map(|object| recognised(&recogniser, object)).collect();
    if recognised.is_empty() {
        let nothing = reasons.into_iter().next().unwrap_or_else(|| format!("{name}: no outline in the file"));
        return Err(failure.unwrap_or_else(|| Failure::no_result(nothing)));
    }
    reasons.extend(warnings.finish());
    reasons.iter().for_each(|reason| warn(reason));
    let names: Vec<&str> = recogniser.names().collect();
    let written = match args.format {
        RecogniseFormat::Table => write_recognised_table(&mut sink, &recognised, &names),
        RecogniseFormat::Json => write_recognised_json(&mut sink, &recognised, &names),
    };
    written.map_err(|error| sink.failure(&error))?;
    let printed = sink.finish();
    failure.map_or(printed, Err)
}

/// What has come of an input.
#[derive(Default)]
struct Compared {
    objects: EvidenceByObject,
    /// Why there is no outline in some frames.
    reasons: Vec<String>,
    warnings: MissingWarnings,
    /// What ended the reading before its time.
    failure: Option<Failure>,
}

/// Compares the outlines of an input with the known ones, as many side by side as need not be waited for.
fn compare_all(mut input: Input, recogniser: &Recogniser, sink: &Sink) -> Compared {
    let progress = Progress::of_frames(input.frame_count(), sink.is_disturbed_by_progress());
    let mut waiting = SideBySide::of(&input);
    let mut compared = Compared::default();
    while let Some(item) = input.next() {
        progress.warn_of(&input.news());
        progress.advance();
        match item {
            Ok(Item::Outline(frame, _)) => {
                let points = frame.outline.point_count();
                waiting.add(frame, points);
                if waiting.are_enough() {
                    compare(recogniser, &waiting.take(), &mut compared.objects);
                }
            }
            Ok(Item::NoOutline { object, reason, .. }) => {
                // Objects come in the order in which they are seen.
                compare(recogniser, &waiting.take(), &mut compared.objects);
                compared.objects.of(&object).reject();
                compared.reasons.push(reason);
            }
            Ok(Item::Gap(missing)) => compared.reasons.extend(compared.warnings.take(&missing)),
            Err(error) => {
                compared.failure = Some(error);
                break;
            }
        }
    }
    compare(recogniser, &waiting.take(), &mut compared.objects);
    compared
}

/// A recogniser that has learnt the known outlines under the names of their files, as given.
fn learnt(args: &RecogniseArgs) -> Result<Recogniser, Failure> {
    let mut recogniser = Recogniser::new(RecogniseSettings::default()).map_err(Failure::unusable)?;
    for path in &args.known {
        let outline = read_shape(path).map_err(Failure::unusable)?;
        let name = path.display().to_string();
        recogniser.learn(name, &outline).map_err(|error| {
            let name = path.display();
            Failure::unusable(format_args!("{name}: cannot serve as a known outline: {error}"))
        })?;
    }
    Ok(recogniser)
}

/// Compares outlines on all cores.
fn compare(recogniser: &Recogniser, frames: &[OutlineFrame], objects: &mut EvidenceByObject) {
    let compare = |recogniser: &mut Recogniser, frame: &OutlineFrame| recogniser.compare(&frame.outline);
    let compared: Vec<_> = frames.par_iter().map_init(|| recogniser.clone(), compare).collect();
    frames.iter().zip(compared).for_each(|(frame, compared)| objects.of(&frame.object).take(compared));
}

/// Why frames of an object were left out, if some were.
fn refusal(
    input: &str,
    ObjectEvidence { object, frames_rejected, first_refusal, .. }: &ObjectEvidence,
) -> Option<String> {
    let error = first_refusal.as_ref()?;
    Some(format!("{input}: {frames_rejected} frame(s) of object {object:?} left out: {error}"))
}

/// `None` where no frame of an object could be compared.
fn recognised<'a>(recogniser: &Recogniser, object: &'a ObjectEvidence) -> Option<RecognisedObject<'a>> {
    let recognition = object.evidence.recognition(recogniser.settings())?;
    Some(RecognisedObject { object, recognition })
}
