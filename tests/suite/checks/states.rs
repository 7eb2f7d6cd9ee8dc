//! Saved states of filters.
use std::sync::LazyLock;

use freeform_motion::outline_filter::{FilterSettings, MotionFilter, with_header};
use freeform_motion::riccati::RigidMotion;
use freeform_motion::sim_camera::{BuiltInShape, Camera, Frame, Scene, SequenceLength, Settings, Simulator};

/// Bytes before the state proper.
const HEADER: usize = 16;

/// Frames of a square, whose turns stay in doubt.
static FRAMES: LazyLock<Vec<Frame>> = LazyLock::new(|| {
    let scene = Scene::new(BuiltInShape::Square, RigidMotion { omega: 1.0, b1: 0.2, b2: 0.1 }, Camera::default());
    let settings = Settings { length: SequenceLength::Frames(8), points: 40, ..Settings::default() };
    Simulator::new(scene, settings).expect("a simulation").frames().collect()
});

/// A state after half of them, without its header.
static STATE: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let mut filter = MotionFilter::new(FilterSettings::default()).expect("settings");
    for frame in &FRAMES[..4] {
        filter.step(frame.time, &frame.outline).expect("increasing times");
    }
    filter.to_bytes().expect("memory takes it").split_off(HEADER)
});

/// A filter goes through bytes and comes out as it was.
pub(super) fn assert_restorable(filter: &MotionFilter) {
    let bytes = filter.to_bytes().expect("memory takes it");
    let restored = MotionFilter::from_bytes(&bytes).expect("a state that was saved");
    assert_eq!(restored.to_bytes().expect("memory takes it"), bytes);
}

/// Any bytes, and any changes of a good state: an error, or a filter that takes frames.
pub(crate) fn saved_state(bytes: &[u8]) {
    assert!(MotionFilter::from_bytes(bytes).is_err());
    take_frames(&with_header(*b"filt", bytes));
    // Three bytes are a place and what is put there.
    let mut state = STATE.clone();
    for change in bytes.chunks_exact(3) {
        let place = usize::from(change[0]) << 8 | usize::from(change[1]);
        let length = state.len();
        state[place % length] = change[2];
    }
    take_frames(&with_header(*b"filt", &state));
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
