//! The motion filter with input of any kind: bad, of other coordinates, and whatever comes.
use crate::filter_support::{filter, filtered, frames_of, settings};
use freeform_curve_fit::Outline;
use freeform_estimate::ProcessNoise;
use freeform_outline_filter::{FilterError, FilterSettings, MotionFilter};
use freeform_riccati::{MotionModel, RigidMotion};
use freeform_sim_camera::{BuiltInShape, Frame, Settings};
use nalgebra::{Affine2, Matrix3, Point2, Vector2};
use proptest::prelude::*;

const RIGID: RigidMotion = RigidMotion { omega: std::f64::consts::FRAC_PI_2, b1: -0.3, b2: 0.4 };

#[test]
fn bad_input_is_refused_and_leaves_the_filter_as_it_was() {
    let frames = frames_of(BuiltInShape::Bird, RIGID, settings(5, 0));
    let mut run = filtered(MotionModel::Rigid, &frames);
    let before = (run.estimate(), run.frames_accepted(), run.frames_rejected());
    for time in [frames[4].time, 0.0, f64::NAN, f64::INFINITY] {
        let refused = run.step(time, &frames[4].outline);
        assert!(matches!(refused, Err(FilterError::TimeNotIncreasing(_))), "{time}");
    }
    assert_eq!(before, (run.estimate(), run.frames_accepted(), run.frames_rejected()));
    let triangle = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(x, y)| Point2::new(x, y));
    let few = Outline::closed(triangle.to_vec()).expect("a triangle");
    let mut empty = filter(MotionModel::Rigid);
    assert_eq!(empty.step(0.0, &few).err(), Some(FilterError::TooFewPoints { found: 3, needed: 8 }));
    assert!(!run.step(1.0, &few).expect("later frames may be bad").is_accepted());
    for (agreement, patience) in [(0.0, 2), (1.0, 2), (f64::NAN, 2), (0.5, 0)] {
        let settings = FilterSettings { smallest_agreement: agreement, patience, ..FilterSettings::default() };
        assert!(matches!(MotionFilter::new(settings), Err(FilterError::Setting { .. })));
    }
    let noise = ProcessNoise { rates: -1.0, velocities: 0.0 };
    assert!(MotionFilter::new(FilterSettings { process_noise: noise, ..FilterSettings::default() }).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]
    #[test]
    fn the_motion_of_a_turned_scaled_and_shifted_scene_is_the_turned_scaled_and_shifted_motion(
        angle in -3.0_f64..3.0, scale in 0.01_f64..100.0, x in -5.0_f64..5.0, y in -5.0_f64..5.0, seed in 0_u64..100,
    ) {
        let frames = frames_of(BuiltInShape::Glider, RIGID, settings(6, seed));
        let (s, c) = angle.sin_cos();
        let shift = Vector2::new(x, y) * scale;
        let matrix = Matrix3::new(scale * c, -scale * s, shift.x, scale * s, scale * c, shift.y, 0.0, 0.0, 1.0);
        let map = Affine2::from_matrix_unchecked(matrix);
        let moved: Vec<_> = frames
            .iter()
            .map(|f| Frame { outline: f.outline.moved(&map).expect("regular"), ..f.clone() })
            .collect();
        let (plain, turned) = (filtered(MotionModel::Rigid, &frames), filtered(MotionModel::Rigid, &moved));
        let expected = matrix * plain.estimate().expect("an estimate").generator() * map.inverse().matrix();
        let estimate = turned.estimate().expect("an estimate");
        let difference = estimate.generator() - expected;
        // The picture that cells are looked up in does not turn along, so that a point may come to another cell.
        for ((i, j), size) in [((0, 1), 1.0), ((0, 2), scale * 6.0), ((1, 2), scale * 6.0)] {
            prop_assert!(difference[(i, j)].abs() < 0.02 * size, "{difference}");
        }
    }

    #[test]
    fn whatever_comes_numbers_stay_finite(
        seeds in proptest::collection::vec((0_u64..1000, 0_usize..4, 0.01_f64..3.0), 2..10),
        which in 0_usize..4,
    ) {
        let mut filter = filter(MotionModel::ALL[which]);
        let mut time = 0.0;
        for (seed, kind, dt) in seeds {
            time += dt;
            let (noise, points) = [(0.0, 400), (0.3, 50), (0.005, 12), (1e-7, 30)][kind];
            let settings = Settings { noise, points, outliers: 0.3, ..settings(1, seed) };
            let shape = [BuiltInShape::Bird, BuiltInShape::Square, BuiltInShape::Circle, BuiltInShape::Van][kind];
            let frames = frames_of(shape, RigidMotion::default(), settings);
            filter.step(time, &frames[0].outline).expect("increasing times");
            if let Some(estimate) = filter.estimate() {
                prop_assert!(estimate.values().iter().all(|v| v.is_finite()));
                prop_assert!(estimate.parameters().all(|p| p.standard_deviation.is_none_or(f64::is_finite)));
            }
            prop_assert!(filter.pose().expect("a pose").matrix().iter().all(|e| e.is_finite()));
        }
    }
}
