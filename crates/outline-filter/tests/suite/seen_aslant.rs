//! Objects seen aslant, whose turns stretch their outlines: affine motion.
use freeform_curve_fit::Outline;
use freeform_outline_filter::MotionFilter;
use freeform_riccati::MotionModel;
use nalgebra::{Matrix2, Point2, Rotation2, Vector2};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, Normal};

use crate::filter_support::filter;

const FRAMES: u8 = 40;
const FRAMES_PER_SECOND: f64 = 30.0;

/// What a plane looks like from aside, at some angle in the picture.
fn aslant(narrower: f64, angle: f64) -> Matrix2<f64> {
    let turn = Rotation2::new(angle);
    turn.matrix() * Matrix2::new(1.0, 0.0, 0.0, narrower) * turn.inverse().matrix()
}

/// A body that turns by so much from frame to frame, anticlockwise in its plane, and is drawn by the angle and chance.
fn followed(
    body: impl Fn(f64) -> Point2<f64>,
    (turn, view): (f64, Matrix2<f64>),
    (points, noise, seed): (u16, f64, u64),
) -> MotionFilter {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let normal = Normal::new(0.0, noise).expect("a deviation");
    let mut run = filter(MotionModel::Affine);
    for frame in 0..FRAMES {
        let pose = view * Rotation2::new(turn * f64::from(frame)).matrix();
        let mut point = |i: u16| {
            let share = (f64::from(i) + random.random::<f64>()) / f64::from(points);
            pose * body(std::f64::consts::TAU * share) + Vector2::from_fn(|_, _| normal.sample(&mut random))
        };
        let outline = Outline::closed((0..points).map(&mut point).collect()).expect("an outline");
        run.step(f64::from(frame) / FRAMES_PER_SECOND, &outline).expect("increasing times");
    }
    run
}

/// A flower of so many lobes.
fn flower(lobes: f64) -> impl Fn(f64) -> Point2<f64> {
    move |angle| Point2::from((1.0 + 0.2 * (lobes * angle).cos()) * Vector2::new(angle.cos(), angle.sin()))
}

/// The largest error of a rate that is stated, in its standard deviations, and how many are.
fn errors_of_rates(run: &MotionFilter, (turn, view): (f64, Matrix2<f64>)) -> (f64, usize) {
    let omega = -turn * FRAMES_PER_SECOND;
    let rates = view * Matrix2::new(0.0, omega, -omega, 0.0) * view.try_inverse().expect("a view");
    let truth = [rates.m11, rates.m12, rates.m21, rates.m22];
    let estimate = run.estimate().expect("an estimate");
    let stated = estimate.parameters().zip(truth).filter_map(|(p, truth)| {
        p.value.zip(p.standard_deviation).map(|(value, deviation)| (value - truth).abs() / deviation)
    });
    stated.fold((0.0, 0), |(largest, count), error| (error.max(largest), count + 1))
}

#[test]
fn a_flower_seen_aslant_that_turns_by_less_than_a_quarter_of_its_symmetry_is_followed_and_its_other_rates_listed() {
    for (seed, narrower) in (0..4).zip([0.5, 0.8].into_iter().cycle()) {
        let motion = (-0.2, aslant(narrower, 0.4));
        let run = followed(flower(5.0), motion, (300, 0.004, seed));
        let (error, stated) = errors_of_rates(&run, motion);
        assert!(stated == 4 && error < 5.0, "{narrower}, seed {seed}: {error} {stated}");
        let aliases = run.aliases();
        // A fifth of a turn more or less per frame. Mean rates are the larger the more a view is stretched.
        for turn in [-1.0, 1.0].map(|step| motion.0 + step * std::f64::consts::TAU / 5.0) {
            let mean = -0.5 * (narrower + 1.0 / narrower) * turn * FRAMES_PER_SECOND;
            let is_listed = aliases.iter().any(|alias| (alias - mean).abs() < 0.01 * mean.abs());
            assert!(is_listed, "{narrower}, seed {seed}: {mean} {aliases:?}");
        }
    }
}

#[test]
fn what_a_flower_seen_aslant_leaves_open_is_not_stated() {
    // Turns by half the angle of symmetry, a tenth less or more.
    for (seed, share) in (0..6).zip([0.45, 0.5, 0.55].into_iter().cycle()) {
        for lobes in [3.0, 4.0, 5.0] {
            let turn = share * std::f64::consts::TAU / lobes;
            let run = followed(flower(lobes), (turn, aslant(0.6, 1.1)), (300, 0.004, seed));
            let context = format!("{lobes} lobes, {share}, seed {seed}");
            let estimate = run.estimate().unwrap_or_else(|| panic!("{context}"));
            assert!(estimate.parameters().all(|p| p.value.is_none()), "{context}: {estimate:?}");
            assert!(run.ambiguity().is_some(), "{context}");
        }
    }
}

#[test]
fn a_disc_seen_aslant_tells_none_of_its_rates_and_one_with_a_flat_side_tells_them_right_or_not() {
    for (seed, narrower) in (0..6).zip([1.0, 0.7, 0.4].into_iter().cycle()) {
        let view = aslant(narrower, 0.7);
        let disc = |angle: f64| Point2::new(angle.cos(), angle.sin());
        for (points, noise) in [(30, 0.003), (300, 0.01)] {
            let run = followed(disc, (0.1, view), (points, noise, seed));
            let (error, stated) = errors_of_rates(&run, (0.1, view));
            assert_eq!(stated, 0, "disc, {narrower}, {points} points, seed {seed}: {error}");
            assert!(run.velocity().is_some(), "disc, {narrower}, {points} points, seed {seed}");
        }
        for flat in [0.2, 0.5] {
            let flattened = |angle: f64| {
                let inside = (angle - std::f64::consts::PI).abs() < flat;
                let radius = if inside { flat.cos() / (angle - std::f64::consts::PI).cos() } else { 1.0 };
                Point2::new(radius * angle.cos(), radius * angle.sin())
            };
            let run = followed(flattened, (0.1, view), (200, 0.004, seed));
            let (error, stated) = errors_of_rates(&run, (0.1, view));
            assert!(error < 5.0, "flat side of {flat}, {narrower}, seed {seed}: {error}");
            assert!(stated == 4 || flat < 0.4, "flat side of {flat}, {narrower}, seed {seed}");
        }
    }
}
