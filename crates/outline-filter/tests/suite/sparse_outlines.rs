//! Outlines of a dozen points a frame.
use freeform_curve_fit::Outline;
use freeform_outline_filter::MotionFilter;
use freeform_riccati::MotionModel;
use nalgebra::{Point2, Rotation2, Vector2};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

use crate::filter_support::filter;

const NOISE: f64 = 0.004;
const FRAMES: u32 = 40;

/// Of a body of radius 1 with lobes of a tenth or so, or of a circle.
fn radius(lobes: f64, angle: f64) -> f64 {
    1.0 + lobes * ((2.0 * angle + 0.3).cos() + 0.7 * (3.0 * angle).sin() + 0.3 * (5.0 * angle + 1.0).cos())
}

/// Of a frame, 30 a second, of a body that turns about a point that moves: one point anywhere in each twelfth of it.
fn seen(frame: u32, (lobes, omega): (f64, f64), random: &mut ChaCha8Rng) -> (f64, Outline) {
    let time = f64::from(frame) / 30.0;
    let (turn, place) = (Rotation2::new(-omega * time), time * Vector2::new(0.7, -0.4));
    let mut point = |i: u8| {
        let angle = std::f64::consts::TAU * (f64::from(i) + random.random::<f64>()) / 12.0;
        let noise = Vector2::from_fn(|_, _| NOISE * random.sample::<f64, _>(StandardNormal));
        turn * Point2::from(radius(lobes, angle) * Vector2::new(angle.cos(), angle.sin())) + place + noise
    };
    (time, Outline::closed((0..12).map(&mut point).collect()).expect("an outline"))
}

/// The angular velocity that is stated at the end, with its deviation.
fn omega_told(run: &MotionFilter) -> Option<(f64, f64)> {
    let omega = run.estimate()?.parameters().next()?;
    omega.value.zip(omega.standard_deviation)
}

/// A map of twelve chords is off by more than lobes of a tenth turn by: the turn of none of these was told.
#[test]
fn a_dozen_points_a_frame_tell_the_turn_once_several_frames_are_aligned_together() {
    let mut told = 0;
    for seed in 0..16 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let omega = random.random_range(-2.0..2.0);
        let mut run = filter(MotionModel::Rigid);
        for frame in 0..FRAMES {
            let (time, outline) = seen(frame, (0.1, omega), &mut random);
            run.step(time, &outline).expect("an outline");
            let Some(state) = run.state().filter(|_| frame >= 20) else { continue };
            let angle = state.pose_parameters()[0];
            let off = Rotation2::new(angle.value - omega * time).angle() / angle.standard_deviation;
            assert!(off.is_nan() || off.abs() < 4.5, "seed {seed}, frame {frame}: {off}");
        }
        let Some((value, deviation)) = omega_told(&run) else { continue };
        assert!((value - omega).abs() < 4.0 * deviation, "seed {seed}: {value} for {omega}, {deviation}");
        told += usize::from(deviation < 0.02);
    }
    println!("told in {told} of 16");
    assert!(told >= 12, "{told}");
}

#[test]
fn a_dozen_points_a_frame_of_a_circle_tell_no_turn() {
    for seed in 0..8 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut run = filter(MotionModel::Rigid);
        for frame in 0..FRAMES {
            let (time, outline) = seen(frame, (0.0, 1.5), &mut random);
            run.step(time, &outline).expect("an outline");
        }
        assert_eq!(omega_told(&run), None, "{seed}");
    }
}

#[cfg(feature = "serde")]
#[test]
fn frames_that_wait_to_be_aligned_are_saved_with_the_state() {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let frames: Vec<(f64, Outline)> = (0..FRAMES).map(|frame| seen(frame, (0.1, 1.2), &mut random)).collect();
    let mut whole = filter(MotionModel::Rigid);
    let mut interrupted = filter(MotionModel::Rigid);
    for (number, (time, outline)) in frames.iter().enumerate() {
        whole.step(*time, outline).expect("an outline");
        interrupted.step(*time, outline).expect("an outline");
        if number == 4 {
            interrupted = MotionFilter::from_bytes(&interrupted.to_bytes().expect("memory")).expect("its own state");
        }
    }
    assert!(omega_told(&whole).is_some());
    assert_eq!(omega_told(&whole), omega_told(&interrupted));
}
