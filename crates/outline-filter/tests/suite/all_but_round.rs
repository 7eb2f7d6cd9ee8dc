//! Poses of bodies that are round but for a mark, whose turn few of the points tell.
use std::f64::consts::{PI, TAU};

use freeform_curve_fit::Outline;
use freeform_estimate::PoseParameter;
use freeform_riccati::MotionModel;
use nalgebra::{Point2, Vector2};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use crate::{
    filter_support::filter,
    gaps::{points_on, ring_with_gap},
};

const FRAMES: u32 = 40;
const FRAME_RATE: f64 = 15.0;

/// Points of a circle from one angle to another.
fn arc(from: f64, to: f64) -> impl Iterator<Item = Point2<f64>> {
    (0..=400).map(move |i| from + (to - from) * f64::from(i) / 400.0).map(|t| Point2::new(t.cos(), t.sin()))
}

/// A shaft with a flat of so many radians.
fn shaft_with_flat(angle: f64) -> Vec<Point2<f64>> {
    arc(0.5 * angle, TAU - 0.5 * angle).collect()
}

/// A disc with a slot so wide and deep.
fn disc_with_slot(width: f64, depth: f64) -> Vec<Point2<f64>> {
    let half = (0.5 * width).asin();
    let bottom = [-0.5, 0.5].map(|side| Point2::new(1.0 - depth, side * width));
    arc(half, TAU - half).chain(bottom).collect()
}

/// What is stated of the angle of a body.
#[derive(Debug, Default, Clone, Copy)]
struct Angles {
    /// Within six deviations.
    right: u32,
    wrong: u32,
    /// Of these in the last quarter.
    right_late: u32,
}

/// Angles stated of a body that slows down as it turns and travels, since the beginning of each segment.
fn angles_of(body: &[Point2<f64>], points: u32, random: &mut ChaCha8Rng) -> Angles {
    let (rate, slowing) = (random.random_range(-4.0..4.0), random.random_range(0.5..2.0));
    let turn = |time: f64| rate * (1.0 - f64::exp(-slowing * time)) / slowing;
    let mut run = filter(MotionModel::Rigid);
    let (mut segment, mut beginning, mut angles) = (0, Some(0.0), Angles::default());
    for frame in 0..FRAMES {
        let time = f64::from(frame) / FRAME_RATE;
        let pose = (turn(time), Vector2::new(0.4, -0.3) * time);
        run.step(time, &Outline::closed(points_on(body, points, pose, random)).expect("an outline")).expect("a time");
        if run.segment() != segment {
            (segment, beginning) = (run.segment(), None);
        }
        let told = |angle: &PoseParameter| angle.value.is_finite() && angle.standard_deviation < 0.5;
        let stated = run.state().map(|state| state.pose_parameters()[0]).filter(told);
        let Some(angle) = stated else { continue };
        // Clockwise.
        let error = angle.value + turn(time);
        let error = (error - *beginning.get_or_insert(error) + PI).rem_euclid(TAU) - PI;
        if error.abs() > 6.0 * angle.standard_deviation {
            angles.wrong += 1;
        } else {
            angles.right += 1;
            angles.right_late += u32::from(frame >= FRAMES / 4 * 3);
        }
    }
    angles
}

/// Of 874 angles 143 were off before frames were asked; the others that were stated then are left out in the first frames, or for good.
#[test]
fn angles_of_bodies_that_are_round_but_for_a_mark_are_told_by_frames_before_they_are_stated() {
    let mut all = Angles::default();
    for seed in 0..36 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let share = random.random::<f64>();
        for body in [
            ring_with_gap(0.12 + 0.4 * share),
            shaft_with_flat(0.5 + 0.7 * share),
            disc_with_slot(0.05 + 0.1 * share, 0.3 + 0.5 * share),
        ] {
            let Angles { right, wrong, right_late } = angles_of(&body, 120, &mut random);
            (all.right, all.wrong, all.right_late) =
                (all.right + right, all.wrong + wrong, all.right_late + right_late);
        }
    }
    // Which are off depends on chance, as the few points that tell the turn do.
    assert!(all.wrong * 100 <= all.right, "{all:?}");
    // Nor is it left out where it is known.
    assert!(all.right > 2000 && all.right_late > 650, "{all:?}");
}
