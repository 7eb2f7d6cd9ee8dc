//! Until when an object that is lost was followed, and why a velocity of the middle is not stated.
use freeform_motion::curve_fit::{OpenArc, OpenOutline, Outline};
use freeform_motion::outline_filter::FilterSettings;
use freeform_motion::outline_io::OutlineFrame;
use freeform_motion::riccati::{MotionModel, PinholeCamera, PlaneMotion};
use freeform_motion::sim_camera::{BuiltInShape, Scene, SequenceLength, Settings, Simulator};
use freeform_motion::tracker::{Method, MethodSettings, NotStated, ObjectPhase};
use freeform_motion::{Tracker, TrackerSettings, Warning};
use nalgebra::Point2;

use crate::tracker::{egg, tracker};

/// A flower with another number of petals in each frame.
fn another_flower(frame: u64, time: f64) -> OutlineFrame {
    let petals = (3 + 5 * frame % 41) as f64;
    let points = (0..400).map(|i| {
        let t = std::f64::consts::TAU * f64::from(i) / 400.0;
        (1.0 + 0.3 * (petals * t).cos()) * Point2::new(t.cos(), t.sin())
    });
    OutlineFrame {
        frame,
        time,
        object: "egg".to_owned(),
        outline: Outline::closed(points.collect()).expect("a flower"),
    }
}

/// The time of the warning that the object is lost; fails where there is no such warning.
fn last_known(tracker: &Tracker) -> Option<f64> {
    let result = &tracker.results()[0];
    let lost = result.warnings.iter().find_map(|warning| match warning {
        Warning::Lost { last_known } => Some(*last_known),
        _ => None,
    });
    lost.unwrap_or_else(|| panic!("not lost: {:?}", result.warnings))
}

#[test]
fn a_lost_object_was_followed_until_the_last_frame_that_was_used() {
    let mut followed = tracker(Method::Filter);
    let mut last_used = None;
    let begin = 1_764_249_600.0;
    for frame in 0..40 {
        let time = begin + 0.1 * frame as f64;
        let seen =
            if frame < 20 { egg(frame, 0.05 * frame as f64, 0.02 * frame as f64) } else { another_flower(frame, 0.0) };
        let observation = followed.push(&OutlineFrame { time, ..seen });
        if observation.is_accepted() {
            last_used = Some(time);
        }
    }
    assert_eq!(last_used, Some(begin + 1.9));
    assert_eq!(last_known(&followed), last_used);
    let messages = followed.results()[0].warnings.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n");
    assert!(messages.contains("it was followed until 1764249601.9 s"), "{messages}");
}

#[test]
fn of_an_object_that_no_two_frames_show_no_time_is_told_until_which_it_was_followed() {
    let mut followed = tracker(Method::Filter);
    for frame in 0..8 {
        let observation = followed.push(&another_flower(frame, 0.1 * frame as f64));
        assert_eq!((observation.phase, observation.is_accepted()), (Some(ObjectPhase::Acquiring), frame == 0));
    }
    let warnings = &followed.results()[0].warnings;
    let has_time =
        |warning: &Warning| matches!(warning, Warning::Lost { last_known: Some(_) } | Warning::Reacquiring { .. });
    assert!(!warnings.is_empty() && !warnings.iter().any(has_time), "{warnings:?}");
}

/// Both sides of a straight bar whose ends are not seen.
fn bar(frame: u64) -> OutlineFrame {
    let side = |height: f64| {
        let wave = |i: u32| 1e-3 * (f64::from(i * i) + height * 100.0 + 31.0 * frame as f64).sin();
        let point = |i: u32| Point2::new(0.03 * (f64::from(i) + (0.7 * frame as f64).fract()), height + wave(i));
        OpenArc::new((0..100).map(point).collect()).expect("an arc")
    };
    let outline = Outline::Open(OpenOutline::new(vec![side(0.0), side(0.3)]).expect("arcs"));
    OutlineFrame { frame, time: 0.1 * frame as f64, object: "bar".to_owned(), outline }
}

#[test]
fn a_velocity_that_the_outline_does_not_show_is_unobservable_and_one_that_is_not_known_is_unknown() {
    let settings = TrackerSettings::new(Method::Filter, MotionModel::Rigid);
    let mut of_bar = Tracker::new(settings.clone()).expect("settings");
    let observations: Vec<_> = (0..12).map(|frame| of_bar.push(&bar(frame))).collect();
    let result = &of_bar.results()[0];
    assert!(result.hides_velocity && result.velocity.is_none());
    assert_eq!(result.velocity_not_stated(), Some(NotStated::Unobservable));
    assert_eq!(observations[11].velocity_not_stated(), Some(NotStated::Unobservable));
    let is_told = |warning: &Warning| matches!(warning, Warning::NotObservable { parameters, .. } if parameters.ends_with(&["v1", "v2"]));
    assert!(result.warnings.iter().any(is_told), "{:?}", result.warnings);
    let mut of_egg = Tracker::new(settings).expect("settings");
    of_egg.push(&egg(0, 0.0, 0.0));
    assert_eq!(of_egg.results()[0].velocity_not_stated(), Some(NotStated::Unknown));
    (1..12).for_each(|frame| drop(of_egg.push(&egg(frame, 0.05 * frame as f64, 0.02 * frame as f64))));
    assert_eq!(of_egg.results()[0].velocity_not_stated(), None);
}

#[test]
fn of_a_plane_that_is_lost_nothing_is_stated_but_until_when_it_was_followed() {
    let camera = PinholeCamera::new(900.0, Point2::new(320.0, 240.0)).expect("a camera");
    let motion = PlaneMotion::of_parameters([0.12, -0.08, 0.5, 0.1, 0.05, 0.12, 0.46, 0.35]);
    let scene = Scene::in_space(BuiltInShape::Bird, motion, camera, 300.0);
    let length = SequenceLength::Frames(40);
    let simulated =
        Simulator::new(scene, Settings { length, noise: 0.3, ..Settings::default() }).expect("a plane that is seen");
    let settings = FilterSettings { model: MotionModel::Projective, ..FilterSettings::default() };
    let method = MethodSettings::Plane(camera, settings);
    let mut followed = Tracker::new(TrackerSettings { method, ..TrackerSettings::default() }).expect("settings");
    let mut last_used = None;
    for (frame, seen) in (0..).zip(simulated.frames()) {
        let outline = if frame < 30 { seen.outline } else { another_flower(frame, 0.0).outline };
        let observation = followed.push(&OutlineFrame { frame, time: seen.time, object: "plane".to_owned(), outline });
        if observation.is_accepted() {
            last_used = Some(seen.time);
        }
        if frame == 29 {
            assert!(followed.results()[0].parameters().expect("a motion").iter().all(|p| p.value.is_some()));
        }
    }
    assert_eq!(last_known(&followed), last_used);
    assert!(followed.results()[0].parameters().expect("a motion").iter().all(|p| p.value.is_none()));
}
