use freeform_riccati::{
    AffineMotion, DynamicsError, FlowIntegrator, RealVariables, RigidMotion, line_rate, moved_line,
};
use nalgebra::{Matrix2, Matrix3, Vector4};
use proptest::prelude::*;

use crate::support::{distance, dop853, generator, line};

fn integrator() -> FlowIntegrator {
    FlowIntegrator::new(1e-13).expect("within the range")
}

#[test]
fn a_constant_motion_takes_one_step_and_gives_its_closed_form() {
    let motion = AffineMotion { a1: 0.1, a2: 0.5, a3: -0.4, a4: 0.2, b1: 0.3, b2: -0.1 };
    let flow = integrator().flow(|_| motion.generator(), 1.0, 2.5).expect("smooth");
    assert_eq!((flow.steps, flow.rejected_steps), (1, 0));
    assert!((flow.map.matrix() - motion.flow(1.5).matrix()).amax() < 1e-14);
}

#[test]
fn a_turn_at_changing_speed_ends_at_the_integral_of_the_speed() {
    // All generators commute, so the commutators say nothing of the error.
    let generator = |t: f64| RigidMotion { omega: 3.0 * (4.0 * t).cos(), b1: 0.0, b2: 0.0 }.generator();
    let flow = integrator().flow(generator, 0.0, 2.0).expect("smooth");
    let expected = RigidMotion { omega: 0.75 * 8.0_f64.sin(), b1: 0.0, b2: 0.0 }.flow(1.0);
    assert!((flow.map.matrix() - expected.matrix()).amax() < 1e-12);
    assert!(flow.steps > 1);
}

#[test]
fn halving_the_steps_divides_the_error_by_two_to_the_sixth() {
    let generator =
        |t: f64| Matrix3::new(0.1, t.cos(), 0.3, -(0.5 * t).exp() / 2.0, 0.2 * t, t.sin(), 0.1, 0.05 * t, 0.0);
    let exact = integrator().flow(generator, 0.0, 2.0).expect("smooth").map;
    let error = |steps: f64| {
        let fixed = FlowIntegrator::new(1e-2).and_then(|i| i.with_longest_step(2.0 / steps)).expect("valid");
        let flow = fixed.flow(generator, 0.0, 2.0).expect("smooth");
        assert_eq!((flow.steps as f64, flow.rejected_steps), (steps, 0));
        (flow.map.matrix() - exact.matrix()).amax()
    };
    for steps in [2.0, 4.0] {
        let order = (error(steps) / error(2.0 * steps)).log2();
        assert!((5.6..6.4).contains(&order), "order {order} from {steps} steps");
    }
}

#[test]
fn a_rigid_motion_stays_rigid_while_it_changes() {
    let generator = |t: f64| RigidMotion { omega: t.sin() * 5.0, b1: t, b2: (3.0 * t).cos() }.generator();
    let loose = FlowIntegrator::new(1e-4).expect("within the range").flow(generator, 0.0, 6.0).expect("smooth");
    let linear = loose.map.matrix().fixed_view::<2, 2>(0, 0).into_owned();
    assert!((linear.transpose() * linear - Matrix2::identity()).amax() < 1e-13);
    assert_eq!(loose.map.matrix().row(2).into_owned(), nalgebra::RowVector3::new(0.0, 0.0, 1.0));
}

#[test]
fn a_motion_without_a_limit_fails_with_the_time_at_which_it_does() {
    let motion = |t: f64| RigidMotion { omega: 1.0 / (t - 0.5).abs().powf(1.5), b1: 1.0, b2: 0.0 }.generator();
    match integrator().flow(motion, 0.0, 1.0) {
        Err(DynamicsError::StepTooSmall { time, .. } | DynamicsError::GeneratorNotFinite { time }) => {
            assert!((time - 0.5).abs() < 1e-3, "{time}");
        }
        other => panic!("{other:?}"),
    }
    let undefined = |t: f64| RigidMotion { omega: (0.7 - t).sqrt(), b1: 0.0, b2: 0.0 }.generator();
    assert!(matches!(
        integrator().flow(undefined, 0.0, 1.0),
        Err(DynamicsError::GeneratorNotFinite { time }) if time > 0.7
    ));
}

#[test]
fn settings_and_times_out_of_range_are_refused() {
    for tolerance in [0.0, 1e-17, 0.5, f64::NAN] {
        assert!(matches!(FlowIntegrator::new(tolerance), Err(DynamicsError::Tolerance { .. })));
    }
    for step in [0.0, -1.0, f64::NAN] {
        assert!(matches!(integrator().with_longest_step(step), Err(DynamicsError::LongestStep { .. })));
    }
    let still = |_: f64| Matrix3::zeros();
    assert!(matches!(integrator().flow(still, 0.0, f64::NAN), Err(DynamicsError::GeneratorNotFinite { .. })));
    assert!(integrator().flow(|_| RigidMotion { omega: 1.0, b1: 0.0, b2: 0.0 }.generator(), -1e308, 1e308).is_err());
    let nothing = integrator().flow(still, 3.0, 3.0).expect("no time passes");
    assert_eq!((nothing.map.matrix(), nothing.steps), (&Matrix3::identity(), 0));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_changing_motion_carries_lines_along_the_riccati_equations(
        line in line(), a in generator(), b in generator(), from in -1.0..1.0, seconds in -0.7..0.7,
    ) {
        let motion = |t: f64| a + b * (2.0 * t).sin();
        let rate = |t: f64, y: &[f64; 4]| {
            let rate = line_rate(&motion(t), &RealVariables::from(Vector4::from(*y)).into());
            [rate.l.re, rate.l.im, rate.k.re, rate.k.im]
        };
        let end = dop853(rate, RealVariables::from(line).state().into(), from, from + seconds);
        let flow = integrator().flow(motion, from, from + seconds).expect("smooth");
        let (moved, _) = moved_line(&line, &flow.map).expect("in the chart");
        let expected = freeform_decompose::Line::from(RealVariables::from(Vector4::from(end)));
        prop_assert!(distance(moved.l, expected.l) < 1e-12 && distance(moved.k, expected.k) < 1e-12);
    }

    #[test]
    fn going_back_undoes_going_forth(a in generator(), b in generator(), seconds in 0.1..2.0) {
        let motion = |t: f64| a + b * (3.0 * t).cos();
        let there = integrator().flow(motion, 0.0, seconds).expect("smooth").map;
        let back = integrator().flow(motion, seconds, 0.0).expect("smooth").map;
        prop_assert!((back.matrix() * there.matrix() - Matrix3::identity()).amax() < 1e-10);
    }
}
