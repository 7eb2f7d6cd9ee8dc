//! Sequences of hostile outlines through both identifiers, beside the same motion seen through a well-posed twin.
use crate::checks::{assert_covariance, assert_finite};
use freeform_motion::{
    Pipeline, PipelineError, PipelineSettings,
    curve_fit::{FitError, Outline},
    estimate::MotionEstimate,
    outline_filter::{FilterError, FilterSettings, MotionFilter},
    riccati::RigidMotion,
    sim_camera::{BuiltInShape, Shape},
};
use nalgebra::{Affine2, Matrix3, Point2, Vector2};
use proptest::prelude::*;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;

const MOTION: RigidMotion = RigidMotion { omega: 1.2, b1: -0.3, b2: 0.4 };
const FRAMES: usize = 12;

fn time(frame: usize) -> f64 {
    frame as f64 / 30.0
}

/// A moving outline: its points at parameters in [0, 1), noise uniform in a square.
fn sequence(body: impl Fn(f64) -> Point2<f64>, count: usize, noise: f64, seed: u64) -> Vec<Vec<Point2<f64>>> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let frames = (0..FRAMES).map(|frame| {
        let pose = MOTION.flow(time(frame));
        let start: f64 = rng.random();
        let points = (0..count).map(|i| {
            let place = ((i as f64 + rng.random::<f64>()) / count as f64 + start).fract();
            let mut draw = || noise * 3.0_f64.sqrt() * rng.random_range(-1.0..1.0_f64);
            pose * body(place) + Vector2::new(draw(), draw())
        });
        points.collect()
    });
    frames.collect()
}

fn bird(seed: u64) -> Vec<Vec<Point2<f64>>> {
    let bird: Shape = BuiltInShape::Bird.shape();
    sequence(move |place| bird.point_at(place), 200, 0.004, seed)
}

fn changed(
    sequence: &[Vec<Point2<f64>>],
    change: impl Fn(&[Point2<f64>]) -> Vec<Point2<f64>>,
) -> Vec<Vec<Point2<f64>>> {
    sequence.iter().map(|points| change(points)).collect()
}

fn through(sequence: &[Vec<Point2<f64>>], map: &Affine2<f64>) -> Vec<Vec<Point2<f64>>> {
    changed(sequence, |points| points.iter().map(|p| map * p).collect())
}

fn by_filter(sequence: &[Vec<Point2<f64>>]) -> (MotionFilter, Option<MotionEstimate>) {
    let mut filter = MotionFilter::new(FilterSettings::default()).expect("settings");
    for (frame, points) in sequence.iter().enumerate() {
        let outline = Outline::closed(points.clone()).expect("an outline");
        filter.step(time(frame), &outline).expect("enough points");
        if let Some(estimate) = filter.estimate() {
            assert_finite(&estimate);
        }
        assert_covariance(&filter);
    }
    let estimate = filter.estimate();
    (filter, estimate)
}

/// The estimate and the number of frames rejected.
fn by_pipeline(sequence: &[Vec<Point2<f64>>]) -> (usize, Option<MotionEstimate>) {
    let mut pipeline = Pipeline::new(PipelineSettings::default()).expect("settings");
    for (frame, points) in sequence.iter().enumerate() {
        let outline = Outline::closed(points.clone()).expect("an outline");
        let _rejected_or_not = pipeline.push(time(frame), &outline);
        if let Some(estimate) = pipeline.estimate() {
            assert_finite(&estimate);
        }
    }
    (pipeline.frames_rejected(), pipeline.estimate())
}

/// Largest difference of two generators in the coordinates of the first, the second seen through a map.
fn difference(here: &MotionEstimate, there: &MotionEstimate, map: &Affine2<f64>) -> f64 {
    let back: Matrix3<f64> = map.inverse().matrix() * there.generator() * map.matrix();
    (back - here.generator()).amax()
}

fn scaling(unit: f64, shift: Vector2<f64>) -> Affine2<f64> {
    Affine2::from_matrix_unchecked(Matrix3::new(unit, 0.0, shift.x, 0.0, unit, shift.y, 0.0, 0.0, 1.0))
}

/// The kind of self-touching outline that has no inside.
const STICK: usize = 3;

/// Outlines that touch or cross themselves, or nearly so.
fn self_touching(kind: usize) -> impl Fn(f64) -> Point2<f64> {
    move |place| {
        let t = std::f64::consts::TAU * place;
        match kind {
            // A figure of eight with lobes of different size.
            0 => Point2::new(0.5 * t.sin() + 0.1 * t.cos(), 0.4 * (2.0 * t).sin() + 0.05 * (t + 0.4).cos()),
            // A loop that crosses itself (a limacon).
            1 => Point2::from(Vector2::new(t.cos(), t.sin()) * (0.2 + 0.4 * t.cos())),
            // A cusp.
            2 => Point2::from(Vector2::new(t.cos(), t.sin()) * (0.3 + 0.3 * t.cos())),
            // A thin stick with both of its sides on each other.
            _ => Point2::new(0.5 * t.cos(), 0.2 * t.cos().powi(2)),
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(5))]

    #[test]
    fn units_and_offsets_of_any_size_leave_the_motion_as_it_is(
        seed in any::<u64>(),
        unit in -6.0..6.0_f64,
        far in prop::bool::ANY,
    ) {
        let unit = 10.0_f64.powf(unit);
        let shift = if far { Vector2::new(1e6, -7e5) * unit } else { Vector2::zeros() };
        let map = scaling(unit, shift);
        let here = bird(seed);
        let there = through(&here, &map);
        let tolerance = if far { 1e-3 } else { 1e-6 };
        let (filter, filter_there) = (by_filter(&here), by_filter(&there));
        prop_assert_eq!(filter.0.frames_rejected(), filter_there.0.frames_rejected());
        let error = difference(&filter.1.expect("a motion"), &filter_there.1.expect("a motion"), &map);
        prop_assert!(error < tolerance, "filter, unit {unit:e}: {error:e}");
        let (pipeline, pipeline_there) = (by_pipeline(&here), by_pipeline(&there));
        prop_assert_eq!(pipeline.0, pipeline_there.0);
        let error = difference(&pipeline.1.expect("a motion"), &pipeline_there.1.expect("a motion"), &map);
        prop_assert!(error < tolerance, "pipeline, unit {unit:e}: {error:e}");
    }

    #[test]
    fn the_start_and_the_direction_of_the_outline_do_not_matter(seed in any::<u64>(), start in 0..200_usize) {
        let here = bird(seed);
        let there = changed(&here, |points| {
            let mut points = points.to_vec();
            points.rotate_left(start);
            points.reverse();
            points
        });
        let (filter, filter_there) = (by_filter(&here).1.expect("a motion"), by_filter(&there).1.expect("a motion"));
        // Cells begin elsewhere, so that noise comes to other ones: within the deviation, not to rounding.
        for (a, b) in filter.parameters().zip(filter_there.parameters()) {
            let apart = (a.value.expect("observable") - b.value.expect("observable")).abs();
            prop_assert!(apart < 2.0 * a.standard_deviation.expect("given"), "{a:?} {b:?}");
        }
        let (pipeline, pipeline_there) = (by_pipeline(&here).1, by_pipeline(&there).1);
        let error = difference(&pipeline.expect("a motion"), &pipeline_there.expect("a motion"), &Affine2::identity());
        prop_assert!(error < 1e-6, "pipeline: {error:e}");
    }

    #[test]
    fn outlines_that_touch_themselves_move_as_their_twins_in_another_place_and_unit(
        kind in 0..4_usize,
        seed in any::<u64>(),
        unit in -6.0..6.0_f64,
    ) {
        let map = scaling(10.0_f64.powf(unit), Vector2::new(3.0, -2.0));
        let here = sequence(self_touching(kind), 200, 0.003, seed);
        let there = through(&here, &map);
        let (filter, filter_there) = (by_filter(&here), by_filter(&there));
        prop_assert_eq!(filter.0.frames_rejected(), filter_there.0.frames_rejected());
        if let (Some(a), Some(b)) = (&filter.1, &filter_there.1) {
            let error = difference(a, b, &map);
            prop_assert!(error < 1e-4, "filter, kind {kind}: {error:e}");
        }
        if kind != STICK && let Some((value, deviation)) = omega(filter.1) {
            let error = (value - MOTION.omega).abs();
            prop_assert!(error < 6.0 * deviation + 0.02, "kind {kind}: omega {value} +- {deviation}");
        }
        let (pipeline, pipeline_there) = (by_pipeline(&here), by_pipeline(&there));
        prop_assert_eq!(pipeline.0, pipeline_there.0, "kind {}", kind);
        if let (Some(a), Some(b)) = (pipeline.1, pipeline_there.1) {
            let error = difference(&a, &b, &map);
            prop_assert!(error < 1e-4, "pipeline, kind {kind}: {error:e}");
        }
    }

    #[test]
    fn objects_whose_curves_have_nearly_double_lines_move_as_their_twins_in_another_place_and_unit(
        seed in any::<u64>(),
        flatness in 0.3..0.95_f64,
        exponent in -6.0..0.0_f64,
        unit in -6.0..6.0_f64,
    ) {
        // The quartic of an ellipse is the square of a conic but for its dents, so that its lines come in pairs.
        let round = dented_circle(0.2 * 10.0_f64.powf(exponent));
        let here = sequence(move |place| { let p = round(place); Point2::new(p.x, flatness * p.y) }, 200, 0.003, seed);
        let map = scaling(10.0_f64.powf(unit), Vector2::new(-5.0, 2.0));
        let there = through(&here, &map);
        let (filter, filter_there) = (by_filter(&here), by_filter(&there));
        prop_assert_eq!(filter.0.frames_rejected(), filter_there.0.frames_rejected());
        prop_assert_eq!(filter.1.is_some(), filter_there.1.is_some());
        if let (Some(a), Some(b)) = (&filter.1, &filter_there.1) {
            let error = difference(a, b, &map);
            prop_assert!(error < 1e-4, "filter: {error:e}");
        }
        let (pipeline, pipeline_there) = (by_pipeline(&here), by_pipeline(&there));
        prop_assert_eq!(pipeline.0, pipeline_there.0);
        prop_assert_eq!(pipeline.1.is_some(), pipeline_there.1.is_some());
        if let (Some(a), Some(b)) = (pipeline.1, pipeline_there.1) {
            let error = difference(&a, &b, &map);
            prop_assert!(error < 1e-4, "pipeline: {error:e}");
        }
    }

    #[test]
    fn a_nearly_round_object_leaves_both_identifiers_finite(
        seed in any::<u64>(),
        exponent in -12.0..0.0_f64,
        noise in prop::sample::select(vec![0.0, 0.004]),
    ) {
        let frames = sequence(dented_circle(0.2 * 10.0_f64.powf(exponent)), 200, noise, seed);
        by_pipeline(&frames);
        by_filter(&frames);
    }
}

/// A circle with a dent of this share of its radius.
fn dented_circle(dent: f64) -> impl Fn(f64) -> Point2<f64> {
    move |place| {
        let t = std::f64::consts::TAU * place;
        let radius = 0.5 * (1.0 + dent * ((2.0 * t).cos() + 0.7 * (3.0 * t + 0.5).sin()));
        Point2::from(Vector2::new(t.cos(), t.sin()) * radius)
    }
}

/// Omega and its standard deviation, where they are known.
fn omega(estimate: Option<MotionEstimate>) -> Option<(f64, f64)> {
    let omega = estimate?.parameters().next()?;
    omega.value.zip(omega.standard_deviation)
}

#[test]
fn the_turn_of_a_nearly_round_object_is_right_or_said_to_be_unknown() {
    let mut wrong = Vec::new();
    for exponent in [-13, -4, -2, -1, 0] {
        let dent = 0.2 * 10.0_f64.powi(exponent);
        for seed in 0..5 {
            let frames = sequence(dented_circle(dent), 200, 0.004, seed);
            if let Some((value, deviation)) = omega(by_filter(&frames).1)
                && (value - MOTION.omega).abs() > 6.0 * deviation + 0.01
            {
                wrong.push(format!("dent {dent:.0e}, seed {seed}: omega {value:.3} +- {deviation:.3}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn the_turn_of_a_stick_without_width_is_right_or_said_to_be_unknown() {
    for seed in (0..5).chain([2_957_470_470_127_210_407]) {
        let frames = sequence(self_touching(STICK), 200, 0.003, seed);
        if let Some((value, deviation)) = omega(by_filter(&frames).1) {
            let error = (value - MOTION.omega).abs();
            assert!(error < 6.0 * deviation + 0.02, "seed {seed}: omega {value} +- {deviation}");
        }
    }
}

#[test]
fn pixel_stairs_give_the_motion_of_the_smooth_outline() {
    let here = bird(3);
    let pixels = 100.0;
    let there = changed(&here, |points| {
        let mut points: Vec<_> = points.iter().map(|p| (p * pixels).map(f64::round)).collect();
        points.dedup();
        points
    });
    let map = scaling(pixels, Vector2::zeros());
    let (filter, filter_there) = (by_filter(&here), by_filter(&there));
    assert_eq!(filter_there.0.frames_rejected(), 0);
    let error = difference(&filter.1.expect("a motion"), &filter_there.1.expect("a motion"), &map);
    assert!(error < 0.05, "filter: {error}");
    let error = difference(&by_pipeline(&here).1.expect("a motion"), &by_pipeline(&there).1.expect("a motion"), &map);
    assert!(error < 0.05, "pipeline: {error}");
}

fn with_every_point_three_times(sequence: &[Vec<Point2<f64>>]) -> Vec<Vec<Point2<f64>>> {
    changed(sequence, |points| points.iter().flat_map(|p| [*p; 3]).collect())
}

#[test]
fn repeated_points_give_the_pipeline_the_motion_of_the_outline_without() {
    let here = bird(4);
    let there = with_every_point_three_times(&here);
    let both = [by_pipeline(&here), by_pipeline(&there)].map(|(_, estimate)| estimate.expect("a motion"));
    let error = difference(&both[0], &both[1], &Affine2::identity());
    assert!(error < 0.03, "{error}");
}

#[test]
fn repeated_points_give_the_filter_the_motion_of_the_outline_without() {
    let here = bird(4);
    let (filter, there) = (by_filter(&here), by_filter(&with_every_point_three_times(&here)));
    assert_eq!(there.0.frames_rejected(), 0);
    let error = difference(&filter.1.expect("a motion"), &there.1.expect("a motion"), &Affine2::identity());
    assert!(error < 0.03, "{error}");
}

#[test]
fn three_points_are_refused_by_name() {
    let triangle = vec![Point2::new(0.0, 0.0), Point2::new(1.0, 0.0), Point2::new(0.0, 1.0)];
    let outline = Outline::closed(triangle).expect("an outline");
    let mut pipeline = Pipeline::new(PipelineSettings::default()).expect("settings");
    let error = pipeline.push(0.0, &outline).expect_err("too few points");
    assert!(matches!(error, PipelineError::Fit(FitError::TooFewPoints { found: 3, .. })), "{error}");
    let mut filter = MotionFilter::new(FilterSettings::default()).expect("settings");
    let error = filter.step(0.0, &outline).expect_err("too few points");
    assert!(matches!(error, FilterError::TooFewPoints { found: 3, .. }), "{error}");
    // After a good start it is a frame that does not fit.
    let good = bird(5);
    let mut filter = by_filter(&good).0;
    let step = filter.step(time(FRAMES), &outline).expect("a later time");
    assert!(!step.is_accepted() && filter.frames_rejected() == 1);
}

#[test]
fn a_million_points_in_a_frame_give_the_motion() {
    let body = |place: f64| {
        let t = std::f64::consts::TAU * place;
        Point2::new(0.5 * t.cos() + 0.08 * (2.0 * t).cos(), 0.3 * t.sin() + 0.05 * (3.0 * t).sin())
    };
    let frames = (0..3).map(|frame| {
        let pose = MOTION.flow(time(5 * frame));
        (0..1_000_000).map(|i| pose * body(f64::from(i) / 1e6)).collect::<Vec<_>>()
    });
    let mut filter = MotionFilter::new(FilterSettings::default()).expect("settings");
    let mut pipeline = Pipeline::new(PipelineSettings::default()).expect("settings");
    for (frame, points) in frames.enumerate() {
        let outline = Outline::closed(points).expect("an outline");
        assert!(filter.step(time(5 * frame), &outline).expect("enough points").is_accepted(), "frame {frame}");
        pipeline.push(time(5 * frame), &outline).expect("a curve");
    }
    let (omega, deviation) = omega(filter.estimate()).expect("known");
    println!("omega {omega} +- {deviation}");
    assert!((omega - MOTION.omega).abs() < 0.02, "{omega} +- {deviation}");
    assert_finite(&pipeline.estimate().expect("a motion"));
}
