//! First frames that are wrong, or show little.
use crate::filter_support::{filtered, frames_of, omega_of, settings};
use freeform_curve_fit::{OpenArc, OpenOutline, Outline};
use freeform_outline_filter::{FilterSettings, MotionFilter, Phase, Unstated, estimate_batch};
use freeform_riccati::{MotionModel, RigidMotion};
use freeform_sim_camera::{BuiltInShape, Frame};

const MOTION: RigidMotion = RigidMotion { omega: std::f64::consts::FRAC_PI_2, b1: -0.3, b2: 0.4 };

/// Frames of a shoe of which the first and the fourth show other things.
fn doubtful(seed: u64) -> Vec<Frame> {
    let mut frames = frames_of(BuiltInShape::Shoe, MOTION, settings(40, seed));
    let [van, glider] =
        [BuiltInShape::Van, BuiltInShape::Glider].map(|shape| frames_of(shape, MOTION, settings(4, seed)));
    frames[0].outline = van[0].outline.clone();
    frames[3].outline = glider[3].outline.clone();
    frames
}

#[test]
fn after_a_wrong_first_frame_another_wrong_one_begins_no_map_where_two_agree() {
    for seed in 0..4 {
        let frames = doubtful(seed);
        let run = filtered(MotionModel::Rigid, &frames);
        // The map is begun with the fifth.
        assert_eq!((run.restarts(), run.frames_rejected()), (1, 4), "seed {seed}");
        let (value, std) = omega_of(&run).expect("stated");
        assert!((value - MOTION.omega).abs() < 5.0 * std && std < 0.01, "seed {seed}: {value}, std {std}");
    }
}

/// Frames of a bird, which goes far from one to the next, of the first of which this share of the contour is seen, from the middle of it on.
fn seen_in_part_at_first(share: f64, seed: u64) -> Vec<Frame> {
    let mut frames = frames_of(BuiltInShape::Bird, RigidMotion { omega: 0.5, b1: 20.0, b2: 6.0 }, settings(30, seed));
    let points: Vec<_> = frames[0].outline.points().copied().collect();
    let count = (share * points.len() as f64) as usize;
    let seen = points.iter().cycle().skip(points.len() / 2).take(count).copied().collect();
    let arc = OpenArc::new(seen).expect("an arc");
    frames[0].outline = Outline::Open(OpenOutline::new(vec![arc]).expect("arcs"));
    frames
}

#[test]
fn a_frame_that_shows_the_whole_of_what_a_corner_was_seen_of_begins_the_map_anew_and_is_not_rejected() {
    for seed in 0..4 {
        let run = filtered(MotionModel::Rigid, &seen_in_part_at_first(0.04, seed));
        assert_eq!((run.restarts(), run.frames_rejected(), run.frames_accepted()), (0, 0, 30), "seed {seed}");
        assert_eq!(run.segment(), 1, "seed {seed}");
        let (value, std) = omega_of(&run).expect("stated");
        assert!((value - 0.5).abs() < 5.0 * std && std < 0.02, "seed {seed}: {value}, std {std}");
    }
}

#[test]
#[cfg(feature = "serde")]
fn a_filter_saved_after_a_corner_goes_on_to_the_last_bit() {
    let mut straight = MotionFilter::new(FilterSettings::default()).expect("settings");
    let mut restored = straight.clone();
    for frame in seen_in_part_at_first(0.04, 5).into_iter().take(8) {
        let steps = [&mut straight, &mut restored].map(|filter| filter.step(frame.time, &frame.outline).ok());
        assert_eq!(steps[0], steps[1]);
        restored = MotionFilter::from_bytes(&restored.to_bytes().expect("memory")).expect("a saved state");
    }
    assert_eq!((straight.segment(), straight.to_bytes()), (1, restored.to_bytes()));
}

#[test]
fn most_of_the_object_is_found_on_the_whole_and_poses_go_back_to_it() {
    for seed in 0..4 {
        let run = filtered(MotionModel::Rigid, &seen_in_part_at_first(0.8, seed));
        assert_eq!((run.segment(), run.frames_rejected()), (0, 0), "seed {seed}");
    }
}

#[test]
fn all_frames_together_are_those_after_the_wrong_ones() {
    let frames: Vec<_> = doubtful(1).into_iter().map(|frame| (frame.time, frame.outline)).collect();
    let found = estimate_batch(MotionModel::Rigid, &frames).expect("a motion");
    assert_eq!((found.frames_used, found.converged), (36, true));
    assert!(found.rounds > 1);
}

#[test]
#[cfg(feature = "serde")]
fn a_filter_saved_between_the_first_frames_goes_on_to_the_last_bit() {
    let mut straight = MotionFilter::new(FilterSettings::default()).expect("settings");
    let mut restored = straight.clone();
    for frame in doubtful(2) {
        restored = MotionFilter::from_bytes(&restored.to_bytes().expect("memory")).expect("a saved state");
        let steps = [&mut straight, &mut restored].map(|filter| filter.step(frame.time, &frame.outline).ok());
        assert_eq!(steps[0], steps[1]);
        assert_eq!(straight.estimate(), restored.estimate());
    }
    assert_eq!(straight.to_bytes(), restored.to_bytes());
}

#[test]
fn one_frame_that_agrees_with_the_first_against_two_states_no_motion_and_another_does() {
    let mut frames = frames_of(BuiltInShape::Bird, MOTION, settings(5, 5));
    let others = frames_of(BuiltInShape::Van, MOTION, settings(5, 5));
    (1..3).for_each(|index| frames[index].outline = others[index].outline.clone());
    let four = filtered(MotionModel::Rigid, &frames[..4]);
    assert_eq!(four.phase(), Phase::Tracking);
    assert_eq!(four.unstated(), Some(Unstated::ManyRejected { rejected: 2, frames: 4 }));
    assert!(four.estimate().expect("an estimate").parameters().all(|parameter| parameter.value.is_none()));
    let five = filtered(MotionModel::Rigid, &frames);
    assert_eq!(five.unstated(), None);
    assert!(five.estimate().expect("an estimate").parameters().all(|parameter| parameter.value.is_some()));
}

/// Frames of seven shapes in turn, so that no frame shows what one of the six before it does.
fn in_turn(count: usize) -> Vec<Frame> {
    use BuiltInShape::{Bird, Boomerang, Glider, Hat, Plane, Shoe, Van};
    let shapes =
        [Bird, Boomerang, Glider, Hat, Plane, Shoe, Van].map(|shape| frames_of(shape, MOTION, settings(count, 3)));
    (0..count).map(|i| shapes[i % shapes.len()][i].clone()).collect()
}

#[test]
#[cfg(feature = "serde")]
fn a_filter_saved_while_frames_are_not_searched_goes_on_to_the_last_bit() {
    let mut straight = MotionFilter::new(FilterSettings::default()).expect("settings");
    for frame in in_turn(120) {
        let mut restored = MotionFilter::from_bytes(&straight.to_bytes().expect("memory")).expect("a saved state");
        let steps = [&mut straight, &mut restored].map(|filter| filter.step(frame.time, &frame.outline).ok());
        assert_eq!(steps[0], steps[1]);
        assert_eq!(straight.to_bytes(), restored.to_bytes());
    }
}

#[test]
fn an_object_that_comes_after_many_others_is_found_within_two_seconds_of_video() {
    const BEFORE: usize = 200;
    let frames = frames_of(BuiltInShape::Vase, MOTION, settings(BEFORE + 60, 4));
    let frames: Vec<_> = in_turn(BEFORE).into_iter().chain(frames[BEFORE..].iter().cloned()).collect();
    let mut filter = MotionFilter::new(FilterSettings::default()).expect("settings");
    let found = frames.iter().position(|frame| {
        filter.step(frame.time, &frame.outline).expect("increasing times");
        filter.phase() == Phase::Tracking && filter.velocity().is_some()
    });
    assert!(found.is_some_and(|index| (BEFORE..BEFORE + 55).contains(&index)), "{found:?}");
    assert!(filter.velocity().is_some());
}

#[test]
fn of_frames_that_show_another_object_each_time_few_are_searched_for_long() {
    let mut filter = MotionFilter::new(FilterSettings::default()).expect("settings");
    let steps =
        in_turn(400).into_iter().map(|frame| filter.step(frame.time, &frame.outline).expect("increasing times"));
    // A frame that is searched is measured.
    let searched: Vec<_> = steps.map(|step| step.measurement.is_some()).collect();
    let share = |frames: &[bool]| frames.iter().filter(|searched| **searched).count() as f64 / frames.len() as f64;
    assert!(share(&searched[..50]) > 0.9, "{}", share(&searched[..50]));
    assert!(share(&searched[100..]) < 0.1, "{}", share(&searched[100..]));
}
