//! A plane in space against the rigid motion of its points, and its Riccati equation against an integrator.
use freeform_riccati::{
    DynamicsError, FlowIntegrator, PinholeCamera, PlaneMotion, PlaneSolutions, line_rate, moved_line,
};
use nalgebra::{Complex, Matrix3, Matrix4, Point2, Vector3, Vector4};
use proptest::prelude::*;

fn any_plane() -> impl Strategy<Value = PlaneMotion> {
    let vector = || prop::array::uniform3(-1.0..1.0_f64).prop_map(Vector3::from);
    (vector(), vector(), prop::array::uniform2(-0.8..0.8_f64)).prop_map(|(w, v, [nx, ny])| PlaneMotion {
        angular_velocity: 1.5 * w,
        velocity: 0.3 * v,
        normal: Vector3::new(nx, ny, 1.0),
    })
}

/// Where a point of the plane is that is seen at `p`.
fn in_space(plane: &PlaneMotion, p: &Point2<f64>) -> Vector3<f64> {
    let ray = Vector3::new(p.x, p.y, 1.0);
    ray / plane.normal.dot(&ray)
}

fn without_identity(generator: &Matrix3<f64>) -> Matrix3<f64> {
    generator - Matrix3::identity() * (generator.trace() / 3.0)
}

proptest! {
    #[test]
    fn the_picture_of_the_moved_plane_is_the_moved_picture(
        plane in any_plane(), x in -0.3..0.3_f64, y in -0.3..0.3_f64, seconds in 0.0..1.0_f64,
    ) {
        let p = Point2::new(x, y);
        // Independent of the closed form: the exponential of the motion of space as a 4 x 4 matrix.
        let mut twist = Matrix4::zeros();
        twist.fixed_view_mut::<3, 3>(0, 0).copy_from(&plane.angular_velocity.cross_matrix());
        twist.fixed_view_mut::<3, 1>(0, 3).copy_from(&plane.velocity);
        let start = in_space(&plane, &p);
        let moved = (twist * seconds).exp() * Vector4::new(start.x, start.y, start.z, 1.0);
        prop_assume!(moved.z > 0.1);
        let seen = plane.flow(seconds) * p;
        prop_assert!((seen - Point2::new(moved.x / moved.z, moved.y / moved.z)).norm() < 1e-11 * (1.0 + seen.coords.norm()));
        // The point is still on the plane.
        prop_assert!((plane.after(seconds).normal.dot(&moved.xyz()) - 1.0).abs() < 1e-10 * (1.0 + moved.norm()));
    }

    #[test]
    fn the_flow_is_that_of_the_generator_that_changes_with_the_normal(plane in any_plane(), seconds in 0.1..0.6_f64) {
        prop_assume!((0..10).all(|k| plane.after(0.1 * seconds * f64::from(k)).normal.norm() < 10.0));
        let integrator = FlowIntegrator::new(1e-13).expect("a tolerance");
        let flow = integrator.flow(|time| plane.after(time).generator(), 0.0, seconds).expect("smooth").map;
        let (flow, closed) = (flow.into_inner(), plane.flow(seconds).into_inner());
        let (flow, closed) = (flow / flow.norm(), closed / closed.norm());
        prop_assert!((flow - closed).amax() < 1e-10, "{flow} {closed}");
    }

    #[test]
    fn the_normal_obeys_its_riccati_equation(plane in any_plane(), seconds in 0.0..0.6_f64) {
        prop_assume!((0..12).all(|k| plane.after(0.1 * seconds * f64::from(k)).normal.norm() < 10.0));
        let h = 1e-5;
        let difference = (plane.after(seconds + h).normal - plane.after(seconds - h).normal) / (2.0 * h);
        let rate = plane.after(seconds).normal_rate();
        prop_assert!((difference - rate).norm() < 1e-6 * (1.0 + rate.norm()), "{difference} {rate}");
    }

    #[test]
    fn lines_of_the_picture_move_by_the_same_riccati_equations_with_a_generator_that_changes(
        plane in any_plane(), l in prop::array::uniform2(0.2..1.0_f64), k in prop::array::uniform2(-0.5..0.5_f64),
    ) {
        let line = freeform_decompose::Line { l: Complex::new(l[0], l[1]), k: Complex::new(k[0], k[1]) };
        let h = 1e-5;
        let at = |time: f64| moved_line(&line, &plane.flow(time)).expect("complex lines stay").0;
        let rate = line_rate(&plane.generator(), &line);
        let difference = (at(h).l - at(-h).l) / (2.0 * h);
        prop_assert!((difference - rate.l).norm() < 1e-5 * (1.0 + rate.l.norm()), "{difference} {}", rate.l);
        let difference = (at(h).k - at(-h).k) / (2.0 * h);
        prop_assert!((difference - rate.k).norm() < 1e-5 * (1.0 + rate.k.norm()), "{difference} {}", rate.k);
    }

    #[test]
    fn one_of_two_solutions_is_the_motion_and_both_move_the_picture_alike_at_first_and_differently_later(
        plane in any_plane(), free in -1.0..1.0_f64,
    ) {
        let (v, n) = (plane.velocity, plane.normal);
        // Not nearly along each other, where the two fall together.
        prop_assume!(v.norm() > 0.05 && v.cross(&n).norm() > 0.1 * v.norm() * n.norm() && (v.z / v.norm()).abs() > 0.05);
        let generator = plane.generator();
        let PlaneSolutions::Two(solutions) = PlaneMotion::of_generator(&(generator + free * Matrix3::identity())) else {
            return Err(TestCaseError::fail("two solutions"));
        };
        for solution in solutions {
            let off = without_identity(&solution.generator()) - without_identity(&generator);
            prop_assert!(off.amax() < 1e-9, "{off}");
            prop_assert!((solution.normal.z - 1.0).abs() < 1e-12);
        }
        let distance = |other: &PlaneMotion| {
            (other.angular_velocity - plane.angular_velocity).norm() + (other.velocity - v).norm() + (other.normal - n).norm()
        };
        let [one, other] = solutions.map(|solution| distance(&solution));
        prop_assert!(one.min(other) < 1e-7 && one.max(other) > 1e-3, "{one} {other}");
        let [one, other] = solutions.map(|solution| without_identity(&solution.after(0.05).generator()));
        prop_assert!((one - other).amax() > 1e-9, "{one} {other}");
    }
}

#[test]
fn a_turn_alone_tells_of_no_plane_and_a_plane_that_moves_along_its_normal_is_the_only_one() {
    let turning = PlaneMotion {
        angular_velocity: Vector3::new(0.3, -0.2, 1.0),
        velocity: Vector3::zeros(),
        normal: Vector3::new(0.2, 0.1, 1.0),
    };
    let PlaneSolutions::Turn { angular_velocity } = PlaneMotion::of_generator(&turning.generator()) else {
        panic!("a turn")
    };
    assert!((angular_velocity - turning.angular_velocity).norm() < 1e-12);
    let approaching = PlaneMotion { velocity: -0.2 * turning.normal, ..turning };
    let PlaneSolutions::One(only) = PlaneMotion::of_generator(&approaching.generator()) else { panic!("one plane") };
    assert!((only.normal - approaching.normal).norm() < 1e-6 && (only.velocity - approaching.velocity).norm() < 1e-6);
}

#[test]
fn slow_turns_are_as_exact_as_fast_ones() {
    let plane = |rate: f64| PlaneMotion {
        angular_velocity: rate * Vector3::new(0.6, 0.0, 0.8),
        velocity: Vector3::new(0.1, -0.2, 0.3),
        normal: Vector3::new(0.2, 0.1, 1.0),
    };
    // On both sides of where the series take over.
    let [below, above] = [0.999_999e-2, 1.000_001e-2].map(|rate| plane(rate).flow(1.0).into_inner());
    assert!((below - above).amax() < 1e-7);
    let slope = (above - below) / 2e-8;
    let expected = (plane(1.1e-2).flow(1.0).into_inner() - plane(0.9e-2).flow(1.0).into_inner()) / 2e-3;
    assert!((slope - expected).amax() < 1e-4, "{slope} {expected}");
}

proptest! {
    #[test]
    fn the_sensitivities_of_the_flow_of_a_plane_are_its_derivatives(plane in any_plane(), seconds in 0.01..2.0_f64, slow in any::<bool>()) {
        let plane = PlaneMotion { angular_velocity: plane.angular_velocity * if slow { 3e-3 } else { 1.0 }, ..plane };
        let parameters = plane.parameters();
        prop_assert_eq!(PlaneMotion::of_parameters(parameters), plane);
        let step = 1e-5;
        for (index, found) in plane.flow_sensitivities(seconds).into_iter().enumerate() {
            let flow = |change: f64| {
                let mut moved = parameters;
                moved[index] += change;
                PlaneMotion::of_parameters(moved).flow(seconds).into_inner()
            };
            let difference = (flow(step) - flow(-step)) / (2.0 * step);
            prop_assert!((found - difference).amax() < 1e-8 * (1.0 + difference.amax()), "{index}: {found} {difference}");
        }
    }

    #[test]
    fn a_plane_in_other_lengths_moves_the_picture_alike(plane in any_plane(), lengths in 0.2..5.0_f64, seconds in 0.0..1.0_f64) {
        let other = PlaneMotion { velocity: plane.velocity * lengths, normal: plane.normal / lengths, ..plane };
        let back = other.scaled_to_axis().expect("not edge on");
        prop_assert!((back.velocity - plane.velocity).norm() + (back.normal - plane.normal).norm() < 1e-14);
        prop_assert!((other.flow(seconds).into_inner() - plane.flow(seconds).into_inner()).amax() < 1e-13);
    }
}

#[test]
fn a_camera_refuses_lengths_that_no_lens_has_and_its_maps_undo_each_other() {
    for focal in [0.0, -800.0, f64::NAN, f64::INFINITY] {
        assert!(
            matches!(PinholeCamera::new(focal, Point2::origin()), Err(DynamicsError::FocalLength { .. })),
            "{focal}"
        );
    }
    let nowhere = PinholeCamera::new(800.0, Point2::new(f64::NAN, 0.0));
    assert!(matches!(nowhere, Err(DynamicsError::PrincipalPoint { .. })));
    let camera = PinholeCamera::new(800.0, Point2::new(320.0, 240.0)).expect("a camera");
    assert!((camera.to_picture() * camera.from_picture() - Matrix3::identity()).amax() < 1e-15);
}
