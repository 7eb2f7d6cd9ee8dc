//! A tracker saved and restored goes on as before, to the last bit.
use crate::common::seen_as;
use freeform_motion::{
    Rectification, Tracker, TrackerSettings,
    outline_filter::{FilterSettings, StateError},
    outline_io::OutlineFrame,
    riccati::{CameraScale, MotionModel, PinholeCamera, RigidMotion},
    sim_camera::BuiltInShape,
    tracker::{Method, MethodSettings, TrackerStateError},
};
use nalgebra::{Matrix3, Point2, Projective2};

fn seen(shape: BuiltInShape, object: &str, count: usize) -> Vec<OutlineFrame> {
    seen_as(object, (shape, RigidMotion { omega: 1.0, b1: 0.5, b2: 0.2 }), 100, count)
}

fn tracker() -> Tracker {
    let scale = CameraScale::new(0.5).ok();
    Tracker::new(TrackerSettings { scale, ..TrackerSettings::default() }).expect("settings")
}

#[test]
fn a_restored_tracker_goes_on_to_the_last_bit_and_keeps_what_it_told() {
    let (mut straight, mut interrupted) = (tracker(), tracker());
    let (birds, squares) = (seen(BuiltInShape::Bird, "bird", 20), seen(BuiltInShape::Square, "square", 20));
    for (index, (bird, square)) in birds.iter().zip(&squares).enumerate() {
        interrupted = Tracker::from_bytes(&interrupted.to_bytes().expect("the filter")).expect("a saved state");
        // Another object under the name of the first, a frame that is late, and points that are no outline.
        let bird = match index {
            8..=10 => OutlineFrame { outline: square.outline.clone(), ..bird.clone() },
            12 => OutlineFrame { time: 0.0, ..bird.clone() },
            _ => bird.clone(),
        };
        for frame in [&bird, square] {
            assert_eq!(interrupted.push(frame), straight.push(frame), "frame {index}");
        }
        if index == 15 {
            for tracker in [&mut interrupted, &mut straight] {
                assert!(!tracker.reject("bird", 15, "frame 15: torn".to_owned()).is_accepted());
            }
        }
    }
    assert!(interrupted.objects().eq(["bird", "square"]));
    for (ours, expected) in interrupted.results().iter().zip(straight.results()) {
        assert_eq!((ours.estimate, ours.velocity), (expected.estimate, expected.velocity));
        assert_eq!((ours.frames, ours.frames_rejected), (expected.frames, expected.frames_rejected));
        assert!(ours.warnings.iter().map(ToString::to_string).eq(expected.warnings.iter().map(ToString::to_string)));
    }
    assert!(straight.results()[0].frames_rejected > 3);
}

#[test]
fn a_restored_tracker_sees_the_plane_that_the_saved_one_saw() {
    let map = Matrix3::new(1.0, 0.1, 0.2, 0.0, 1.3, 0.0, 0.02, 0.01, 1.0);
    let rectification = Rectification::new(&Projective2::from_matrix_unchecked(map)).ok();
    let settings = TrackerSettings { rectification, ..TrackerSettings::default() };
    let mut straight = Tracker::new(settings).expect("settings");
    for frame in &seen(BuiltInShape::Bird, "bird", 8) {
        let mut restored = Tracker::from_bytes(&straight.to_bytes().expect("the filter")).expect("a saved state");
        assert_eq!(restored.settings(), straight.settings());
        assert_eq!(restored.push(frame), straight.push(frame));
    }
}

#[test]
fn a_tracker_is_not_made_from_the_state_of_something_else_or_from_parts() {
    let mut tracker = tracker();
    seen(BuiltInShape::Bird, "bird", 5).iter().for_each(|frame| drop(tracker.push(frame)));
    let bytes = tracker.to_bytes().expect("the filter");
    let error = |bytes: &[u8]| Tracker::from_bytes(bytes).err();
    assert_eq!(error(&bytes[..bytes.len() / 2]), Some(TrackerStateError::State(StateError::Damaged)));
    let mut later = bytes.clone();
    later[0] += 1;
    assert!(matches!(error(&later), Some(TrackerStateError::State(StateError::Version { .. }))));
    let filter = freeform_motion::outline_filter::MotionFilter::new(Default::default()).expect("settings");
    let filter = filter.to_bytes().expect("memory");
    assert_eq!(error(&filter), Some(TrackerStateError::State(StateError::Kind { expected: "tracker" })));
}

#[test]
fn a_restored_tracker_of_the_adaptive_method_goes_on_to_the_last_bit() {
    let settings = TrackerSettings::new(Method::Adaptive, MotionModel::Affine);
    let mut straight = Tracker::new(settings).expect("settings");
    let mut interrupted = straight.clone();
    for (index, frame) in seen(BuiltInShape::Bird, "bird", 10).iter().enumerate() {
        interrupted = Tracker::from_bytes(&interrupted.to_bytes().expect("memory")).expect("a saved state");
        assert_eq!(interrupted.push(frame), straight.push(frame), "frame {index}");
    }
    assert_eq!(interrupted.settings(), straight.settings());
    assert_eq!(interrupted.results(), straight.results());
    assert!(straight.results()[0].estimate.is_some());
}

#[test]
fn a_plane_in_space_has_no_saved_state() {
    let camera = PinholeCamera::new(2.0, Point2::origin()).expect("a camera");
    let method =
        MethodSettings::Plane(camera, FilterSettings { model: MotionModel::Projective, ..FilterSettings::default() });
    let plane = Tracker::new(TrackerSettings { method, ..TrackerSettings::default() }).expect("settings");
    assert_eq!(plane.to_bytes(), Err(TrackerStateError::Plane));
}
