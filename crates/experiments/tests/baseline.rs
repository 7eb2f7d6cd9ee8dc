//! The baselines: exact on exact outlines, equivariant, and honest about what they cannot take.
use freeform_curve_fit::Outline;
use freeform_estimate::MotionEstimate;
use freeform_experiments::baseline::{AreaMomentEstimator, BaselineError, RegistrationEstimator};
use freeform_riccati::MotionModel;
use freeform_sim_camera::{BuiltInShape, Camera, Occlusion, Scene, SequenceLength, Settings, Simulator};
use nalgebra::{Affine2, Matrix3, Point2, Similarity2, Vector2};
use proptest::prelude::*;

/// A curve with nothing symmetric about it, about a unit across.
fn curve(wave: f64) -> Vec<Point2<f64>> {
    let at = |i: i32| {
        let t = std::f64::consts::TAU * f64::from(i) / 300.0;
        Point2::new(0.5 * t.cos() + 0.06 * (2.0 * t + wave).cos(), 0.3 * t.sin() + 0.05 * (3.0 * t).cos())
    };
    (0..300).map(at).collect()
}

/// Exact outlines, the same points in every frame.
fn exact_frames(model: MotionModel, theta: &[f64], wave: f64) -> Vec<(f64, Outline)> {
    let frame = |k: u32| {
        let time = f64::from(k) / 30.0;
        let flow = model.flow(theta, time);
        (time, Outline::closed(curve(wave).iter().map(|p| flow * p).collect()).expect("a curve"))
    };
    (0..10).map(frame).collect()
}

fn by_moments(model: MotionModel, frames: &[(f64, Outline)]) -> MotionEstimate {
    let mut estimator = AreaMomentEstimator::new(model).expect("a model with moments");
    for (time, outline) in frames {
        assert!(estimator.step(*time, outline).expect("increasing times"));
    }
    estimator.estimate().expect("many frames")
}

fn by_registration(model: MotionModel, frames: &[(f64, Outline)]) -> MotionEstimate {
    let mut estimator = RegistrationEstimator::new(model);
    for (time, outline) in frames {
        assert!(estimator.step(*time, outline).expect("increasing times"));
    }
    estimator.estimate().expect("many frames")
}

fn parameters(model: MotionModel, [omega, b1, b2, sigma, shear, stretch]: [f64; 6]) -> Vec<f64> {
    match model {
        MotionModel::Rigid => vec![omega, b1, b2],
        MotionModel::Similarity => vec![sigma, omega, b1, b2],
        _ => vec![sigma + stretch, omega, -omega + shear, sigma - stretch, b1, b2],
    }
}

fn error(estimate: &MotionEstimate, truth: &[f64]) -> f64 {
    estimate.values().iter().zip(truth).map(|(found, truth)| (found - truth).abs()).fold(0.0, f64::max)
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: proptest::test_runner::RngSeed::Fixed(1), ..ProptestConfig::with_cases(12) })]

    #[test]
    fn exact_outlines_give_the_exact_motion(
        draw in proptest::array::uniform6(-0.8_f64..0.8),
        wave in 0.0_f64..6.0,
        which in 0_usize..3,
    ) {
        let model = MotionModel::ALL[which];
        let theta = parameters(model, draw);
        let frames = exact_frames(model, &theta, wave);
        let moments = error(&by_moments(model, &frames), &theta);
        prop_assert!(moments < 1e-8, "{model} moments: {moments}");
        // Distances in the image weigh the bends of the lines anew as an affine motion stretches the outline.
        let tolerance = if model == MotionModel::Affine { 3e-3 } else { 1e-4 };
        let registration = error(&by_registration(model, &frames), &theta);
        prop_assert!(registration < tolerance, "{model} registration: {registration}");
    }

    #[test]
    fn outlines_turned_scaled_and_shifted_give_the_motion_in_those_coordinates(
        turn in -3.0_f64..3.0,
        scale in 0.01_f64..100.0,
        shift in proptest::array::uniform2(-3.0_f64..3.0),
        which in 0_usize..3,
        seed in 0_u64..1000,
    ) {
        let model = MotionModel::ALL[which];
        let settings = Settings { length: SequenceLength::Frames(12), seed, ..Settings::default() };
        let motion = freeform_riccati::RigidMotion { omega: 1.2, b1: -0.3, b2: 0.4 };
        let simulator = Simulator::new(Scene::new(BuiltInShape::Van, motion, Camera::default()), settings).expect("a scene");
        let frames: Vec<_> = simulator.frames().map(|frame| (frame.time, frame.outline)).collect();
        let map: Affine2<f64> = nalgebra::convert(Similarity2::new(scale * Vector2::from(shift), turn, scale));
        let moved: Vec<_> =
            frames.iter().map(|(time, outline)| (*time, outline.moved(&map).expect("in range"))).collect();
        for method in [by_moments, by_registration] {
            let (here, there) = (method(model, &frames), method(model, &moved));
            let expected: Matrix3<f64> = map.matrix() * here.generator() * map.inverse().matrix();
            let norm = 1.0 + expected.norm();
            prop_assert!((there.generator() - expected).norm() < 1e-6 * norm, "{}{expected}", there.generator());
        }
    }
}

#[test]
fn errors_are_those_the_standard_deviations_promise() {
    let truth = [1.2, -0.3, 0.4];
    let motion = freeform_riccati::RigidMotion { omega: truth[0], b1: truth[1], b2: truth[2] };
    for method in [by_moments, by_registration] {
        let mut squares = 0.0;
        for seed in 0..30 {
            let settings = Settings { length: SequenceLength::Frames(20), seed, ..Settings::default() };
            let scene = Scene::new(BuiltInShape::Shoe, motion, Camera::default());
            let frames: Vec<_> =
                Simulator::new(scene, settings).expect("a scene").frames().map(|f| (f.time, f.outline)).collect();
            let estimate = method(MotionModel::Rigid, &frames);
            for (p, truth) in estimate.parameters().zip(truth) {
                let deviation = p.standard_deviation.expect("twenty frames");
                squares += ((p.value.expect("observable") - truth) / deviation).powi(2) / 90.0;
            }
        }
        assert!((0.5..1.8).contains(&squares), "{squares}");
    }
}

#[test]
fn hidden_arcs_outliers_and_wrong_frames_do_not_lose_the_registration() {
    let motion = freeform_riccati::RigidMotion { omega: 1.2, b1: -0.3, b2: 0.4 };
    let settings = Settings {
        length: SequenceLength::Frames(60),
        occlusion: Occlusion { fraction: 0.2, ..Occlusion::default() },
        outliers: 0.05,
        wrong_frames: 0.1,
        seed: 3,
        ..Settings::default()
    };
    let simulator = Simulator::new(Scene::new(BuiltInShape::Glider, motion, Camera::default()), settings).expect("ok");
    let mut estimator = RegistrationEstimator::new(MotionModel::Rigid);
    let mut wrong = 0;
    for frame in simulator.frames() {
        let used = estimator.step(frame.time, &frame.outline).expect("increasing times");
        assert!(!(used && frame.corruption.wrong_shape.is_some()), "frame {}", frame.index);
        wrong += usize::from(frame.corruption.wrong_shape.is_some());
    }
    assert!(wrong > 0 && estimator.frames_rejected() == wrong, "{wrong} of {}", estimator.frames_rejected());
    let estimate = estimator.estimate().expect("many frames");
    assert!(error(&estimate, &[1.2, -0.3, 0.4]) < 0.01, "{:?}", estimate.values());
}

#[test]
fn bad_input_is_refused_with_the_reason() {
    let refused = AreaMomentEstimator::new(MotionModel::Projective).err();
    assert_eq!(refused, Some(BaselineError::UnsupportedModel { model: MotionModel::Projective }));
    let outline = Outline::closed(curve(0.0)).expect("a curve");
    let mut moments = AreaMomentEstimator::new(MotionModel::Rigid).expect("a model");
    let mut registration = RegistrationEstimator::new(MotionModel::Rigid);
    assert!(moments.estimate().is_none() && registration.estimate().is_none());
    moments.step(1.0, &outline).expect("a first frame");
    registration.step(1.0, &outline).expect("a first frame");
    for time in [1.0, 0.5, f64::NAN, f64::INFINITY] {
        assert!(matches!(moments.step(time, &outline), Err(BaselineError::TimeNotIncreasing(_))), "{time}");
        assert!(matches!(registration.step(time, &outline), Err(BaselineError::TimeNotIncreasing(_))), "{time}");
    }
    assert!(moments.estimate().is_none() && registration.estimate().is_none(), "one frame shows no motion");
}
