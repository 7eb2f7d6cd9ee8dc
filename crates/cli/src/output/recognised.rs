use std::io::{self, Write};

use freeform_motion::recognise::{Candidate, ObjectEvidence, Recognition};
use freeform_motion::significant;
use serde_json::{Value, json};

use super::aligned::write_aligned;

/// Known outlines that are listed, most probable first.
const CANDIDATES: usize = 5;

/// An object whose frames were compared with the known outlines.
pub(crate) struct RecognisedObject<'a> {
    pub(crate) object: &'a ObjectEvidence,
    pub(crate) recognition: Recognition,
}

/// One row per object for reading.
pub(crate) fn write_recognised_table(
    sink: &mut impl Write,
    objects: &[RecognisedObject<'_>],
    names: &[&str],
) -> io::Result<()> {
    let row = |RecognisedObject { object, recognition }: &RecognisedObject<'_>| {
        let nearest = recognition.candidates.first();
        let distance = nearest.and_then(|candidate| candidate.distance).map_or("-".to_owned(), |d| significant(d, 2));
        let name = recognition.known.map_or("none of them", |known| names[known]);
        let next = nearest.filter(|_| recognition.known.is_none()).map_or("", |candidate| names[candidate.known]);
        vec![
            object.object.clone(),
            object.evidence.frames().to_string(),
            name.to_owned(),
            format!("{:.3}", recognition.probability),
            distance,
            next.to_owned(),
        ]
    };
    let rows: Vec<Vec<String>> = objects.iter().map(row).collect();
    write_aligned(sink, &["object", "frames", "name", "probability", "distance", "nearest"], &rows, &[0, 2, 5])
}

/// All objects as one JSON object.
pub(crate) fn write_recognised_json(
    sink: &mut impl Write,
    objects: &[RecognisedObject<'_>],
    names: &[&str],
) -> io::Result<()> {
    let objects: Vec<Value> = objects.iter().map(|object| object_json(object, names)).collect();
    serde_json::to_writer_pretty(&mut *sink, &json!({"schema": "freeform.recognise/1", "objects": objects}))?;
    writeln!(sink)
}

fn object_json(RecognisedObject { object, recognition }: &RecognisedObject<'_>, names: &[&str]) -> Value {
    let map = recognition.known.and_then(|_| recognition.candidates.first()?.map);
    let rows = map.map(|map| [0, 1, 2].map(|row| [0, 1, 2].map(|column| map.matrix()[(row, column)])));
    json!({
        "object": object.object,
        "frames": object.evidence.frames(),
        "frames_rejected": object.frames_rejected,
        "name": recognition.known.map(|known| names[known]),
        "probability": recognition.probability,
        "map": rows,
        "candidates": recognition.candidates.iter().take(CANDIDATES).map(|c| candidate_json(c, names)).collect::<Vec<_>>(),
    })
}

fn candidate_json(candidate: &Candidate, names: &[&str]) -> Value {
    json!({
        "name": names[candidate.known],
        "probability": candidate.probability,
        "distance": candidate.distance,
        "invariant_distance": candidate.invariant_distance,
    })
}
