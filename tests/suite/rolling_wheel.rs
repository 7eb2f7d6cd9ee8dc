//! A wheel that rolls on level ground: its axle goes straight on at one velocity, while the velocity at the origin swings.
use std::f64::consts::TAU;

use freeform_motion::curve_fit::{ClosedOutline, Outline};
use freeform_motion::outline_filter::Dynamics;
use freeform_motion::outline_io::OutlineFrame;
use freeform_motion::{Tracker, TrackerSettings, Warning};
use nalgebra::{Point2, Rotation2, Vector2};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

const FRAME_RATE: f64 = 30.0;
/// Velocity of the axle, in lengths per second, and radius of the wheel: it rolls clockwise, without slipping.
const SPEED: f64 = 1.2;
const RADIUS: f64 = 0.5;
/// Of the points, about a hundredth of the radius.
const NOISE: f64 = 0.005;
/// Where the axle is in the first frame.
const START: [f64; 2] = [2.0, RADIUS];

/// The wheel in a frame: its rim, and two marks of different sizes on it.
fn wheel(frame: u64, random: &mut ChaCha8Rng) -> OutlineFrame {
    let time = frame as f64 / FRAME_RATE;
    let (axle, turn) = (Vector2::new(START[0] + SPEED * time, START[1]), Rotation2::new(-SPEED / RADIUS * time));
    let mut noise = || NOISE * 3.0_f64.sqrt() * random.random_range(-1.0..1.0_f64);
    let mut circle = |[x, y]: [f64; 2], radius: f64, count: u32| -> Vec<Point2<f64>> {
        let on_wheel = |i: u32| {
            let (sin, cos) = (TAU * f64::from(i) / f64::from(count)).sin_cos();
            turn * Vector2::new(x + radius * cos, y + radius * sin) + axle
        };
        let seen = |i| Point2::from(on_wheel(i) + Vector2::new(noise(), noise()));
        (0..count).map(seen).collect()
    };
    let rim = circle([0.0, 0.0], RADIUS, 160);
    let marks = vec![circle([0.28, 0.05], 0.12, 50), circle([-0.2, -0.22], 0.07, 40)];
    let outline = ClosedOutline::new(rim).and_then(|rim| rim.with_inner(marks)).expect("an outline");
    OutlineFrame { frame, time, object: "wheel".to_owned(), outline: Outline::Closed(outline) }
}

#[test]
fn of_a_wheel_that_rolls_the_velocity_of_the_axle_is_constant_and_within_its_deviations_and_so_is_its_turn() {
    let (mut random, mut worst) = (ChaCha8Rng::seed_from_u64(3), [0.0_f64; 3]);
    let mut tracker = Tracker::new(TrackerSettings::default()).expect("settings");
    // It makes more than a turn.
    for frame in 0..90 {
        let observation = tracker.push(&wheel(frame, &mut random));
        assert!(observation.is_accepted(), "{frame}: {:?}", observation.rejection);
        // The first ten frames of a motion that changes are not to be relied on.
        if frame < 10 {
            continue;
        }
        let state = observation.present_state().expect("a state");
        let axle = state.velocity_of(&Point2::from(START));
        let deviations = axle.standard_deviations();
        let off = (axle.velocity - Vector2::new(SPEED, 0.0)).component_div(&deviations);
        assert!(deviations.amax() < 0.05 * SPEED, "{frame}: {deviations}");
        // Clockwise is positive. What is stated is of a point of the wheel near the axle, which goes round that.
        let motion: Vec<_> = observation.parameters().expect("a motion");
        let (omega, deviation) =
            motion[0].value.zip(motion[0].standard_deviation).expect("the marks show how it turns");
        let stated = observation.velocity.expect("a velocity");
        let from_axle = stated.point - Point2::new(START[0] + SPEED * frame as f64 / FRAME_RATE, START[1]);
        let truth = Vector2::new(SPEED, 0.0) + SPEED / RADIUS * Vector2::new(from_axle.y, -from_axle.x);
        let of_stated = (stated.velocity - truth).component_div(&stated.standard_deviations());
        let errors = [off.amax(), (omega - SPEED / RADIUS).abs() / deviation, of_stated.amax()];
        worst.iter_mut().zip(errors).for_each(|(worst, error)| *worst = worst.max(error));
    }
    assert!(worst.iter().all(|error| *error < 4.0), "{worst:?} standard deviations");
    let result = &tracker.results()[0];
    // b changes, and the reason is told: the middle goes its own way.
    let changes = Warning::MotionChanged { dynamics: Some(Dynamics::Velocity) };
    assert!(result.warnings.contains(&changes), "{:?}", result.warnings);
}
