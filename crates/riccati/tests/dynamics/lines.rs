use freeform_decompose::Line;
use freeform_riccati::{
    DynamicsError, ProjectiveMotion, RealVariables, RigidMotion, RotationCoordinate, SimilarityMotion, line_flow,
    line_rate, moved_line,
};
use nalgebra::{Complex, Matrix3, Point2, Projective2, Vector4};
use proptest::prelude::*;

use crate::support::{affine_map, affine_motion, distance, dop853, generator, line};

/// The Riccati equations as a real system of l and k.
fn riccati(generator: &Matrix3<f64>, state: &[f64; 4]) -> [f64; 4] {
    let rate = line_rate(generator, &Line::from(RealVariables::from(Vector4::from(*state))));
    [rate.l.re, rate.l.im, rate.k.re, rate.k.im]
}

fn close(a: &Line, b: &Line, tolerance: f64) -> bool {
    distance(a.l, b.l) < tolerance && distance(a.k, b.k) < tolerance
}

#[test]
fn a_real_line_escapes_to_infinity_in_finite_time() {
    // l = 0, the line x = 0, turned by a quarter: y = 0 has no x.
    let vertical = Line { l: Complex::new(0.0, 0.0), k: Complex::new(0.0, 0.0) };
    let quarter_turn = Projective2::from_matrix_unchecked(Matrix3::new(0., 1., 0., -1., 0., 0., 0., 0., 1.));
    assert!(matches!(moved_line(&vertical, &quarter_turn), Err(DynamicsError::LineLeftChart { .. })));
}

#[test]
fn a_singular_map_moves_no_line() {
    let line = Line { l: Complex::new(0.0, 1.0), k: Complex::new(0.0, 0.0) };
    for map in [Matrix3::zeros(), Matrix3::repeat(f64::NAN)] {
        let moved = moved_line(&line, &Projective2::from_matrix_unchecked(map));
        assert!(matches!(moved, Err(DynamicsError::SingularMap { .. })));
    }
    assert!(line_flow(&Matrix3::repeat(f64::NAN), &line, 1.0).is_err());
}

proptest! {
    #[test]
    fn the_closed_form_solves_the_riccati_equations(motion in affine_motion(), line in line(), t in 0.1..1.2) {
        let a = motion.generator();
        let start = <[f64; 4]>::from(RealVariables::from(line).state());
        let integrated = RealVariables::from(Vector4::from(dop853(|_, y| riccati(&a, y), start, 0.0, t)));
        let (moved, _) = line_flow(&a, &line, t).expect("complex lines stay in the chart");
        prop_assert!(close(&moved, &integrated.into(), 1e-12), "{moved:?} {integrated:?}");
    }

    #[test]
    fn the_perspective_extension_solves_its_riccati_equations(a in generator(), line in line(), t in 0.1..0.8) {
        let start = <[f64; 4]>::from(RealVariables::from(line).state());
        let integrated = RealVariables::from(Vector4::from(dop853(|_, y| riccati(&a, y), start, 0.0, t)));
        let (moved, _) = line_flow(&a, &line, t).expect("complex lines stay in the chart");
        prop_assert!(close(&moved, &integrated.into(), 1e-12), "{moved:?} {integrated:?}");
    }

    #[test]
    fn the_divided_factor_integrates_its_own_rate(a in generator(), line in line(), t in 0.1..0.8) {
        let mut start = [0.0; 6];
        start[..4].copy_from_slice(RealVariables::from(line).state().as_slice());
        let end = dop853(
            |_, y| {
                let state = [y[0], y[1], y[2], y[3]];
                let [l1, l2, k1, k2] = riccati(&a, &state);
                let log_p = line_rate(&a, &Line::from(RealVariables::from(Vector4::from(state)))).log_p;
                [l1, l2, k1, k2, log_p.re, log_p.im]
            },
            start,
            0.0,
            t,
        );
        let (_, s) = line_flow(&a, &line, t).expect("complex lines stay in the chart");
        prop_assert!(distance(Complex::new(end[4], end[5]).exp(), s) < 1e-12);
    }

    #[test]
    fn a_moved_line_vanishes_at_the_moved_points(a in generator(), line in line(), x in -1.0..1.0, y in -1.0..1.0) {
        let map = Projective2::from_matrix_unchecked((a * 0.6).exp());
        let (moved, s) = moved_line(&line, &map).expect("complex lines stay in the chart");
        let w = (map.matrix() * nalgebra::Vector3::new(x, y, 1.0)).z;
        let before = line.evaluate(&Point2::new(x, y));
        let after = moved.evaluate(&(map * Point2::new(x, y))) * s * w;
        prop_assert!(distance(after, before) < 1e-12);
        let (flowed, factor) = line_flow(&a, &line, 0.6).expect("complex lines stay in the chart");
        prop_assert!(close(&flowed, &moved, 1e-12) && distance(factor, s) < 1e-12);
    }

    #[test]
    fn affine_maps_move_lines_here_as_in_the_decomposition(map in affine_map(), line in line()) {
        let (moved, s) = moved_line(&line, &map).expect("complex lines stay in the chart");
        let (expected, factor) = line.moved(&map).expect("complex lines stay in the chart");
        prop_assert!(close(&moved, &expected, 1e-13) && distance(s, factor) < 1e-13);
    }

    #[test]
    fn line_flows_compose(a in generator(), line in line(), s in -0.5..0.5, t in -0.5..0.5) {
        let (once, p) = line_flow(&a, &line, s + t).expect("in the chart");
        let (first, q) = line_flow(&a, &line, s).expect("in the chart");
        let (second, r) = line_flow(&a, &first, t).expect("in the chart");
        prop_assert!(close(&once, &second, 1e-11) && distance(q * r, p) < 1e-12);
    }

    #[test]
    fn the_real_equations_are_the_complex_ones(motion in affine_motion(), line in line()) {
        let expected = Vector4::from(riccati(&motion.generator(), &RealVariables::from(line).state().into()));
        let rate = RealVariables::from(line).rate(&motion);
        prop_assert!((rate - expected).amax() < 1e-14 * expected.amax().max(1.0));
    }

    #[test]
    fn real_variables_hold_a_conjugate_pair(line in line()) {
        let (first, second) = RealVariables::from(line).pair();
        prop_assert_eq!(first, line);
        prop_assert_eq!(second, line.conjugate());
    }

    #[test]
    fn rotation_turns_w_at_constant_rate_and_translation_leaves_it(
        line in line(), omega in -4.0..4.0, b1 in -2.0..2.0, b2 in -2.0..2.0, t in -2.0..2.0,
    ) {
        let motion = RigidMotion { omega, b1, b2 };
        let start = RotationCoordinate::of_slope(line.l);
        let (moved, _) = moved_line(&line, &motion.flow(t)).expect("in the chart");
        let end = RotationCoordinate::of_slope(moved.l);
        let expected = start.rotated(omega, t);
        prop_assert!(distance(end.0, expected.0) < 1e-12 * expected.magnitude().max(1.0));
        prop_assert!((end.magnitude() / start.magnitude() - 1.0).abs() < 1e-11);
    }

    #[test]
    fn growth_leaves_w_unchanged(line in line(), sigma in -1.0..1.0) {
        let flow = SimilarityMotion { sigma, ..Default::default() }.flow(1.0);
        let (moved, _) = moved_line(&line, &flow).expect("in the chart");
        let [before, after] = [line.l, moved.l].map(|l| RotationCoordinate::of_slope(l).0);
        prop_assert!(distance(after, before) < 1e-13);
    }

    #[test]
    fn the_rotation_coordinate_and_the_slope_are_one_to_one(line in line()) {
        let w = RotationCoordinate::of_slope(line.l);
        prop_assert!(distance(w.slope(), line.l) < 1e-13);
        prop_assert_eq!(w.magnitude() < 1.0, line.l.im > 0.0);
        let conjugate = RotationCoordinate::of_slope(line.l.conj()).0;
        prop_assert!(distance(conjugate * w.0.conj(), Complex::new(1.0, 0.0)) < 1e-13);
    }

    #[test]
    fn a_projective_motion_without_c_moves_lines_like_the_affine_one(motion in affine_motion(), line in line()) {
        let projective = ProjectiveMotion::from(motion);
        let (a, b) = (motion.flow(0.7), projective.flow(0.7));
        prop_assert_eq!(moved_line(&line, &a), moved_line(&line, &b));
    }
}
