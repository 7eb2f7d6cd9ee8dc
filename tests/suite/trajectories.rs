//! Poses of an object over all frames, smoothed or not.
use crate::common::seen_as;
use crate::tracker::{egg, seen, tracker};
use freeform_motion::{
    Tracker, TrackerSettings,
    curve_fit::Outline,
    outline_io::OutlineFrame,
    riccati::{MotionModel, RigidMotion},
    sim_camera::BuiltInShape,
    tracker::{Method, NotSmoothed, NotStated, Observation, Poses, SmoothingError, Trajectory},
};
use nalgebra::Rotation2;

fn followed(outlines: impl Iterator<Item = OutlineFrame>) -> (Tracker, Trajectory) {
    let (mut tracker, mut trajectory) = (tracker(Method::Filter), Trajectory::default());
    tracker.follow(outlines, |observation: Observation| trajectory.take(&observation));
    (tracker, trajectory)
}

/// As [`followed`], with what smoothing needs where the motion changes.
fn followed_for_smoothing(outlines: impl Iterator<Item = OutlineFrame>) -> (Tracker, Trajectory) {
    let (mut tracker, mut trajectory) = (tracker(Method::Filter), Trajectory::default());
    tracker.record_expected_states();
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

/// An egg that turns by 170 degrees from frame to frame, or by 190 the other way round, and what is told of it in each.
fn half_turns(mut tracker: Tracker, times: impl Iterator<Item = f64>) -> (Tracker, Trajectory, Vec<Observation>) {
    let frames = (0..).zip(times).map(|(frame, time)| OutlineFrame { time, ..egg(frame, 2.97 * 10.0 * time, 0.0) });
    let (mut trajectory, mut observations) = (Trajectory::default(), Vec::new());
    tracker.follow(frames, |observation| {
        trajectory.take(&observation);
        observations.push(observation);
    });
    (tracker, trajectory, observations)
}

#[test]
fn while_whole_turns_are_ambiguous_no_angle_is_stated_and_the_matrix_is() {
    let times = || (0..20).map(|frame| 0.1 * f64::from(frame));
    let (tracker, filtered, observations) = half_turns(tracker(Method::Filter), times());
    let mut smoothed = filtered.clone();
    assert_eq!(smoothed.smooth(&tracker), []);
    let mut poses = Poses::new(None);
    let of_frames: Vec<_> = observations.iter().map(|observation| poses.take(observation)).collect();
    let (filtered, smoothed) = (filtered.poses(None), smoothed.poses(None));
    for ((observation, of_frame), [filtered, smoothed]) in
        observations.iter().zip(of_frames).zip(filtered.iter().zip(&smoothed).map(|(a, b)| [a, b])).skip(1)
    {
        let ambiguity = observation.ambiguity.as_ref().expect("190 degrees the other way round");
        let apart = (ambiguity.turn - ambiguity.rival_turns[0]).abs();
        assert!((apart - std::f64::consts::TAU).abs() < 1e-9, "{ambiguity:?}");
        assert_eq!(observation.pose_not_stated(), NotStated::Ambiguous);
        let poses = [filtered, smoothed].map(|known| known.as_ref().expect("followed").pose.clone());
        for pose in poses.iter().chain(&of_frame) {
            let stated: Vec<bool> = pose.iter().map(|number| number.value.is_finite()).collect();
            assert_eq!(stated, [false, true, true], "{pose:?}");
            assert_eq!(pose[0].standard_deviation, f64::INFINITY);
        }
    }
    let affine = Tracker::new(TrackerSettings::new(Method::Filter, MotionModel::Affine)).expect("default settings");
    let (_, affine, observations) = half_turns(affine, times());
    let last = affine.poses(None).pop().flatten().expect("followed");
    assert!(observations.last().is_some_and(|observation| observation.ambiguity.is_some()));
    assert!(last.pose.iter().all(|number| number.value.is_finite()), "{:?}", last.pose);
}

#[test]
fn once_a_frame_has_told_whole_turns_apart_the_angle_is_stated_with_those_that_may_have_been_missed() {
    // A step of half the length tells a turn of 85 degrees from one of 95 the other way round.
    let times = (0..20).map(|frame| 0.1 * f64::from(frame) - if frame > 9 { 0.05 } else { 0.0 });
    let (tracker, mut trajectory, observations) = half_turns(tracker(Method::Filter), times.clone());
    let poses = trajectory.poses(None);
    let angle = |frame: usize| poses[frame].as_ref().expect("followed").pose[0];
    assert!(observations[9].ambiguity.is_some() && angle(9).value.is_nan());
    let (truth, last) = (-2.97 * 10.0 * 1.85, angle(19));
    assert!(observations[19].ambiguity.is_none() && last.value.is_finite(), "{:?}", observations[19].ambiguity);
    assert!((last.value - truth).abs() < 4.0 * last.standard_deviation, "{last:?} {truth}");
    assert!(last.standard_deviation > std::f64::consts::TAU, "{last:?}");
    // All frames together tell it of each, as the motion is constant.
    assert_eq!(trajectory.smooth(&tracker), []);
    for (time, smoothed) in times.zip(trajectory.poses(None)) {
        let [angle, ..] = smoothed.expect("known").pose[..] else { panic!("an angle") };
        let off = angle.value + 2.97 * 10.0 * time;
        assert!(off.abs() < 4.0 * angle.standard_deviation + 1e-3 && angle.standard_deviation < 0.01, "{angle:?}");
    }
    // Within a turn the last one was known before.
    let off = last.value - truth;
    assert!((off - std::f64::consts::TAU * (off / std::f64::consts::TAU).round()).abs() < 0.01, "{last:?} {truth}");
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

/// A bird that swings to and fro as it turns.
fn swinging() -> impl Iterator<Item = OutlineFrame> {
    let still = seen_as("bird", (BuiltInShape::Bird, RigidMotion::default()), 120, 150);
    still.into_iter().map(|frame| {
        let turn = Rotation2::new(turn_of_swinging(frame.time));
        let points = frame.outline.points().map(|point| turn * point).collect();
        OutlineFrame { outline: Outline::closed(points).expect("a turned outline"), ..frame }
    })
}

fn turn_of_swinging(time: f64) -> f64 {
    0.5 * time + 0.5 * (1.5 * time).sin()
}

#[test]
fn objects_whose_motion_changed_are_not_smoothed_without_what_was_expected_of_them_and_the_others_are() {
    let constant = (0..120).map(|frame| egg(frame, 0.05 * frame as f64, 0.0));
    let (tracker, filtered) = followed(swinging().zip(constant).flat_map(|(swinging, egg)| [swinging, egg]));
    let mut smoothed = filtered.clone();
    let changed = NotSmoothed { object: "bird".into(), reason: SmoothingError::MotionChanged };
    assert_eq!(smoothed.smooth(&tracker), [changed]);
    for (before, after) in filtered.rows().iter().zip(smoothed.rows()).take(100) {
        assert_eq!(before == after, before.object == "bird", "{before:?}");
    }
}

#[test]
fn a_changing_motion_is_smoothed_to_smaller_errors_within_its_deviations() {
    let (tracker, filtered) = followed_for_smoothing(swinging());
    assert!(tracker.motion_of_object_changed("bird"));
    let mut smoothed = filtered.clone();
    assert_eq!(smoothed.smooth(&tracker), []);
    // Of omega from the sixteenth frame on: mean squares of errors, of errors in their deviations, and of deviations.
    let sums = |trajectory: &Trajectory| {
        let (mut sums, mut count) = ([0.0; 3], 0.0);
        for (row, known) in trajectory.rows().iter().zip(trajectory.poses(None)).skip(15) {
            let omega = known.and_then(|known| known.motion.parameters().next()).expect("a motion");
            let Some((value, deviation)) = omega.value.zip(omega.standard_deviation) else { continue };
            // Positive clockwise.
            let truth = -(0.5 + 0.75 * (1.5 * row.time.expect("a time")).cos());
            let error = value - truth;
            let squares = [error.powi(2), (error / deviation).powi(2), deviation.powi(2)];
            sums.iter_mut().zip(squares).for_each(|(sum, square)| *sum += square);
            count += 1.0;
        }
        assert!(count > 80.0, "{count}");
        sums.map(|sum| sum / count)
    };
    let ([error, _, deviation], [smoothed_error, standardised, smoothed_deviation]) =
        (sums(&filtered), sums(&smoothed));
    assert!(smoothed_error < 0.8 * error && smoothed_deviation < deviation, "{smoothed_error} {error}");
    assert!(standardised < 1.5, "{standardised}");
}

#[test]
fn frames_before_a_sudden_change_are_not_smoothed_by_those_after_it() {
    let turned = |frame: u64| if frame < 40 { 0.05 * frame as f64 } else { 2.0 - 0.1 * (frame - 40) as f64 };
    let (tracker, filtered) = followed_for_smoothing((0..80).map(|frame| egg(frame, turned(frame), 0.0)));
    let mut smoothed = filtered.clone();
    assert_eq!(smoothed.smooth(&tracker), []);
    for (frame, known) in smoothed.poses(None).into_iter().enumerate().take(40).skip(10) {
        let omega = known.and_then(|known| known.motion.parameters().next()).expect("a motion");
        let (value, deviation) = omega.value.zip(omega.standard_deviation).expect("known");
        assert!((value + 0.5).abs() < 4.0 * deviation + 1e-3, "frame {frame}: {omega:?}");
    }
}
