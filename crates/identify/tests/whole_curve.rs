//! The whole-curve filter: exact where the data is, equivariant, near the bound, and at a loss only where it says so.
mod recording;

use freeform_curve_fit::{Degree, Outline};
use freeform_identify::{
    CurveFilterSettings, CurveStep, FilterError, MotionEstimate, Phase, ProcessNoise, WholeCurveFilter,
};
use freeform_riccati::MotionModel;
use freeform_sim_camera::{BuiltInShape, Shape};
use nalgebra::{Affine2, Matrix3, Point2};
use proptest::prelude::*;
use recording::{
    Corruption, NOISE, SECONDS_PER_FRAME, bound, constant_motion, is_near_95_percent, map, parameters, record,
    root_mean_square,
};

fn filter(model: MotionModel, degree: Degree) -> WholeCurveFilter {
    WholeCurveFilter::new(CurveFilterSettings { model, degree, ..CurveFilterSettings::default() })
        .expect("good settings")
}

fn run(filter: &mut WholeCurveFilter, frames: &[(f64, Outline)]) -> Vec<CurveStep> {
    frames.iter().map(|(time, outline)| filter.step(*time, outline).expect("increasing times")).collect()
}

fn estimated(model: MotionModel, degree: Degree, frames: &[(f64, Outline)]) -> MotionEstimate {
    let mut filter = filter(model, degree);
    run(&mut filter, frames);
    filter.estimate().expect("an estimate")
}

/// The same points in every frame, moved along.
fn exact(shape: BuiltInShape, poses: &[Matrix3<f64>]) -> Vec<(f64, Outline)> {
    let shape = Shape::from(shape);
    let points: Vec<_> = (0..300).map(|i| shape.point_at(f64::from(i) / 300.0)).collect();
    let frames = poses.iter().enumerate().map(|(frame, pose)| {
        let moved = points.iter().map(|p| map(pose, p)).collect();
        (frame as f64 * SECONDS_PER_FRAME, Outline::closed(moved).expect("an outline"))
    });
    frames.collect()
}

#[test]
fn exact_points_give_the_motion_closer_than_noise_allows_whatever_the_model_and_the_degree() {
    for model in MotionModel::ALL {
        // A quartic misses much of these outlines, and which points are too far off it to count is decided anew in every frame.
        let quartic = (model < MotionModel::Projective).then_some((Degree::Quartic, 0.8));
        for (degree, share) in quartic.into_iter().chain([(Degree::Sextic, 0.5), (Degree::Octic, 0.5)]) {
            for shape in [BuiltInShape::Bird, BuiltInShape::Glider] {
                let frames = exact(shape, &constant_motion(model, 12));
                let estimate = estimated(model, degree, &frames);
                let smallest = bound(shape, model, 12, 1.0);
                for ((value, truth), smallest) in estimate.values().iter().zip(parameters(model)).zip(smallest) {
                    assert!((value - truth).abs() < share * smallest, "{shape} {model} {degree}: {value} for {truth}");
                }
            }
        }
    }
}

/// Error over bound of all parameters, and how many of how many lie within their 95 % intervals.
fn monte_carlo(model: MotionModel, degree: Degree, frames: usize, runs: u64) -> (Vec<f64>, usize) {
    let (mut ratios, mut covered) = (Vec::new(), 0);
    for shape in [BuiltInShape::Bird, BuiltInShape::Glider] {
        let smallest = bound(shape, model, frames, 1.0);
        for seed in 0..runs {
            let frames = record(shape, &constant_motion(model, frames), Corruption::default(), NOISE, seed);
            let estimate = estimated(model, degree, &frames);
            for ((parameter, truth), smallest) in estimate.parameters().zip(parameters(model)).zip(&smallest) {
                let error = parameter.value.expect("observable") - truth;
                covered += usize::from(error.abs() < 1.96 * parameter.standard_deviation.expect("given"));
                ratios.push(error / smallest);
            }
        }
    }
    (ratios, covered)
}

#[test]
fn a_sextic_is_near_the_bound_and_its_intervals_hold() {
    // The root mean square of 36 or more values is uncertain by 12 %.
    for (model, limit) in [(MotionModel::Rigid, 1.7), (MotionModel::Affine, 1.7)] {
        let (ratios, covered) = monte_carlo(model, Degree::Sextic, 30, 6);
        let rmse = root_mean_square(&ratios);
        assert!(rmse < limit, "{model}: {rmse}");
        assert!(is_near_95_percent(covered, ratios.len(), 1), "{model}: {covered} of {}", ratios.len());
    }
}

#[test]
fn a_quartic_stays_within_three_times_the_bound() {
    let (ratios, _) = monte_carlo(MotionModel::Rigid, Degree::Quartic, 30, 4);
    assert!(root_mean_square(&ratios) < 3.0, "{}", root_mean_square(&ratios));
}

#[test]
fn the_second_frame_is_found_after_a_turn_of_a_radian_and_a_shift() {
    for (turn, shift) in [(1.0, 0.4), (-1.0, -0.3), (0.5, 0.5)] {
        let theta = [turn, shift, -0.2];
        let poses: Vec<_> = (0..6).map(|i| MotionModel::Rigid.flow(&theta, f64::from(i)).into_inner()).collect();
        for shape in [BuiltInShape::Bird, BuiltInShape::Glider] {
            let mut frames = record(shape, &poses, Corruption::default(), NOISE, 3);
            frames.iter_mut().enumerate().for_each(|(i, frame)| frame.0 = i as f64);
            let mut filter = filter(MotionModel::Rigid, Degree::Sextic);
            assert!(run(&mut filter, &frames).iter().all(|step| step.accepted), "{shape} {turn}");
            let omega = filter.estimate().expect("an estimate").values()[0];
            assert!((omega - turn).abs() < 0.01, "{shape}: {omega} for {turn}");
        }
    }
}

#[test]
fn frames_of_another_object_are_rejected_and_a_jump_is_recovered_from() {
    let mut poses = constant_motion(MotionModel::Rigid, 40);
    let jump = MotionModel::Rigid.flow(&[0.7, 0.3, -0.2], 1.0).into_inner();
    poses[25..].iter_mut().for_each(|pose| *pose = jump * *pose);
    let mut frames = record(BuiltInShape::Bird, &poses, Corruption::default(), NOISE, 5);
    let other = record(BuiltInShape::Square, &poses[10..12], Corruption::default(), NOISE, 6);
    frames[10].1 = other[0].1.clone();
    let mut filter = filter(MotionModel::Rigid, Degree::Sextic);
    let steps = run(&mut filter, &frames);
    assert!(!steps[10].accepted && steps[11].accepted);
    assert!(!steps[25].accepted && steps[39].accepted);
    assert_eq!((filter.phase(), filter.restarts()), (Phase::Tracking, 0));
    // About the new place the same motion has another b.
    let moved =
        jump * MotionModel::Rigid.generator(&parameters(MotionModel::Rigid)) * jump.try_inverse().expect("regular");
    let estimate = filter.estimate().expect("an estimate");
    for (parameter, truth) in estimate.parameters().zip(MotionModel::Rigid.parameters_of(&moved)) {
        let error = parameter.value.expect("observable") - truth;
        assert!(error.abs() < 5.0 * parameter.standard_deviation.expect("given"), "{} {error}", parameter.name);
    }
    let pose: Affine2<f64> = nalgebra::try_convert(filter.pose().expect("a pose")).expect("affine");
    assert!((pose.matrix() - poses[39] * poses[0].try_inverse().expect("regular")).norm() < 0.01);
}

#[test]
fn the_turn_of_a_circle_is_unobservable() {
    let frames = record(BuiltInShape::Circle, &vec![Matrix3::identity(); 20], Corruption::default(), NOISE, 1);
    let observable: Vec<bool> =
        estimated(MotionModel::Rigid, Degree::Quartic, &frames).parameters().map(|p| p.value.is_some()).collect();
    assert!(!observable[0]);
}

#[test]
fn process_noise_lets_it_follow_a_motion_that_drifts() {
    let mut pose = Matrix3::identity();
    let mut poses = vec![pose];
    for i in 1..90 {
        let omega = 1.0 + 0.5 * f64::from(i) / 30.0;
        pose = MotionModel::Rigid.flow(&[omega, 0.2, -0.1], SECONDS_PER_FRAME).into_inner() * pose;
        poses.push(pose);
    }
    let frames = record(BuiltInShape::Bird, &poses, Corruption::default(), NOISE, 2);
    let process_noise = ProcessNoise { rates: 0.5, velocities: 0.1 };
    let settings = CurveFilterSettings { process_noise, ..CurveFilterSettings::default() };
    let mut filter = WholeCurveFilter::new(settings).expect("good settings");
    assert!(run(&mut filter, &frames).iter().all(|step| step.accepted));
    let estimate = filter.estimate().expect("an estimate");
    let omega = estimate.parameters().next().expect("omega");
    let error = omega.value.expect("observable") - (1.0 + 0.5 * 89.0 / 30.0);
    let std = omega.standard_deviation.expect("given");
    assert!(error.abs() < 4.0 * std && std < 0.5, "{error} +- {std}");
}

#[test]
fn the_curve_goes_along_with_the_object() {
    let frames = record(BuiltInShape::Bird, &constant_motion(MotionModel::Rigid, 20), Corruption::default(), NOISE, 2);
    let mut filter = filter(MotionModel::Rigid, Degree::Sextic);
    assert_eq!(filter.curve(), None);
    run(&mut filter, &frames);
    let curve = filter.curve().expect("a curve");
    let points = frames[19].1.points();
    let mean_square = points.map(|p| curve.evaluate(p).powi(2)).sum::<f64>() / 400.0;
    assert!(mean_square < 0.3, "{mean_square}");
    assert!(curve.evaluate(&frames[19].1.centroid()) < 0.0);
    assert!((filter.noise() / NOISE - 1.0).abs() < 0.3, "{}", filter.noise());
}

#[test]
fn every_frame_is_counted_once_and_rejected_ones_say_why_also_where_another_object_comes() {
    let mut frames =
        record(BuiltInShape::Bird, &constant_motion(MotionModel::Rigid, 15), Corruption::default(), NOISE, 0);
    let other = record(BuiltInShape::Van, &constant_motion(MotionModel::Rigid, 1), Corruption::default(), NOISE, 0);
    frames[0].1 = other[0].1.clone();
    let mut filter = filter(MotionModel::Rigid, Degree::Sextic);
    let steps = run(&mut filter, &frames);
    assert!(filter.restarts() > 0 && steps.iter().all(|step| step.accepted == step.rejection.is_none()));
    let accepted = steps.iter().filter(|step| step.accepted).count();
    assert_eq!((filter.frames_accepted(), filter.frames_rejected()), (accepted, frames.len() - accepted));
    let reason = steps.iter().find_map(|step| step.rejection).expect("one was rejected");
    assert!(reason.to_string().contains("misfit"), "{reason}");
}

#[test]
fn bad_input_is_refused_and_leaves_the_filter_as_it_was() {
    let frames = record(BuiltInShape::Bird, &constant_motion(MotionModel::Rigid, 5), Corruption::default(), NOISE, 0);
    let mut filter = filter(MotionModel::Rigid, Degree::Sextic);
    run(&mut filter, &frames);
    let before = (filter.estimate(), filter.frames_accepted(), filter.frames_rejected());
    for time in [frames[4].0, 0.0, f64::NAN, f64::INFINITY] {
        let refused = filter.step(time, &frames[4].1);
        assert!(matches!(refused, Err(FilterError::TimeNotIncreasing { .. })), "{time}");
    }
    assert_eq!(before, (filter.estimate(), filter.frames_accepted(), filter.frames_rejected()));
    let triangle = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(x, y)| Point2::new(x, y));
    let few = Outline::closed(triangle.to_vec()).expect("a triangle");
    let mut empty = self::filter(MotionModel::Rigid, Degree::Sextic);
    assert_eq!(empty.step(0.0, &few), Err(FilterError::TooFewPoints { found: 3, needed: 28 }));
    assert_eq!((empty.phase(), empty.estimate(), empty.pose()), (Phase::Waiting, None, None));
    assert!(!filter.step(1.0, &few).expect("later frames may be bad").accepted);
    let good = CurveFilterSettings::default();
    for bad in [
        CurveFilterSettings { offset: 0.0, ..good },
        CurveFilterSettings { offset: f64::NAN, ..good },
        CurveFilterSettings { normal_half_window: 0.3, ..good },
        CurveFilterSettings { patience: 0, ..good },
        CurveFilterSettings { process_noise: ProcessNoise { rates: -1.0, velocities: 0.0 }, ..good },
    ] {
        assert!(matches!(WholeCurveFilter::new(bad), Err(FilterError::Setting { .. })), "{bad:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(6))]
    #[test]
    fn the_motion_of_a_turned_scaled_and_shifted_scene_is_the_turned_scaled_and_shifted_motion(
        angle in -3.0_f64..3.0, scale in 0.01_f64..100.0, x in -5.0_f64..5.0, y in -5.0_f64..5.0, seed in 0_u64..100,
        affine in any::<bool>(),
    ) {
        let model = if affine { MotionModel::Affine } else { MotionModel::Rigid };
        let frames = record(BuiltInShape::Glider, &constant_motion(model, 6), Corruption::default(), NOISE, seed);
        let (s, c) = angle.sin_cos();
        let matrix =
            Matrix3::new(scale * c, -scale * s, scale * x, scale * s, scale * c, scale * y, 0.0, 0.0, 1.0);
        let change = Affine2::from_matrix_unchecked(matrix);
        let moved: Vec<_> =
            frames.iter().map(|(time, outline)| (*time, outline.moved(&change).expect("regular"))).collect();
        let (plain, turned) = (estimated(model, Degree::Sextic, &frames), estimated(model, Degree::Sextic, &moved));
        let expected = matrix * plain.generator() * change.inverse().matrix();
        let difference = turned.generator() - expected;
        for ((i, j), size) in [((0, 0), 1.0), ((0, 1), 1.0), ((1, 1), 1.0), ((0, 2), scale), ((1, 2), scale)] {
            prop_assert!(difference[(i, j)].abs() < 2e-3 * size, "{model}: {difference}");
        }
    }

    #[test]
    fn whatever_comes_numbers_stay_finite(
        seeds in proptest::collection::vec((0_u64..1000, 0_usize..4, 0.01_f64..3.0), 2..8),
        which in 0_usize..4, degree in 0_usize..4,
    ) {
        let mut filter = filter(MotionModel::ALL[which], Degree::ALL[degree]);
        let mut time = 0.0;
        for (seed, kind, dt) in seeds {
            time += dt;
            let shape = [BuiltInShape::Bird, BuiltInShape::Square, BuiltInShape::Circle, BuiltInShape::Van][kind];
            let corruption = Corruption { hidden: [0.0, 0.6, 0.0, 0.2][kind], outliers: 0.3 };
            let frames = record(shape, &[Matrix3::identity()], corruption, [0.0, 0.3, 0.005, 1e-7][kind], seed);
            filter.step(time, &frames[0].1).expect("increasing times");
            if let Some(estimate) = filter.estimate() {
                prop_assert!(estimate.values().iter().all(|v| v.is_finite()));
                prop_assert!(estimate.parameters().all(|p| p.standard_deviation.is_none_or(f64::is_finite)));
            }
            prop_assert!(filter.pose().expect("a pose").matrix().iter().all(|e| e.is_finite()));
        }
    }
}
