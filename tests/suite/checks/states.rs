//! Saved states of filters.
use std::sync::LazyLock;

use freeform_motion::decompose::Line;
use freeform_motion::estimate::StateFormat;
use freeform_motion::identify::{AdaptiveIdentifier, AdaptiveLaw, AdaptiveSettings, PairChoice};
use freeform_motion::outline_filter::{FilterSettings, MotionFilter, state_format};
use freeform_motion::outline_io::OutlineFrame;
use freeform_motion::riccati::{MotionModel, RigidMotion};
use freeform_motion::sim_camera::{BuiltInShape, Camera, Frame, Scene, SequenceLength, Settings, Simulator};
use freeform_motion::tracker::Method;
use freeform_motion::{Pipeline, PipelineSettings, Tracker, TrackerSettings};
use nalgebra::Complex;

/// Bytes before the state proper.
const HEADER: usize = 16;

/// Frames of a square, whose turns stay in doubt.
static FRAMES: LazyLock<Vec<Frame>> = LazyLock::new(|| frames_of(BuiltInShape::Square));

/// A state after half of them, without its header.
static STATE: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let mut filter = MotionFilter::new(FilterSettings::default()).expect("settings");
    for frame in &FRAMES[..4] {
        filter.step(frame.time, &frame.outline).expect("increasing times");
    }
    filter.to_bytes().expect("memory takes it").split_off(HEADER)
});

/// The header of an adaptive identifier.
const ADAPTIVE: StateFormat = StateFormat { version: 1, kind: *b"adap", name: "adaptive identifier" };

/// States of adaptive identifiers after some frames, without their header: one for every law and for one and all pairs.
static ADAPTIVE_STATES: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| {
    let laws = [AdaptiveLaw::Structured, AdaptiveLaw::Printed, AdaptiveLaw::FilteredLeastSquares];
    let all = laws.into_iter().flat_map(|law| [PairChoice::All, PairChoice::Best].map(|pairs| (law, pairs)));
    let state = |(law, pairs)| {
        let settings = AdaptiveSettings { model: MotionModel::Affine, law, pairs, ..AdaptiveSettings::default() };
        let mut identifier = AdaptiveIdentifier::new(settings).expect("settings");
        for frame in 0..6 {
            identifier.step(f64::from(frame) / 30.0, &lines_at(frame)).expect("increasing times");
        }
        identifier.to_bytes().expect("memory takes it").split_off(HEADER)
    };
    all.map(state).collect()
});

/// The header of a pipeline.
const PIPELINE: StateFormat = StateFormat { version: 1, kind: *b"pipe", name: "pipeline" };

/// States of pipelines after half of the frames, without their header: of a family without a pose, and of one with it.
static PIPELINE_STATES: LazyLock<[Vec<u8>; 2]> = LazyLock::new(|| {
    [MotionModel::Rigid, MotionModel::Projective].map(|model| {
        let mut pipeline = Pipeline::new(PipelineSettings::for_model(model)).expect("settings");
        for frame in &BIRDS[..4] {
            pipeline.push(frame.time, &frame.outline).expect("a bird");
        }
        pipeline.to_bytes().expect("memory takes it").split_off(HEADER)
    })
});

/// States of trackers without their header, of either method: objects of which nothing but rejected frames is known, and one that was followed. The
/// state of a filter within them has a checksum of its own, so that short ones leave more places where a change is not seen at once.
static TRACKER_STATES: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| {
    let state = |(method, followed): (Method, usize)| {
        let mut tracker = Tracker::new(TrackerSettings::new(method, MotionModel::Rigid)).expect("settings");
        for (number, frame) in (0..).zip(&BIRDS[..followed]) {
            tracker.push(&named("bird", number, frame));
        }
        for number in 0..3 {
            tracker.reject("other", number, format!("frame {number}: torn"));
        }
        tracker.to_bytes().expect("no plane").split_off(HEADER)
    };
    [(Method::Filter, 0), (Method::Adaptive, 0), (Method::Filter, 3), (Method::Adaptive, 4)].map(state).to_vec()
});

/// A frame of an object with a name.
fn named(object: &str, number: u64, frame: &Frame) -> OutlineFrame {
    OutlineFrame { frame: number, time: frame.time, object: object.to_owned(), outline: frame.outline.clone() }
}

/// Frames of a bird, whose lines are apart.
static BIRDS: LazyLock<Vec<Frame>> = LazyLock::new(|| frames_of(BuiltInShape::Bird));

fn frames_of(shape: BuiltInShape) -> Vec<Frame> {
    let scene = Scene::new(shape, RigidMotion { omega: 1.0, b1: 0.2, b2: 0.1 }, Camera::default());
    let settings = Settings { length: SequenceLength::Frames(8), points: 40, ..Settings::default() };
    Simulator::new(scene, settings).expect("a simulation").frames().collect()
}

/// Lines that turn and drift.
fn lines_at(frame: i32) -> [Line; 2] {
    let time = f64::from(frame) / 30.0;
    let line = |phase: f64| {
        let w = Complex::from_polar(0.4, phase + 2.0 * time);
        Line {
            l: Complex::new(0.0, 1.0) * (Complex::from(1.0) + w) / (Complex::from(1.0) - w),
            k: Complex::new(0.1 * time, 0.2),
        }
    };
    [line(0.4), line(-2.2)]
}

/// An identifier goes through bytes and comes out as it was.
pub(super) fn assert_adaptive_restorable(identifier: &AdaptiveIdentifier) {
    let bytes = identifier.to_bytes().expect("memory takes it");
    let restored = AdaptiveIdentifier::from_bytes(&bytes).expect("a state that was saved");
    assert_eq!(restored.to_bytes().expect("memory takes it"), bytes);
    assert_eq!(restored.estimate(), identifier.estimate());
}

/// A filter goes through bytes and comes out as it was.
pub(super) fn assert_restorable(filter: &MotionFilter) {
    let bytes = filter.to_bytes().expect("memory takes it");
    let restored = MotionFilter::from_bytes(&bytes).expect("a state that was saved");
    assert_eq!(restored.to_bytes().expect("memory takes it"), bytes);
}

/// Any bytes, and any changes of a good state: an error, or a filter that takes frames.
pub(crate) fn saved_state(bytes: &[u8]) {
    assert!(MotionFilter::from_bytes(bytes).is_err() && AdaptiveIdentifier::from_bytes(bytes).is_err());
    assert!(Pipeline::from_bytes(bytes).is_err() && Tracker::from_bytes(bytes).is_err());
    take_frames(&state_format(*b"filt", "filter").with_header(bytes));
    write_lines(&ADAPTIVE.with_header(bytes));
    take_frames(&state_format(*b"filt", "filter").with_header(&changed(&STATE, bytes)));
    let choice = usize::from(bytes.first().copied().unwrap_or(0));
    write_lines(&ADAPTIVE.with_header(&changed(&ADAPTIVE_STATES[choice % ADAPTIVE_STATES.len()], bytes)));
    take_outlines(&PIPELINE.with_header(bytes));
    take_outlines(&PIPELINE.with_header(&changed(&PIPELINE_STATES[choice % PIPELINE_STATES.len()], bytes)));
    let tracker = state_format(*b"trak", "tracker");
    take_objects(&tracker.with_header(bytes));
    take_objects(&tracker.with_header(&changed(&TRACKER_STATES[choice % TRACKER_STATES.len()], bytes)));
}

/// A state with some of its bytes changed: three bytes are a place and what is put there.
fn changed(state: &[u8], bytes: &[u8]) -> Vec<u8> {
    let mut state = state.to_vec();
    for change in bytes.chunks_exact(3) {
        let place = usize::from(change[0]) << 8 | usize::from(change[1]);
        let length = state.len();
        state[place % length] = change[2];
    }
    state
}

fn write_lines(bytes: &[u8]) {
    let Ok(mut identifier) = AdaptiveIdentifier::from_bytes(bytes) else { return };
    for frame in 6..12 {
        // Any answer will do that is a number.
        let _ = identifier.step(f64::from(frame) / 30.0, &lines_at(frame));
        assert!(identifier.estimate().is_none_or(|estimate| estimate.is_finite()));
        let _ = (identifier.is_observable(), identifier.chosen_pair(), identifier.rotation_content(0));
    }
    assert_adaptive_restorable(&identifier);
}

fn take_frames(bytes: &[u8]) {
    let Ok(mut filter) = MotionFilter::from_bytes(bytes) else { return };
    for frame in &FRAMES[4..] {
        // Any answer will do.
        let _ = filter.step(10.0 + frame.time, &frame.outline);
        let _ = (filter.state(), filter.velocity(), filter.ambiguity(), filter.outline_points().count());
        let _ = (filter.aliases(), filter.dynamics(), filter.wrong_family(), filter.unstated());
    }
}

fn take_outlines(bytes: &[u8]) {
    let Ok(mut pipeline) = Pipeline::from_bytes(bytes) else { return };
    for frame in &BIRDS[4..] {
        // Any answer will do.
        let _ = (pipeline.push(frame.time, &frame.outline), pipeline.estimate(), pipeline.warnings());
    }
    let bytes = pipeline.to_bytes().expect("memory takes it");
    let restored = Pipeline::from_bytes(&bytes).expect("a state that was saved");
    assert_eq!(restored.to_bytes().expect("memory takes it"), bytes);
}

fn take_objects(bytes: &[u8]) {
    let Ok(mut tracker) = Tracker::from_bytes(bytes) else { return };
    let names: Vec<String> = tracker.objects().map(str::to_owned).chain(["bird".to_owned()]).take(4).collect();
    for (number, frame) in (4..).zip(&BIRDS[4..]) {
        for name in &names {
            // Any answer will do.
            let _ = tracker.push(&named(name, number, frame));
        }
    }
    let told = |tracker: &Tracker| {
        let results = tracker.results();
        results.iter().flat_map(|result| result.warnings.iter().map(ToString::to_string)).collect::<Vec<_>>()
    };
    let bytes = tracker.to_bytes().expect("no plane");
    let restored = Tracker::from_bytes(&bytes).expect("a state that was saved");
    assert_eq!(restored.to_bytes().expect("no plane"), bytes);
    assert_eq!(told(&restored), told(&tracker));
}
