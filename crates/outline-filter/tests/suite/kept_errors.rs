//! Outlines whose errors stay for some frames, as those of segmented pictures do.
use freeform_curve_fit::Outline;
use freeform_riccati::MotionModel;
use nalgebra::{Point2, Rotation2, Vector2};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

use crate::filter_support::filter;

const FRAMES: u8 = 90;
const FRAMES_PER_SECOND: f64 = 30.0;
const POINTS: u16 = 300;
/// Of the error of a point across the contour, in a body of diameter 2.
const DEVIATION: f64 = 0.01;
/// What of it is kept from frame to frame.
const KEPT: f64 = 0.5;

/// A body with bends, by a share of its contour; its points are the same in all frames.
fn body(point: u16) -> Point2<f64> {
    let angle = std::f64::consts::TAU * f64::from(point) / f64::from(POINTS);
    let radius = 1.0 + 0.25 * (2.0 * angle).cos() + 0.15 * (3.0 * angle + 1.0).sin() + 0.1 * (5.0 * angle).cos();
    Point2::from(radius * Vector2::new(angle.cos(), angle.sin()))
}

/// Rate of growth of a body that turns at 1 rad/s and keeps its size, with its standard deviation.
fn growth(seed: u64) -> (f64, f64) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut normal = || -> f64 { random.sample(StandardNormal) };
    let mut errors: Vec<f64> = (0..POINTS).map(|_| normal()).collect();
    let mut run = filter(MotionModel::Similarity);
    for frame in 0..FRAMES {
        let time = f64::from(frame) / FRAMES_PER_SECOND;
        let pose = Rotation2::new(-time);
        let point = |point: u16| {
            let tangent = body((point + 1) % POINTS) - body((point + POINTS - 1) % POINTS);
            let normal = Vector2::new(tangent.y, -tangent.x).normalize();
            pose * (body(point) + DEVIATION * errors[usize::from(point)] * normal)
        };
        run.step(time, &Outline::closed((0..POINTS).map(point).collect()).expect("an outline")).expect("a later time");
        errors.iter_mut().for_each(|error| *error = KEPT * *error + (1.0 - KEPT * KEPT).sqrt() * normal());
    }
    let estimate = run.estimate().expect("an estimate");
    let sigma = estimate.parameters().next().expect("a rate of growth");
    (sigma.value.expect("a value"), sigma.standard_deviation.expect("a deviation"))
}

#[test]
fn a_body_that_keeps_its_size_does_not_seem_to_grow_where_its_errors_stay_for_some_frames() {
    let runs: Vec<(f64, f64)> = (0..6).map(growth).collect();
    let mean_of_squares = runs.iter().map(|(value, deviation)| (value / deviation).powi(2)).sum::<f64>() / 6.0;
    // Chi-square of 6 degrees of freedom: 22.5 in one of 1000.
    assert!(mean_of_squares < 22.5 / 6.0, "{mean_of_squares}: {runs:?}");
    assert!(runs.iter().all(|(_, deviation)| *deviation < 0.006), "{runs:?}");
}
