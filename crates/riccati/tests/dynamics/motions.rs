use approx::assert_relative_eq;
use freeform_riccati::{
    AffineMotion, CameraScale, DynamicsError, MotionModel, ProjectiveMotion, RigidMotion, SimilarityMotion,
};
use nalgebra::{Affine2, Matrix2, Matrix3, Point2};
use proptest::prelude::*;

use crate::support::{affine_motion, dop853, model_and_parameters};

#[test]
fn positive_omega_turns_clockwise_in_a_y_up_frame() {
    let motion = RigidMotion { omega: std::f64::consts::FRAC_PI_2, b1: 0.0, b2: 0.0 };
    assert_relative_eq!(motion.flow(1.0) * Point2::new(0.0, 1.0), Point2::new(1.0, 0.0), epsilon = 1e-15);
}

#[test]
fn closed_forms_agree_with_the_exponential_however_small_the_turn() {
    let sizes = [0.0, 1e-310, 1e-20, 1e-12, 1e-9, 3e-9, 1e-8, 1e-6, 1e-4, 1e-2, 0.5, 2.0, 7.0];
    for omega in sizes.into_iter().flat_map(|size| [size, -size]) {
        for sigma in [0.0, 1e-310, 1e-12, -1e-9, 1e-5, -0.3, 1.1] {
            for seconds in [-1.7, 0.0, 0.03, 1.0] {
                let motion = SimilarityMotion { sigma, omega, b1: -0.3, b2: 0.4 };
                let expected = AffineMotion::from(motion).flow(seconds);
                assert_relative_eq!(motion.flow(seconds), expected, epsilon = 1e-14, max_relative = 1e-13);
                if sigma == 0.0 {
                    let rigid = RigidMotion { omega, b1: -0.3, b2: 0.4 };
                    assert_eq!(rigid.flow(seconds), motion.flow(seconds));
                }
            }
        }
    }
}

#[test]
fn the_integral_of_the_linear_flow_grows_by_the_linear_flow() {
    let parameters = [[0.3, 1.4, -0.2, 0.1, 5.0, -3.0], [-0.4, 2.2, -1.9, 0.6, 0.0, 1.0]];
    for model in [MotionModel::Rigid, MotionModel::Similarity, MotionModel::Affine] {
        for parameters in parameters {
            let parameters = &parameters[..model.parameter_count()];
            let along = |seconds: f64| model.linear_flow_with_integral(parameters, seconds).1;
            assert_eq!(along(0.0), Matrix2::zeros());
            for seconds in [-0.7, 0.01, 0.9, 2.0] {
                let step = 1e-3;
                let grown = (along(seconds + step) - along(seconds - step)) / (2.0 * step);
                let linear = model.linear_flow(parameters, seconds);
                assert_relative_eq!(grown, linear, epsilon = 1e-4);
                assert_relative_eq!(model.linear_flow_with_integral(parameters, seconds).0, linear, epsilon = 1e-14);
            }
        }
    }
}

#[test]
fn a_tiny_turn_bends_the_path_by_half_omega_t_squared() {
    for omega in [1e-3, 1e-7, 1e-9, 1e-11, 1e-15] {
        let shift = RigidMotion { omega, b1: 1.0, b2: 0.0 }.flow(1.0).matrix().column(2).into_owned();
        // y(1) = -(1 - cos omega) / omega = -omega / 2 (1 - omega^2 / 12 ...)
        assert_relative_eq!(shift.y, -omega / 2.0 * (1.0 - omega * omega / 12.0), max_relative = 1e-11);
        assert_relative_eq!(shift.x, 1.0 - omega * omega / 6.0, max_relative = 1e-12);
    }
}

#[test]
fn every_model_has_as_many_names_units_and_basis_matrices_as_parameters() {
    for (model, count) in MotionModel::ALL.into_iter().zip([3, 4, 6, 8]) {
        assert_eq!(model.parameter_count(), count);
        assert_eq!(model.parameter_names().len(), count);
        assert_eq!(model.units().len(), count);
        assert_eq!(model.basis().len(), count);
        for (name, unit) in model.parameter_names().iter().zip(model.units()) {
            assert_eq!(*unit == "rad/s", *name == "omega");
        }
    }
}

#[test]
fn the_models_and_the_motion_types_mean_the_same_parameters() {
    let rigid = RigidMotion { omega: 1.0, b1: 2.0, b2: 3.0 };
    assert_eq!(MotionModel::Rigid.generator(&[1.0, 2.0, 3.0]), rigid.generator());
    assert_eq!(MotionModel::Similarity.generator(&[0.0, 1.0, 2.0, 3.0]), rigid.generator());
    let similarity = SimilarityMotion { sigma: 4.0, ..rigid.into() };
    assert_eq!(MotionModel::Similarity.generator(&[4.0, 1.0, 2.0, 3.0]), similarity.generator());
    assert_eq!(AffineMotion::from(similarity).generator(), Matrix3::new(4., 1., 2., -1., 4., 3., 0., 0., 0.));
    let affine = AffineMotion { a1: 1., a2: 2., a3: 3., a4: 4., b1: 5., b2: 6. };
    assert_eq!(MotionModel::Affine.generator(&[1., 2., 3., 4., 5., 6.]), affine.generator());
    assert_eq!(ProjectiveMotion::from(affine).generator(), affine.generator());
    let projective = ProjectiveMotion { c1: 7., c2: 8., ..affine.into() };
    assert_eq!(MotionModel::Projective.generator(&[1., 2., 3., 4., 5., 6., 7., 8.]), projective.generator());
    assert_eq!(projective.generator(), Matrix3::new(1., 2., 5., 3., 4., 6., 7., 8., 0.));
}

#[test]
fn a_camera_scale_that_is_no_positive_number_is_refused() {
    for scale in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        assert!(matches!(CameraScale::new(scale), Err(DynamicsError::CameraScale { .. })));
    }
}

#[test]
fn a_motion_that_is_not_finite_gives_a_map_that_is_not_finite() {
    for bad in [f64::NAN, f64::INFINITY] {
        let affine = AffineMotion { a2: bad, ..Default::default() };
        assert!(affine.flow(1.0).matrix().iter().any(|e| !e.is_finite()));
        let rigid = RigidMotion { omega: bad, ..Default::default() };
        assert!(rigid.flow(1.0).matrix().iter().any(|e| !e.is_finite()));
    }
}

proptest! {
    #[test]
    fn a_flow_carries_points_along_the_velocity_field(motion in affine_motion(), x in -1.0..1.0, y in -1.0..1.0) {
        let AffineMotion { a1, a2, a3, a4, b1, b2 } = motion;
        let end = dop853(|_, &[x, y]| [a1 * x + a2 * y + b1, a3 * x + a4 * y + b2], [x, y], 0.0, 1.0);
        prop_assert!((motion.flow(1.0) * Point2::new(x, y) - Point2::from(end)).norm() < 1e-12);
    }

    #[test]
    fn a_projective_flow_carries_points_along_its_quadratic_field(
        motion in affine_motion(), c in prop::array::uniform2(-0.2..0.2), x in -0.5..0.5, y in -0.5..0.5,
    ) {
        let motion = ProjectiveMotion { c1: c[0], c2: c[1], ..motion.into() };
        let rate = |_: f64, &[x, y]: &[f64; 2]| {
            let w = motion.c1 * x + motion.c2 * y;
            [motion.a1 * x + motion.a2 * y + motion.b1 - x * w, motion.a3 * x + motion.a4 * y + motion.b2 - y * w]
        };
        let end = Point2::from(dop853(rate, [x, y], 0.0, 0.7));
        prop_assert!((motion.flow(0.7) * Point2::new(x, y) - end).norm() < 1e-12 * end.coords.norm().max(1.0));
    }

    #[test]
    fn flows_for_two_times_compose_to_the_flow_for_their_sum(
        (model, parameters) in model_and_parameters(), s in -1.0..1.0, t in -1.0..1.0,
    ) {
        let once = model.flow(&parameters, s + t);
        let twice = model.flow(&parameters, s) * model.flow(&parameters, t);
        prop_assert!((once.matrix() - twice.matrix()).amax() < 1e-13 * once.matrix().amax().max(1.0));
    }

    #[test]
    fn the_flow_of_every_model_is_the_exponential_of_its_generator(
        (model, parameters) in model_and_parameters(), t in -1.5..1.5_f64,
    ) {
        let expected = (model.generator(&parameters) * t).exp();
        let map = model.flow(&parameters, t);
        let affine: Option<Affine2<f64>> = nalgebra::try_convert(map);
        prop_assert_eq!(affine.is_some(), model != MotionModel::Projective);
        let flow = *map.matrix();
        prop_assert!((flow - expected).amax() < 1e-13 * expected.amax());
        if model != MotionModel::Projective {
            prop_assert_eq!(flow.row(2).into_owned(), nalgebra::RowVector3::new(0.0, 0.0, 1.0));
        }
    }

    #[test]
    fn a_rigid_flow_keeps_lengths_and_a_similarity_scales_them(
        sigma in -0.5..0.5, omega in -4.0..4.0, b1 in -4.0..4.0, b2 in -4.0..4.0, t in -2.0..2.0,
    ) {
        let flow = SimilarityMotion { sigma, omega, b1, b2 }.flow(t);
        let linear = flow.matrix().fixed_view::<2, 2>(0, 0).into_owned();
        let scale = (2.0 * sigma * t).exp();
        prop_assert!((linear.transpose() * linear - Matrix2::identity() * scale).amax() < 1e-14 * scale);
    }

    #[test]
    fn a_camera_sees_the_image_of_the_motion_in_space(
        motion in affine_motion(), c in prop::array::uniform2(-0.1..0.1), scale in 0.05..3.0, x in -1.0..1.0, y in -1.0..1.0,
    ) {
        let motion = ProjectiveMotion { c1: c[0], c2: c[1], ..motion.into() };
        let camera = CameraScale::new(scale).expect("positive");
        let seen = motion.in_image(camera);
        let image = seen.flow(0.5) * Point2::new(x * scale, y * scale);
        let space = motion.flow(0.5) * Point2::new(x, y);
        prop_assert!((image - space * scale).norm() < 1e-13 * image.coords.norm().max(1.0));
        prop_assert!((seen.in_space(camera).generator() - motion.generator()).amax() < 1e-15);
    }
}
