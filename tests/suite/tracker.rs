//! Many objects followed through a sequence.
use std::{collections::BTreeSet, num::NonZero, panic};

use crate::common::seen_as;
use freeform_motion::{
    TracedContours, Tracker, TrackerSettings, Warning,
    curve_fit::Outline,
    estimate::TimeNotIncreasing,
    outline_filter::{Ambiguity, FilterError, FilterSettings},
    outline_io::OutlineFrame,
    riccati::{CameraScale, MotionModel, RigidMotion},
    sim_camera::BuiltInShape,
    tracker::{
        Followed, FrameRanges, FrameRejection, Method, MethodSettings, ObjectPhase, ReadAhead, Recorded, RejectionCause,
    },
};
use nalgebra::{Isometry2, Point2, Rotation2, Vector2};
use proptest::prelude::*;

pub(crate) fn tracker(method: Method) -> Tracker {
    Tracker::new(TrackerSettings::new(method, MotionModel::Rigid)).expect("default settings")
}

/// What a camera sees of a shape with so many points on it.
pub(crate) fn seen(shape: BuiltInShape, object: &str, points: usize, count: usize) -> Vec<OutlineFrame> {
    seen_as(object, (shape, RigidMotion { omega: 1.0, b1: 0.5, b2: 0.2 }), points, count)
}

/// An egg, turned anticlockwise by an angle in rad and shifted to the right, at a tenth of a second per frame.
pub(crate) fn egg(frame: u64, angle: f64, shift: f64) -> OutlineFrame {
    let pose = Isometry2::new(Vector2::new(shift, 0.0), angle);
    let points = (0..200).map(|i| {
        let t = std::f64::consts::TAU * f64::from(i) / 200.0;
        pose * Point2::new(0.5 * t.cos() + 0.05 * (2.0 * t).cos(), 0.35 * t.sin())
    });
    let outline = Outline::closed(points.collect()).expect("an egg");
    OutlineFrame { frame, time: 0.1 * frame as f64, object: "egg".to_owned(), outline }
}

/// Several objects, of which one is much more work and one comes late, with rejected outlines and gaps between them.
fn recording() -> Vec<Recorded<u64, u64>> {
    let mut recorded = Vec::new();
    let objects = [
        ("much", BuiltInShape::Bird, 1500, 0),
        ("little", BuiltInShape::Van, 60, 0),
        ("late", BuiltInShape::Hat, 80, 20),
    ];
    let objects = objects.map(|(name, shape, points, from)| (seen(shape, name, points, 40), from));
    for number in 0..40_u64 {
        for (outlines, from) in &objects {
            match (number % 7, &outlines[number as usize]) {
                _ if number < *from => {}
                (3, frame) => {
                    let reason = format!("frame {number}: torn");
                    recorded.push(Recorded::NoOutline { object: frame.object.clone(), frame: number, reason });
                }
                (_, frame) => recorded.push(Recorded::Outline(frame.clone(), recorded.len() as u64)),
            }
        }
        if number % 5 == 4 {
            recorded.push(Recorded::Gap(number));
        }
    }
    recorded
}

fn one_by_one(tracker: &mut Tracker, recording: Vec<Recorded<u64, u64>>) -> Vec<Followed<u64, u64>> {
    let followed = recording.into_iter().map(|recorded| match recorded {
        Recorded::Outline(frame, with) => Followed::Object(tracker.push(&frame), Some((frame, with))),
        Recorded::NoOutline { object, frame, reason } => Followed::Object(tracker.reject(&object, frame, reason), None),
        Recorded::Gap(gap) => Followed::Gap(gap),
    });
    followed.collect()
}

#[test]
fn a_recording_gives_on_any_number_of_threads_what_its_frames_give_one_by_one() {
    for method in [Method::Filter, Method::Adaptive] {
        let mut alone = tracker(method);
        let expected = one_by_one(&mut alone, recording());
        for (threads, outlines, points) in
            [(1, 1, 1), (1, 50, 10_000), (2, 3, 1 << 18), (4, 4096, 1 << 18), (3, 4096, 2000)]
        {
            let positive = |number| NonZero::new(number).expect("positive");
            let ahead = ReadAhead { threads: positive(threads), outlines: positive(outlines), points };
            let (mut tracker, mut followed) = (tracker(method), Vec::new());
            let done = tracker.follow_recording(recording(), ahead, |next| {
                followed.push(next);
                Ok::<(), ()>(())
            });
            assert_eq!((done, followed.len()), (Ok(()), expected.len()));
            assert!(followed == expected, "{method}, {ahead:?}");
            assert_eq!(tracker.results(), alone.results());
            assert!(tracker.objects().eq(["much", "little", "late"]));
        }
    }
}

#[test]
fn work_that_is_done_between_the_frames_of_all_objects_changes_no_result() {
    let (mut straight, mut prepared) = (tracker(Method::Filter), tracker(Method::Filter));
    let names = [("bird", BuiltInShape::Bird), ("van", BuiltInShape::Van)];
    let [birds, vans] = names.map(|(name, shape)| seen(shape, name, 200, 20));
    let mut most_waiting = 0;
    for (bird, van) in birds.iter().zip(&vans) {
        for frame in [bird, van] {
            assert_eq!(prepared.push(frame), straight.push(frame));
        }
        let waiting = std::iter::repeat_with(|| prepared.prepare()).take_while(|is_more_waiting| *is_more_waiting);
        most_waiting = waiting.count().max(most_waiting);
    }
    assert_eq!(prepared.results(), straight.results());
    // A map that is cut anew from four frames is measured on each of them.
    assert!(most_waiting > 3, "{most_waiting}");
    let mut adaptive = tracker(Method::Adaptive);
    adaptive.push(&birds[0]);
    assert!(!adaptive.prepare());
}

#[test]
fn a_recording_read_frame_by_frame_is_read_no_further_than_handed_on() {
    let read = std::cell::Cell::new(0);
    let recording = recording().into_iter().inspect(|_| read.set(read.get() + 1));
    let mut handed_on = 0;
    let done = tracker(Method::Filter).follow_recording(recording, ReadAhead::FRAME_BY_FRAME, |_| {
        handed_on += 1;
        assert_eq!(read.get(), handed_on);
        Ok::<(), ()>(())
    });
    assert_eq!(done, Ok(()));
}

#[test]
fn an_observer_that_fails_ends_the_reading_and_every_object_goes_on() {
    let mut tracker = tracker(Method::Filter);
    let mut count = 0;
    let done = tracker.follow_recording(recording(), ReadAhead::default(), |_| {
        count += 1;
        if count == 50 { Err("enough") } else { Ok(()) }
    });
    assert_eq!((done, count), (Err("enough"), 50));
    assert!(tracker.objects().take(2).eq(["much", "little"]));
    let mut later = seen(BuiltInShape::Van, "little", 60, 60).remove(59);
    later.frame = 99;
    assert!(tracker.push(&later).estimate.is_some(), "the motion found before is still known");
}

#[test]
fn a_source_that_panics_leaves_a_tracker_as_new() {
    let mut tracker = tracker(Method::Filter);
    let broken = panic::catch_unwind(panic::AssertUnwindSafe(|| {
        let recording = seen(BuiltInShape::Van, "van", 60, 40);
        let torn = recording.into_iter().inspect(|frame| assert!(frame.frame < 30, "on purpose"));
        tracker.follow(torn, |_| {});
    }));
    assert!(broken.is_err());
    assert_eq!(tracker.objects().len(), 0);
    assert!(tracker.push(&egg(0, 0.0, 0.0)).is_accepted());
}

#[test]
fn estimates_and_velocities_are_in_space_where_a_camera_scale_is_given() {
    let scale = CameraScale::new(0.1).expect("a scale");
    for method in [Method::Filter, Method::Adaptive] {
        let mut in_image = tracker(method);
        let settings = TrackerSettings { scale: Some(scale), ..in_image.settings().clone() };
        let mut in_space = Tracker::new(settings).expect("settings");
        for frame in seen(BuiltInShape::Bird, "bird", 200, 20) {
            let (image, space) = (in_image.push(&frame), in_space.push(&frame));
            assert_eq!(image.estimate.map(|estimate| estimate.in_space(scale)), space.estimate);
        }
        let (image, space) = (in_image.results().remove(0), in_space.results().remove(0));
        assert_eq!(image.estimate.map(|estimate| estimate.in_space(scale)), space.estimate);
        assert_eq!(image.velocity.is_some(), method == Method::Filter);
        assert_eq!(image.velocity.map(|velocity| velocity.in_space(scale)), space.velocity);
    }
}

#[test]
fn phases_tell_what_each_method_does_with_an_object() {
    let phases = |method: Method, outlines: &[OutlineFrame]| {
        let mut tracker = tracker(method);
        outlines.iter().map(|frame| tracker.push(frame).phase.map(ObjectPhase::name)).collect::<Vec<_>>()
    };
    let outlines = seen(BuiltInShape::Bird, "bird", 200, 3);
    assert_eq!(phases(Method::Filter, &outlines), ["acquiring", "tracking", "tracking"].map(Some));
    assert_eq!(phases(Method::Adaptive, &outlines), ["start", "adapt", "adapt"].map(Some));
}

#[test]
fn a_frame_that_cannot_be_used_says_why_and_counts_as_rejected() {
    let mut tracker = tracker(Method::Filter);
    for frame in 0..3 {
        assert!(tracker.push(&egg(frame, 0.1 * frame as f64, 0.0)).is_accepted());
    }
    let again = tracker.push(&egg(1, 0.1, 0.0));
    let late = FilterError::TimeNotIncreasing(TimeNotIncreasing { previous: 0.2, time: 0.1 });
    let rejection = FrameRejection { object: "egg".to_owned(), frame: 1, cause: RejectionCause::Filter(late) };
    assert_eq!((again.phase, again.rejection.as_ref()), (None, Some(&rejection)));
    assert_eq!(
        rejection.to_string(),
        "frame 1 of object \"egg\": times must increase: a frame at 0.1 s after one at 0.2 s"
    );
    let far = tracker.push(&OutlineFrame { outline: egg(3, 0.3, 40.0).outline, ..egg(3, 0.3, 0.0) });
    assert!(matches!(far.rejection.expect("40 lengths away").cause, RejectionCause::NotAccepted(_)));
    let torn = tracker.reject("egg", 4, "line 7: torn".to_owned());
    assert_eq!(
        (torn.time, torn.rejection.map(|rejection| rejection.to_string())),
        (None, Some("line 7: torn".to_owned()))
    );
    let result = tracker.results().remove(0);
    assert_eq!((result.frames, result.frames_rejected, result.first_rejection), (6, 3, Some(rejection)));
}

#[test]
fn the_first_rejected_frames_are_named_with_their_reasons_and_the_others_by_their_numbers() {
    let mut tracker = tracker(Method::Filter);
    for frame in (0..12).chain([20]) {
        tracker.reject("a", frame, format!("frame {frame}: torn"));
    }
    let warnings = tracker.results().remove(0).warnings;
    let texts: Vec<String> = warnings.iter().map(ToString::to_string).collect();
    assert_eq!((warnings.len(), texts[0].as_str()), (11, "rejected: frame 0: torn"));
    assert_eq!(texts[10], "rejected: 3 more frame(s), 10-11, 20");
    let frames = FrameRanges::from_iter([10, 11, 20]);
    assert_eq!(warnings[10], Warning::MoreFramesRejected { count: 3, frames });
}

#[test]
fn points_that_do_not_follow_the_contour_are_told_once_and_come_first_among_the_warnings() {
    let mut tracker = tracker(Method::Filter);
    let mut told = Vec::new();
    for mut frame in seen(BuiltInShape::Bird, "bird", 200, 6) {
        let mut points: Vec<_> = frame.outline.points().copied().collect();
        points.sort_by(|p, q| p.x.total_cmp(&q.x));
        frame.outline = Outline::closed(points).expect("the same points");
        told.extend(tracker.push(&frame).warning);
    }
    assert_eq!(told.iter().map(Warning::code).collect::<Vec<_>>(), ["points_out_of_order"]);
    assert_eq!(tracker.results()[0].warnings.first(), told.first());
}

#[test]
fn each_method_warns_of_what_its_outlines_do_not_tell() {
    let codes = |method, shape| {
        let mut tracker = tracker(method);
        // Round the middle of the shape, as a path would tell the turn of a circle.
        let motion = RigidMotion { omega: 1.0, b1: 0.0, b2: 0.0 };
        seen_as("0", (shape, motion), 200, 30).iter().for_each(|frame| drop(tracker.push(frame)));
        tracker.results()[0].warnings.iter().map(Warning::code).collect::<Vec<_>>()
    };
    assert_eq!(codes(Method::Filter, BuiltInShape::Bird), [""; 0]);
    assert!(codes(Method::Filter, BuiltInShape::Circle).contains(&"not_observable"));
    assert_eq!(codes(Method::Adaptive, BuiltInShape::Bird), ["may_not_have_settled"]);
    assert!(codes(Method::Adaptive, BuiltInShape::Circle).contains(&"rotation_not_observable"));
}

#[test]
fn every_warning_has_a_code_of_its_own_in_snake_case_and_a_message_on_one_line() {
    let parameters = || vec!["omega"];
    let rejection =
        FrameRejection { object: "0".to_owned(), frame: 1, cause: RejectionCause::NoOutline("torn".to_owned()) };
    let warnings = [
        Warning::PointsOutOfOrder { frame: 1, perimeters: 9.0 },
        Warning::NotObservable { parameters: parameters(), contours: TracedContours::default() },
        Warning::NotKnown { parameters: parameters() },
        Warning::RotationNotObservable { parameters: parameters() },
        Warning::Lost { last_known: Some(1.0) },
        Warning::Reacquiring { last_known: 1.0 },
        Warning::Restarted { times: 1 },
        Warning::FramesRejected { rejected: 1, frames: 2 },
        Warning::RepeatedFrames { every: 6, rate: 30.0 },
        Warning::Ambiguous(Ambiguity { turn: -0.5, rival_turns: vec![0.25, 1.0], parameters: parameters() }),
        Warning::MotionChanged { dynamics: None },
        Warning::Diverged,
        Warning::StateLost { reason: "torn".to_owned() },
        Warning::FrameRejected(rejection),
        Warning::MoreFramesRejected { count: 1, frames: FrameRanges::from_iter([3]) },
        Warning::AmbiguousCorrespondence { ambiguous: 1, matched: 2 },
        Warning::MayNotHaveSettled { seconds: 1.0 },
        Warning::LinesNotFollowed { skipped: 1, intervals: 2 },
        Warning::AffineBias,
    ];
    let codes: BTreeSet<&str> = warnings.iter().map(Warning::code).collect();
    assert_eq!(codes.len(), warnings.len());
    assert!(codes.iter().all(|code| code.chars().all(|c| c.is_ascii_lowercase() || c == '_')), "{codes:?}");
    assert!(warnings.iter().all(|warning| !warning.to_string().is_empty() && !warning.to_string().contains('\n')));
    let ambiguous = "ambiguous: another turn explains the outlines equally well: -14.3 or -57.3 instead of 28.6 degrees from one \
                     frame to the next";
    assert_eq!(warnings[9].to_string(), ambiguous);
}

#[test]
fn settings_out_of_range_are_refused_before_any_frame() {
    let filter = FilterSettings { patience: 0, ..FilterSettings::default() };
    let refused =
        Tracker::new(TrackerSettings { method: MethodSettings::Filter(filter), ..TrackerSettings::default() });
    assert_eq!(refused.expect_err("no patience").to_string(), "patience of 0 is not at least 1");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn objects_do_not_know_of_each_other(order in prop::collection::vec(0_usize..3, 12..40)) {
        let shapes = [BuiltInShape::Bird, BuiltInShape::Van, BuiltInShape::Hat];
        let outlines = [0, 1, 2].map(|object| seen(shapes[object], &object.to_string(), 60, 40));
        let mut together = tracker(Method::Filter);
        let mut alone = [(); 3].map(|()| tracker(Method::Filter));
        let mut next = [0; 3];
        for object in order {
            let frame = &outlines[object][next[object]];
            next[object] += 1;
            prop_assert_eq!(together.push(frame), alone[object].push(frame));
        }
        for result in together.results() {
            let object: usize = result.object.parse().expect("a number");
            prop_assert_eq!(vec![result], alone[object].results());
        }
    }
}

#[test]
fn what_is_known_of_outlines_is_told_of_as_many_objects_as_are_asked_for() {
    let of_two: Vec<_> = ["first", "second"].map(|name| seen(BuiltInShape::Bird, name, 80, 6)).concat();
    for (objects, told) in [(0, vec![]), (1, vec!["first"]), (9, vec!["first", "second"])] {
        let mut tracker = tracker(Method::Filter).with_known_outlines(objects);
        let mut seen = BTreeSet::new();
        tracker.follow(of_two.clone(), |observation| {
            if let Some(known) = &observation.known_outline {
                let pose = observation.state.as_ref().map(freeform_motion::estimate::MotionState::pose);
                assert!(pose.is_none_or(|pose| (pose.matrix() - known.pose.matrix()).norm() < 1e-6));
                seen.insert(observation.object);
            }
        });
        assert_eq!(seen.into_iter().collect::<Vec<_>>(), told);
    }
    let mut adaptive = tracker(Method::Adaptive).with_known_outlines(9);
    assert!(of_two.iter().all(|frame| adaptive.push(frame).known_outline.is_none()));
}

/// Corners of a star in whole pixels, 120 pixels across, that turns and travels.
fn corners_in_pixels(motion: RigidMotion, frame: u64) -> OutlineFrame {
    let time = frame as f64 / 30.0;
    let pose = Rotation2::new(-motion.omega * time);
    let corner = |i: usize| {
        let radius = [60.0, 35.0, 48.0, 52.0, 30.0, 44.0, 58.0, 40.0, 50.0][i];
        let angle = std::f64::consts::TAU * i as f64 / 9.0;
        (pose * Point2::new(radius * angle.cos(), radius * angle.sin())).map(f64::round)
    };
    let outline = Outline::closed((0..9).map(corner).collect()).expect("an outline");
    OutlineFrame { frame, time, object: "star".to_owned(), outline }
}

#[test]
fn polygons_in_pixels_whose_corners_alone_are_given_tell_their_motion() {
    let motion = RigidMotion { omega: 0.8, b1: 0.0, b2: 0.0 };
    let mut tracker = tracker(Method::Filter);
    for frame in 0..60 {
        let _observation = tracker.push(&corners_in_pixels(motion, frame));
    }
    let results = tracker.results();
    let estimate = results[0].estimate.as_ref().expect("a motion");
    let omega = estimate.parameters().next().expect("omega");
    let (value, deviation) = (omega.value.expect("a value"), omega.standard_deviation.expect("a value"));
    assert!((value - 0.8).abs() < 3.0 * deviation && deviation < 0.1, "{value} +- {deviation}");
}
