use freeform_curve_fit::{Degree, ImplicitPolynomial};
use freeform_riccati::{AffineMotion, DynamicsError, Lift, MotionModel, Transport, flow_sensitivity};
use nalgebra::{DMatrix, DVector, Matrix3, Projective2};
use proptest::prelude::*;

use crate::support::{affine_motion, generator, model_and_parameters, relative_difference};

fn polynomial() -> impl Strategy<Value = ImplicitPolynomial> {
    prop::sample::select(&Degree::ALL[..]).prop_flat_map(|degree| {
        prop::collection::vec(-1.0..1.0, degree.coefficient_count())
            .prop_map(move |coefficients| ImplicitPolynomial::new(degree, &coefficients).expect("finite"))
    })
}

fn degree() -> impl Strategy<Value = Degree> {
    prop::sample::select(&Degree::ALL[..])
}

fn matrix_difference(a: &DMatrix<f64>, b: &DMatrix<f64>) -> f64 {
    relative_difference(a.as_slice(), b.as_slice())
}

#[test]
fn a_translation_moves_the_unit_circle_along_x() {
    // x^2 + y^2 - 1 moving with b1 = 1: the derivative of (x - t)^2 at t = 0 is -2 x.
    let circle = ImplicitPolynomial::new(Degree::Conic, &[-1.0, 0.0, 0.0, 1.0, 0.0, 1.0]).expect("finite");
    let motion = AffineMotion { b1: 1.0, ..Default::default() };
    let rate = Lift::new(Degree::Conic, motion.generator()).rate(&circle).expect("same degree");
    assert_eq!(rate.coefficients(), [0.0, -2.0, 0.0, 0.0, 0.0, 0.0]);
}

#[test]
fn scaling_homogeneous_points_scales_all_coefficients_alike() {
    for degree in Degree::ALL {
        let count = degree.coefficient_count();
        let expected = DMatrix::identity(count, count) * -(degree.value() as f64);
        assert_eq!(Lift::new(degree, Matrix3::identity()).matrix(), expected);
    }
}

#[test]
fn a_singular_map_and_a_wrong_degree_are_refused() {
    let singular = Projective2::from_matrix_unchecked(Matrix3::repeat(1.0));
    assert!(matches!(Transport::new(Degree::Quartic, &singular), Err(DynamicsError::SingularMap { .. })));
    let conic = ImplicitPolynomial::new(Degree::Conic, &[1.0; 6]).expect("finite");
    let transport = Transport::new(Degree::Quartic, &Projective2::identity()).expect("regular");
    assert!(transport.polynomial(&conic).is_err());
    assert!(Lift::new(Degree::Quartic, Matrix3::identity()).rate(&conic).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn transported_coefficients_are_those_of_the_moved_curve(
        polynomial in polynomial(), motion in affine_motion(), a in generator(),
    ) {
        let affine = motion.flow(0.8);
        let transport = Transport::new(polynomial.degree(), &affine).expect("regular");
        let moved = transport.polynomial(&polynomial).expect("same degree");
        let expected = polynomial.moved(&affine).expect("regular");
        prop_assert!(relative_difference(moved.coefficients(), expected.coefficients()) < 1e-13);

        let map = Projective2::from_matrix_unchecked((a * 0.8).exp());
        let transport = Transport::new(polynomial.degree(), &map).expect("regular");
        let moved = transport.polynomial(&polynomial).expect("same degree");
        let expected = polynomial.projected(&map).expect("regular");
        prop_assert!(relative_difference(moved.coefficients(), expected.coefficients()) < 1e-13);
    }

    #[test]
    fn the_exponential_of_the_lift_is_the_transport_by_the_flow(
        degree in degree(), (model, parameters) in model_and_parameters(), t in -0.7..0.7,
    ) {
        let lift = Lift::new(degree, model.generator(&parameters)).matrix();
        let transport = Transport::new(degree, &model.flow(&parameters, t)).expect("regular").matrix();
        prop_assert!(matrix_difference(&(lift * t).exp(), &transport) < 1e-12);
    }

    #[test]
    fn the_lift_is_linear_in_the_parameters(degree in degree(), (model, parameters) in model_and_parameters()) {
        let count = degree.coefficient_count();
        let sum = parameters.iter().zip(model.basis()).fold(DMatrix::zeros(count, count), |sum, (theta, e)| {
            sum + Lift::new(degree, *e).matrix() * *theta
        });
        let whole = Lift::new(degree, model.generator(&parameters)).matrix();
        prop_assert!(matrix_difference(&sum, &whole) < 1e-14);
    }

    #[test]
    fn the_lift_of_a_commutator_is_the_commutator_of_the_lifts(degree in degree(), a in generator(), b in generator()) {
        let [la, lb, lc] = [a, b, a * b - b * a].map(|g| Lift::new(degree, g).matrix());
        prop_assert!(matrix_difference(&(&la * &lb - &lb * &la), &lc) < 1e-12);
    }

    #[test]
    fn the_sparse_products_equal_the_dense_ones(polynomial in polynomial(), a in generator()) {
        let degree = polynomial.degree();
        let vector = DVector::from_row_slice(polynomial.coefficients());
        let mut out = vec![f64::NAN; vector.len()];
        let lift = Lift::new(degree, a);
        lift.apply(vector.as_slice(), &mut out);
        prop_assert!(relative_difference(&out, (lift.matrix() * &vector).as_slice()) < 1e-14);

        let transport = Transport::new(degree, &Projective2::from_matrix_unchecked(a.exp())).expect("regular");
        transport.apply(vector.as_slice(), &mut out);
        prop_assert!(relative_difference(&out, (transport.matrix() * &vector).as_slice()) < 1e-14);
        let mut entries = transport.matrix();
        entries.fill(f64::NAN);
        transport.write_matrix(entries.as_mut_slice());
        prop_assert_eq!(entries, transport.matrix());
    }

    #[test]
    fn affine_motion_never_mixes_a_lower_part_into_a_higher_one(degree in degree(), motion in affine_motion()) {
        let lift = Lift::new(degree, motion.generator()).matrix();
        let transport = Transport::new(degree, &motion.flow(0.6)).expect("regular").matrix();
        for (column, (i, j)) in freeform_curve_fit::exponents(degree.value()).enumerate() {
            let beyond = freeform_curve_fit::coefficient_count(i + j);
            for row in beyond..degree.coefficient_count() {
                prop_assert_eq!(lift[(row, column)], 0.0);
                prop_assert_eq!(transport[(row, column)], 0.0);
            }
        }
    }

    #[test]
    fn the_transport_from_the_flow_backwards_is_the_one_from_the_map(
        degree in degree(), (model, parameters) in model_and_parameters(),
    ) {
        let backwards = model.flow(&parameters, -0.4);
        let expected = Transport::new(degree, &model.flow(&parameters, 0.4)).expect("regular").matrix();
        prop_assert!(matrix_difference(&Transport::from_inverse(degree, backwards.matrix()).matrix(), &expected) < 1e-13);
    }

    #[test]
    fn the_sensitivity_is_the_off_diagonal_block_of_a_larger_exponential(
        a in generator(), e in generator(), t in -3.0..3.0_f64,
    ) {
        // expm([[A, E], [0, A]] t) = [[expm(A t), V expm(A t)], [0, expm(A t)]].
        let mut block = nalgebra::Matrix6::zeros();
        block.fixed_view_mut::<3, 3>(0, 0).copy_from(&a);
        block.fixed_view_mut::<3, 3>(0, 3).copy_from(&e);
        block.fixed_view_mut::<3, 3>(3, 3).copy_from(&a);
        let whole = (block * t).exp();
        let expected = whole.fixed_view::<3, 3>(0, 3);
        let derivative = flow_sensitivity(&a, &e, t) * (a * t).exp();
        prop_assert!((derivative - expected).amax() < 1e-12 * whole.amax());
    }

    #[test]
    fn the_lifted_sensitivity_is_the_derivative_of_the_transported_coefficients(
        polynomial in polynomial(), (model, parameters) in model_and_parameters(),
    ) {
        let (degree, t) = (polynomial.degree(), 0.3);
        let at = |parameters: &[f64]| {
            let transport = Transport::new(degree, &model.flow(parameters, t)).expect("regular");
            transport.polynomial(&polynomial).expect("same degree")
        };
        let base = at(&parameters);
        let sensitivities = model.flow_sensitivities(&parameters, t);
        for (j, v) in sensitivities.iter().enumerate().take(parameters.len()) {
            let mut derivative = vec![0.0; degree.coefficient_count()];
            Lift::new(degree, *v).apply(base.coefficients(), &mut derivative);
            let h = 1e-5;
            let shifted = |h: f64| {
                let mut shifted = parameters.clone();
                shifted[j] += h;
                at(&shifted)
            };
            let (plus, minus) = (shifted(h), shifted(-h));
            let difference: Vec<_> = plus.coefficients().iter().zip(minus.coefficients()).map(|(p, m)| (p - m) / (2.0 * h)).collect();
            prop_assert!(relative_difference(&derivative, &difference) < 1e-7, "parameter {}", j);
        }
        prop_assert!(sensitivities[model.parameter_count()..].iter().all(|v| *v == Matrix3::zeros()));
        prop_assert_eq!(MotionModel::MAX_PARAMETERS, sensitivities.len());
    }
}
