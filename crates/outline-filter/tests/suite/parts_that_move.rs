//! Outlines of which a part does not move with the rest.
use freeform_curve_fit::Outline;
use freeform_riccati::MotionModel;
use nalgebra::{Point2, Rotation2, Vector2};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use crate::{filter_support::filter, gaps::points_on};

/// A stand at rest with an arm that has swung by an angle, seen as one.
fn stand_with_arm(angle: f64) -> Vec<Point2<f64>> {
    let arm = [(-0.15, 0.0), (-0.15, -1.2), (0.15, -1.2), (0.15, 0.0)].map(|(x, y)| Point2::new(x, y));
    let turned = arm.map(|p| Rotation2::new(angle) * p);
    let stand = [(1.0, 0.2), (1.0, 1.6), (-1.0, 1.6), (-1.0, 0.2)].map(|(x, y)| Point2::new(x, y));
    stand.into_iter().chain(turned).collect()
}

#[test]
fn an_arm_that_swings_on_a_stand_is_told_to_be_a_part_that_does_not_move_with_the_rest() {
    let (mut told, mut states) = (0, 0);
    for seed in 0..12 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut run = filter(MotionModel::Rigid);
        for frame in 0..40 {
            let time = f64::from(frame) / 30.0;
            let points =
                points_on(&stand_with_arm(1.2 * (9.0 * time).sin()), 200, (0.0, Vector2::zeros()), &mut random);
            run.step(time, &Outline::closed(points).expect("an outline")).expect("increasing times");
        }
        // The stand rests. An arm that is taken for the object may have no motion that is known.
        let omega = run.estimate().and_then(|estimate| estimate.parameters().next());
        let stated = omega.and_then(|omega| omega.value.zip(omega.standard_deviation));
        assert!(stated.is_none_or(|(value, std)| value.abs() < 4.0 * std), "seed {seed}: {stated:?}");
        states += u32::from(stated.is_some());
        let share = run.disagreeing_part();
        assert!(share.is_none_or(|share| (0.08..0.4).contains(&share)), "seed {seed}: {share:?}");
        told += u32::from(share.is_some());
    }
    // 35 of 80 state a motion, and 33 did before.
    assert!(states >= 2, "{states} of 12");
    // 25 of 40 tell it, and 20 did before poses were judged by the best estimate of how far errors go together.
    assert!(told >= 6, "{told} of 12");
}

#[test]
fn outliers_here_and_there_are_no_part_of_the_outline() {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let mut run = filter(MotionModel::Rigid);
    for frame in 0..40 {
        let time = f64::from(frame) / 30.0;
        let mut points = points_on(&stand_with_arm(0.3), 200, (0.4 * time, Vector2::new(0.5, 0.2) * time), &mut random);
        for point in &mut points {
            if random.random::<f64>() < 0.2 {
                *point += Vector2::new(random.random_range(-0.5..0.5), random.random_range(-0.5..0.5));
            }
        }
        run.step(time, &Outline::closed(points).expect("an outline")).expect("increasing times");
    }
    assert!(run.frames_accepted() > 30);
    assert_eq!(run.disagreeing_part(), None);
}
