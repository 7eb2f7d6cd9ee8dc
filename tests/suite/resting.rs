//! Objects whose states wait in a file go on as if they had stayed in memory.
use std::{cell::Cell, fs::File, num::NonZero};

use crate::common::seen_as;
use freeform_motion::{
    Tracker, TrackerSettings,
    outline_io::OutlineFrame,
    riccati::RigidMotion,
    sim_camera::BuiltInShape,
    tracker::{Observation, ReadAhead, Recorded, RejectionCause},
};

const OBJECTS: u64 = 12;
const FRAMES: usize = 8;

/// Objects of all shapes that are all in every frame, with outlines that are not theirs here and there.
fn recording() -> Vec<OutlineFrame> {
    let motion = RigidMotion { omega: 1.0, b1: 0.5, b2: 0.2 };
    let mut outlines: Vec<OutlineFrame> = (0..OBJECTS)
        .flat_map(|object| {
            let shape = BuiltInShape::ALL[object as usize % BuiltInShape::ALL.len()];
            seen_as(&object.to_string(), (shape, motion), 60, FRAMES)
        })
        .collect();
    outlines.sort_by_key(|outline| outline.frame);
    let (one, other) = (40, 41);
    let outline = outlines[one].outline.clone();
    outlines[other].outline = outline;
    outlines
}

fn followed(tracker: &mut Tracker, each: impl Fn()) -> Vec<Observation> {
    let mut observations = Vec::new();
    // Few at a time, so that objects come home and leave again.
    let ahead = ReadAhead { outlines: NonZero::new(3).expect("positive"), ..ReadAhead::default() };
    let recording = recording().into_iter().map(|outline| Recorded::<(), ()>::Outline(outline, ()));
    let result: Result<(), ()> = tracker.follow_recording(recording, ahead, |followed| {
        each();
        if let freeform_motion::tracker::Followed::Object(observation, _) = followed {
            observations.push(observation);
        }
        Ok(())
    });
    result.expect("nothing fails");
    observations
}

fn tracker() -> Tracker {
    Tracker::new(TrackerSettings::default()).expect("settings")
}

#[test]
fn objects_that_rest_in_a_file_go_on_to_the_last_bit() {
    let mut all_awake = tracker();
    let expected = followed(&mut all_awake, || {});
    for most_in_memory in [0, 1, 5] {
        let mut some_rest = tracker();
        let file = tempfile::tempfile().expect("a file");
        some_rest.keep_states_in(file.try_clone().expect("the file"), most_in_memory);
        assert_eq!(followed(&mut some_rest, || {}), expected);
        assert!(file.metadata().expect("the file").len() > 0, "none rested");
        assert_eq!(some_rest.results(), all_awake.results());
        assert_eq!(some_rest.to_bytes().expect("the filter"), all_awake.to_bytes().expect("the filter"));
        // Copies share what is in the file, and none changes that of another.
        let mut copy = some_rest.clone();
        let later = OutlineFrame { time: 100.0, ..recording().remove(0) };
        copy.push(&later);
        assert_eq!(some_rest.close("0"), all_awake.clone().close("0"));
        assert_eq!(copy.results().len(), OBJECTS as usize);
    }
}

#[test]
fn a_file_that_cannot_be_written_leaves_all_in_memory() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("states");
    std::fs::write(&path, "").expect("a file");
    let (mut all_awake, mut none_rests) = (tracker(), tracker());
    none_rests.keep_states_in(File::open(&path).expect("the file"), 1);
    assert_eq!(followed(&mut none_rests, || {}), followed(&mut all_awake, || {}));
    assert_eq!(none_rests.results(), all_awake.results());
}

#[test]
fn a_state_that_is_lost_is_told_and_no_other_takes_its_place() {
    let mut tracker = tracker();
    let file = tempfile::tempfile().expect("a file");
    tracker.keep_states_in(file.try_clone().expect("the file"), 2);
    let count = Cell::new(0);
    let observations = followed(&mut tracker, || {
        count.set(count.get() + 1);
        if count.get() == 50 {
            file.set_len(0).expect("the file");
        }
    });
    let lost = |observation: &&Observation| {
        matches!(observation.rejection.as_ref().map(|r| &r.cause), Some(RejectionCause::StateLost(_)))
    };
    let first = observations.iter().find(lost).expect("some rested").clone();
    assert!(first.time.is_some() && first.estimate.is_none());
    let after = observations.iter().filter(|o| o.object == first.object && o.frame > first.frame);
    assert!(after.filter(|o| !lost(o)).count() == 0);
    let result = tracker.results().into_iter().find(|result| result.object == first.object).expect("the object");
    assert_eq!((result.estimate, result.warnings[0].code()), (None, "state_lost"));
    assert!(tracker.to_bytes().is_err());
}
