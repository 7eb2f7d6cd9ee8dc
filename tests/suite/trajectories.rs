//! Poses of an object over all frames, smoothed or not.
use crate::common::seen_as;
use crate::tracker::{egg, seen, tracker};
use freeform_motion::{
    Tracker,
    curve_fit::Outline,
    outline_io::OutlineFrame,
    riccati::RigidMotion,
    sim_camera::BuiltInShape,
    tracker::{Method, NotSmoothed, Observation, SmoothingError, Trajectory},
};
use nalgebra::Rotation2;

fn followed(outlines: impl Iterator<Item = OutlineFrame>) -> (Tracker, Trajectory) {
    let (mut tracker, mut trajectory) = (tracker(Method::Filter), Trajectory::default());
    tracker.follow(outlines, |observation: Observation| trajectory.take(&observation));
    (tracker, trajectory)
}

#[test]
fn angles_of_a_trajectory_go_on_beyond_half_a_turn() {
    let (_, trajectory) = followed((0..60).map(|frame| egg(frame, 0.2 * frame as f64, 0.0)));
    let poses = trajectory.poses(None);
    assert!(poses[0].is_none(), "the motion is not known in the first frame");
    for (frame, known) in poses.iter().enumerate().skip(1) {
        let angle = known.as_ref().expect("followed").pose[0];
        // Positive where omega is, clockwise.
        assert!((angle.value + 0.2 * frame as f64).abs() < 0.01, "frame {frame}: {angle:?}");
    }
}

#[test]
fn smoothing_fills_the_first_frame_and_leaves_no_pose_less_certain() {
    let (tracker, filtered) = followed(seen(BuiltInShape::Bird, "bird", 200, 30).into_iter());
    let mut smoothed = filtered.clone();
    assert_eq!(smoothed.smooth(&tracker), []);
    let (before, after) = (filtered.poses(None), smoothed.poses(None));
    assert!(before[0].is_none() && after.iter().all(Option::is_some));
    for (before, after) in before.iter().zip(&after).skip(1) {
        let pairs = before.iter().zip(after).flat_map(|(before, after)| before.pose.iter().zip(&after.pose));
        for (before, after) in pairs {
            assert!(after.standard_deviation <= 1.000_001 * before.standard_deviation, "{before:?}, {after:?}");
        }
    }
}

#[test]
fn objects_whose_motion_changed_are_not_smoothed_and_the_others_are() {
    let still = seen_as("bird", (BuiltInShape::Bird, RigidMotion::default()), 120, 150);
    let swinging = still.into_iter().map(|frame| {
        let turn = Rotation2::new(0.5 * frame.time + 0.5 * (1.5 * frame.time).sin());
        let points = frame.outline.points().map(|point| turn * point).collect();
        OutlineFrame { outline: Outline::closed(points).expect("a turned outline"), ..frame }
    });
    let constant = (0..120).map(|frame| egg(frame, 0.05 * frame as f64, 0.0));
    let (tracker, filtered) = followed(swinging.zip(constant).flat_map(|(swinging, egg)| [swinging, egg]));
    let mut smoothed = filtered.clone();
    let changed = NotSmoothed { object: "bird".into(), reason: SmoothingError::MotionChanged };
    assert_eq!(smoothed.smooth(&tracker), [changed]);
    for (before, after) in filtered.rows().iter().zip(smoothed.rows()).take(100) {
        assert_eq!(before == after, before.object == "bird", "{before:?}");
    }
}
