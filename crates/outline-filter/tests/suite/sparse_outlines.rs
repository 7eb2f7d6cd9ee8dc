//! Outlines of a dozen points a frame.
use freeform_curve_fit::Outline;
use freeform_outline_filter::MotionFilter;
use freeform_riccati::MotionModel;
use nalgebra::{Point2, Rotation2, Vector2};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

use crate::filter_support::{filter, omega_of};

const NOISE: f64 = 0.004;
const FRAMES: u32 = 40;

/// Of a body of radius 1 with lobes of a tenth or so, or of a circle.
fn radius(lobes: f64, angle: f64) -> f64 {
    1.0 + lobes * ((2.0 * angle + 0.3).cos() + 0.7 * (3.0 * angle).sin() + 0.3 * (5.0 * angle + 1.0).cos())
}

/// Of a frame, 30 a second, of a body, given by its radius, that turns about a point that moves: one point anywhere in each twelfth of it.
fn seen(
    frame: u32,
    (body, turned): (impl Fn(f64) -> f64, impl Fn(f64) -> f64),
    random: &mut ChaCha8Rng,
) -> (f64, Outline) {
    let time = f64::from(frame) / 30.0;
    let (turn, place) = (Rotation2::new(-turned(time)), time * Vector2::new(0.7, -0.4));
    let mut point = |i: u8| {
        let angle = std::f64::consts::TAU * (f64::from(i) + random.random::<f64>()) / 12.0;
        let noise = Vector2::from_fn(|_, _| NOISE * random.sample::<f64, _>(StandardNormal));
        turn * Point2::from(body(angle) * Vector2::new(angle.cos(), angle.sin())) + place + noise
    };
    (time, Outline::closed((0..12).map(&mut point).collect()).expect("an outline"))
}

/// A map of twelve chords is off by more than lobes of a tenth turn by: the turn of none of these was told.
#[test]
fn a_dozen_points_a_frame_tell_the_turn_once_several_frames_are_aligned_together() {
    let (mut told, mut angles) = (0, 0);
    for seed in 0..16 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let omega = random.random_range(-2.0..2.0);
        let mut run = filter(MotionModel::Rigid);
        for frame in 0..FRAMES {
            let (time, outline) = seen(frame, (|angle| radius(0.1, angle), |time| omega * time), &mut random);
            run.step(time, &outline).expect("an outline");
            let Some(state) = run.state().filter(|_| frame >= 20) else { continue };
            let angle = state.pose_parameters()[0];
            // Before the turn is told no angle is stated.
            if angle.value.is_finite() {
                let off = Rotation2::new(angle.value - omega * time).angle() / angle.standard_deviation;
                assert!(off.abs() < 4.5, "seed {seed}, frame {frame}: {off}");
                angles += 1;
            }
        }
        let Some((value, deviation)) = omega_of(&run) else { continue };
        assert!((value - omega).abs() < 4.0 * deviation, "seed {seed}: {value} for {omega}, {deviation}");
        told += usize::from(deviation < 0.02);
    }
    println!("told in {told} of 16, {angles} angles");
    assert!(told >= 14 && angles >= 14 * (FRAMES - 20), "{told} {angles}");
}

#[test]
fn a_dozen_points_a_frame_of_a_circle_tell_no_turn() {
    for seed in 0..8 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut run = filter(MotionModel::Rigid);
        for frame in 0..FRAMES {
            let (time, outline) = seen(frame, (|_| 1.0, |time| 1.5 * time), &mut random);
            run.step(time, &outline).expect("an outline");
        }
        assert_eq!(omega_of(&run), None, "{seed}");
    }
}

/// Faster turns by a part of the whole explain the frames as well.
#[test]
fn a_dozen_points_a_frame_of_a_symmetric_body_state_no_turn_that_another_explains_as_well() {
    for (lobes, omega) in [(2.0, 2.9 * 30.0), (3.0, 1.9 * 30.0), (4.0, 1.4 * 30.0), (3.0, 1.5), (6.0, 0.8 * 30.0)] {
        for seed in 0..3 {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            let mut run = filter(MotionModel::Rigid);
            for frame in 0..FRAMES {
                let body = |angle: f64| 1.0 + 0.15 * (lobes * angle).cos();
                let (time, outline) = seen(frame, (body, |time| omega * time), &mut random);
                run.step(time, &outline).expect("an outline");
            }
            let right = omega_of(&run).is_none_or(|(value, deviation)| (value - omega).abs() < 4.0 * deviation);
            assert!(right || !run.aliases().is_empty(), "{lobes} lobes, {omega}: {:?}", omega_of(&run));
        }
    }
}

/// The pixels stay where they are, and so do the errors of points that are rounded to them.
#[test]
fn a_small_disc_of_pixels_that_turns_is_not_said_to_rest() {
    for (radius, speed) in [(4.6_f64, 0.02), (5.2, 0.1), (5.7, 0.5)] {
        let mut run = filter(MotionModel::Rigid);
        for frame in 0..FRAMES {
            let points: Vec<Point2<f64>> = (0..20)
                .map(|i| std::f64::consts::TAU * f64::from(i) / 20.0)
                .map(|angle| {
                    Point2::new(20.0 + speed * f64::from(frame) + radius * angle.cos(), 20.0 + radius * angle.sin())
                })
                .map(|p| p.map(f64::round))
                .collect();
            run.step(f64::from(frame) / 30.0, &Outline::closed(points).expect("an outline")).expect("an outline");
        }
        assert_eq!(omega_of(&run), None, "{radius} {speed}");
    }
}

#[test]
fn a_dozen_points_a_frame_of_a_body_whose_spin_changes_are_right_or_unstated() {
    let turns: [fn(f64) -> f64; 3] = [|t| 2.0 * t * t, |t| 1.5 * t + t * t, |t| 3.0 * t.min(0.2)];
    for (number, turn) in turns.into_iter().enumerate() {
        for seed in 0..4 {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            let mut run = filter(MotionModel::Rigid);
            for frame in 0..FRAMES {
                let (time, outline) = seen(frame, (|angle| radius(0.1, angle), turn), &mut random);
                run.step(time, &outline).expect("an outline");
                let Some((value, deviation)) = omega_of(&run).filter(|_| frame >= 12) else { continue };
                let omega = (turn(time + 1e-4) - turn(time - 1e-4)) / 2e-4;
                let off = (value - omega) / deviation;
                assert!(off.abs() < 4.5, "{number}, seed {seed}, frame {frame}: {off}");
            }
        }
    }
}

#[cfg(feature = "serde")]
#[test]
fn frames_that_wait_to_be_aligned_are_saved_with_the_state() {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let frames: Vec<(f64, Outline)> =
        (0..FRAMES).map(|frame| seen(frame, (|angle| radius(0.1, angle), |time| 1.2 * time), &mut random)).collect();
    let mut whole = filter(MotionModel::Rigid);
    let mut interrupted = filter(MotionModel::Rigid);
    for (number, (time, outline)) in frames.iter().enumerate() {
        whole.step(*time, outline).expect("an outline");
        interrupted.step(*time, outline).expect("an outline");
        if [4, 9].contains(&number) {
            interrupted = MotionFilter::from_bytes(&interrupted.to_bytes().expect("memory")).expect("its own state");
        }
    }
    assert!(omega_of(&whole).is_some());
    assert_eq!(omega_of(&whole), omega_of(&interrupted));
}
