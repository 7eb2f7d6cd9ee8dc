//! Motions, the camera and the pose of the object.
use std::f64::consts::FRAC_PI_2;

use freeform_riccati::{AffineMotion, DynamicsError, ProjectiveMotion, RigidMotion};
use freeform_sim_camera::{BuiltInShape, Camera, Motion, PaperExperiment, Scene, Settings, SimulationError, Simulator};
use nalgebra::{Affine2, Matrix3, Point2, Projective2, TCategory, Transform, Translation2};
use proptest::prelude::*;

fn difference<A: TCategory, B: TCategory>(a: &Transform<f64, A, 2>, b: &Transform<f64, B, 2>) -> f64 {
    (a.matrix() - b.matrix()).amax()
}

#[test]
fn the_camera_scales_the_translation_and_leaves_the_rotation() {
    let scene = PaperExperiment::FLIGHT_BIRD.scene(0.1).expect("a good scale");
    let motion = scene.image_motion(7.0);
    assert_eq!((motion.a2, motion.a3), (FRAC_PI_2, -FRAC_PI_2));
    assert!((motion.b1 + 0.3).abs() < 1e-15 && (motion.b2 - 0.4).abs() < 1e-15);
    assert!(difference(&scene.true_pose(1.3), &motion.flow(1.3)) < 1e-14);
}

#[test]
fn positive_omega_turns_clockwise() {
    let turn = RigidMotion { omega: 1.0, b1: 0.0, b2: 0.0 };
    let scene = Scene::new(BuiltInShape::Square, turn, Camera::default());
    let right = scene.true_pose(FRAC_PI_2) * Point2::new(1.0, 0.0);
    assert!((right - Point2::new(0.0, -1.0)).norm() < 1e-14);
}

#[test]
fn the_object_starts_where_the_initial_pose_puts_it() {
    let start = nalgebra::convert(Translation2::new(2.0, -1.0));
    let scene = Scene::new(BuiltInShape::Bird, RigidMotion::default(), Camera::default());
    assert!(scene.true_pose(0.0) == Projective2::identity());
    let moved = scene.clone().with_initial_pose(start);
    for (p, q) in scene.true_outline(5.0, 20).iter().zip(moved.true_outline(5.0, 20)) {
        assert!((q - p - nalgebra::Vector2::new(2.0, -1.0)).norm() < 1e-14);
    }
}

#[test]
fn a_swinging_object_turns_by_the_integral_of_its_rate() {
    let swing = Motion::varying(|t| RigidMotion { omega: t.cos(), b1: 0.0, b2: 0.0 });
    let turned = swing.flow(0.0, 2.0) * Point2::new(1.0, 0.0);
    let angle = -(2.0_f64.sin());
    assert!((turned - Point2::new(angle.cos(), angle.sin())).norm() < 1e-12);
}

#[test]
fn a_varying_motion_is_the_limit_of_many_short_constant_ones() {
    // Generators at different times do not commute here.
    let at =
        |t: f64| AffineMotion { a1: 0.2 * t.sin(), a2: 1.0 + t, a3: -1.0 + 0.5 * t * t, a4: -0.3, b1: t, b2: 1.0 - t };
    let steps = 20_000;
    let h = 1.5 / f64::from(steps);
    let short = (0..steps).map(|k| at((f64::from(k) + 0.5) * h).flow(h));
    let product = short.fold(Affine2::identity(), |flow, step| step * flow);
    assert!(difference(&Motion::varying(at).flow(0.0, 1.5), &product) < 1e-8);
}

#[test]
fn a_varying_motion_that_stops_being_finite_is_refused() {
    for bad in [f64::INFINITY, f64::NEG_INFINITY, f64::NAN, 1e308] {
        let motion = Motion::varying(move |t| RigidMotion { omega: 0.0, b1: if t < 0.4 { 1.0 } else { bad }, b2: 0.0 });
        assert!(motion.try_flow(0.0, 0.3).is_ok());
        assert!(motion.try_flow(0.0, 1.0).is_err() || bad == 1e308);
        assert!(motion.flow(0.0, 1.0).matrix().iter().any(|e| e.is_nan() || e.abs() >= 1e300));
        let scene = Scene::new(BuiltInShape::Bird, motion, Camera::default());
        let settings = Settings { fps: 10.0, ..Settings::default() };
        let error = Simulator::new(scene, settings).expect_err("refused");
        let expected = matches!(error, SimulationError::Motion(DynamicsError::GeneratorNotFinite { time }) if time >= 0.4)
            || bad == 1e308;
        assert!(expected, "{error}");
    }
}

#[test]
fn phases_must_start_at_zero_and_follow_each_other() {
    let rest = AffineMotion::default();
    assert!(matches!(Motion::piecewise::<AffineMotion>(vec![]), Err(SimulationError::NoFirstPhase)));
    assert!(matches!(Motion::piecewise(vec![(1.0, rest)]), Err(SimulationError::NoFirstPhase)));
    let order = |starts: &[f64]| Motion::piecewise(starts.iter().map(|s| (*s, rest)).collect());
    assert!(matches!(order(&[0.0, 2.0, 2.0]), Err(SimulationError::PhaseOrder { index: 2, .. })));
    assert!(matches!(order(&[0.0, f64::NAN]), Err(SimulationError::PhaseOrder { index: 1, .. })));
    assert!(order(&[0.0, 1.0, 2.0]).is_ok());
}

#[test]
fn a_camera_needs_a_positive_scale() {
    for scale in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        let error = Camera::new(scale).expect_err("not a scale");
        assert!(matches!(error, SimulationError::OutOfRange { setting: "camera scale", .. }));
    }
}

#[test]
fn the_experiments_are_those_of_the_paper() {
    let names = PaperExperiment::ALL.map(|e| e.shape.name());
    assert_eq!(names, ["bird", "glider", "glider", "phone"]);
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_3};
    let motions = PaperExperiment::ALL.map(|e| [e.motion.omega, e.motion.b1, e.motion.b2]);
    let printed = [[FRAC_PI_2, -3.0, 4.0], [-FRAC_PI_3, 0.0, 4.0], [-FRAC_PI_3, 4.0, 0.0], [-2.0, 4.0, 0.0]];
    assert_eq!(motions, printed);
}

fn any_motion() -> impl Strategy<Value = AffineMotion> {
    prop::array::uniform6(-2.0..2.0_f64).prop_map(|[a1, a2, a3, a4, b1, b2]| AffineMotion { a1, a2, a3, a4, b1, b2 })
}

proptest! {
    #[test]
    fn flows_follow_each_other(motion in any_motion(), other in any_motion(), cut in 0.0..1.0_f64) {
        let kinds = [
            Motion::constant(motion),
            Motion::piecewise(vec![(0.0, motion), (0.4, other), (0.7, motion)]).expect("increasing"),
            Motion::varying(move |t| AffineMotion { a2: motion.a2 * t.cos(), b1: other.b1 * t, ..motion }),
        ];
        for kind in kinds {
            let parts = kind.flow(cut, 1.0) * kind.flow(0.0, cut);
            let whole = kind.flow(0.0, 1.0);
            prop_assert!(difference(&parts, &whole) < 1e-9 * whole.matrix().amax(), "{kind:?}");
        }
    }

    #[test]
    fn a_motion_in_phases_runs_them_one_after_the_other(first in any_motion(), second in any_motion()) {
        let phases = Motion::piecewise(vec![(0.0, first), (0.5, second)]).expect("increasing");
        let expected = second.flow(0.75) * first.flow(0.5);
        prop_assert!(difference(&phases.flow(0.0, 1.25), &expected) < 1e-11 * expected.matrix().amax());
        prop_assert_eq!((phases.at(0.49), phases.at(0.5)), (first.into(), second.into()));
    }

    #[test]
    fn a_constant_motion_is_a_varying_one_that_does_not_vary(motion in any_motion()) {
        let difference = difference(&Motion::varying(move |_| motion).flow(0.0, 0.8), &motion.flow(0.8));
        prop_assert!(difference < 1e-10);
    }

    #[test]
    fn the_image_of_the_moved_point_is_the_moved_image(
        motion in any_motion(), scale in 0.01..10.0_f64, x in -5.0..5.0_f64, y in -5.0..5.0_f64,
    ) {
        let camera = Camera::new(scale).expect("positive");
        let (space, motion) = (Point2::new(x, y), ProjectiveMotion::from(motion));
        let flow = motion.flow(0.6);
        let seen = camera.project(&(flow * space));
        prop_assert!((camera.image_map(&flow) * camera.project(&space) - seen).norm() < 1e-10 * (1.0 + seen.coords.norm()));
        let image_flow = camera.image_motion(&motion).flow(0.6);
        prop_assert!(difference(&camera.image_map(&flow), &image_flow) < 1e-11 * image_flow.matrix().amax());
        prop_assert_eq!(camera.image_map(&Projective2::from_matrix_unchecked(Matrix3::identity())), Projective2::identity());
    }
}

fn any_projective_motion() -> impl Strategy<Value = ProjectiveMotion> {
    (any_motion(), prop::array::uniform2(-0.3..0.3_f64)).prop_map(|(motion, [c1, c2])| ProjectiveMotion {
        c1,
        c2,
        ..motion.into()
    })
}

proptest! {
    #[test]
    fn every_point_of_a_projective_motion_moves_by_the_field_of_its_generator(
        motion in any_projective_motion(), scale in 0.1..10.0_f64, x in -0.5..0.5_f64, y in -0.5..0.5_f64,
    ) {
        let scene = Scene::new(BuiltInShape::Bird, motion, Camera::new(scale).expect("positive"));
        let h = 1e-5;
        let at = |time: f64| scene.true_pose(time) * Point2::new(x, y);
        let difference = (at(0.3 + h) - at(0.3 - h)) / (2.0 * h);
        let velocity = scene.image_motion(0.3).velocity(&at(0.3));
        prop_assert!((difference - velocity).norm() < 1e-6 * (1.0 + velocity.norm()), "{difference} {velocity}");
    }
}

#[test]
fn an_object_that_comes_near_the_line_at_infinity_is_refused() {
    let run = |c1: f64| {
        let motion = ProjectiveMotion { c1, ..ProjectiveMotion::default() };
        let scene = Scene::new(BuiltInShape::Bird, motion, Camera::default());
        Simulator::new(scene, Settings { noise: 0.0, ..Settings::default() }).map(drop)
    };
    assert_eq!(run(0.1), Ok(()));
    // After 4 s a point at x = -0.4 has the depth 1 - 4 * 0.7 * 0.4.
    assert!(matches!(run(0.7), Err(SimulationError::PoseOutOfRange { .. })));
}

#[test]
fn a_plane_in_space_is_seen_where_the_rays_of_its_points_meet_the_picture() {
    use freeform_riccati::{PinholeCamera, PlaneMotion};
    use nalgebra::{Matrix4, Vector3, Vector4};

    let camera = PinholeCamera::new(800.0, Point2::new(320.0, 240.0)).expect("a camera");
    let plane = PlaneMotion::of_parameters([0.3, -0.2, 0.5, 0.1, 0.05, 0.12, 0.7, -0.4]);
    let scene = Scene::in_space(BuiltInShape::Van, plane, camera, 300.0);
    let unit = plane.normal.normalize();
    let seen_at = |x: Vector3<f64>| Point2::new(320.0 + 800.0 * x.x / x.z, 240.0 + 800.0 * x.y / x.z);
    let mut twist = Matrix4::zeros();
    twist.fixed_view_mut::<3, 3>(0, 0).copy_from(&plane.angular_velocity.cross_matrix());
    twist.fixed_view_mut::<3, 1>(0, 3).copy_from(&plane.velocity);
    for time in [0.0, 0.4, 1.3] {
        for body in scene.shape().sample(20, 0.0) {
            let start = scene.true_pose(0.0) * body;
            let ray = Vector3::new((start.x - 320.0) / 800.0, (start.y - 240.0) / 800.0, 1.0);
            let place = ray / plane.normal.dot(&ray);
            // The shape is flat on the tilted plane and keeps its lengths there, 300 pixels a unit at distance 1.
            let from_axis = place - Vector3::z();
            assert!(unit.dot(&from_axis).abs() < 1e-12);
            assert!((from_axis.norm() - 300.0 / 800.0 * body.coords.norm()).abs() < 1e-12);
            let moved = (twist * time).exp() * Vector4::new(place.x, place.y, place.z, 1.0);
            assert!((scene.true_pose(time) * body - seen_at(moved.xyz())).norm() < 1e-8);
        }
    }
    assert!(!scene.motion().is_constant());
    assert_eq!(scene.motion().plane(), Some(plane));
    // The generator that is told is that of the moment.
    let (h, body) = (1e-6, Point2::new(0.2, 0.1));
    let at = |time: f64| scene.true_pose(time) * body;
    let rate = (at(0.5 + h) - at(0.5 - h)) / (2.0 * h);
    assert!((rate - scene.image_motion(0.5).velocity(&at(0.5))).norm() < 1e-4);
}
