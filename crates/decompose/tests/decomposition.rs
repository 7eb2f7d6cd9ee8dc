//! Line products against the polynomials that they come from.
mod common;

use common::{affine, affine_maps, any_degree_curves, relative_difference, similarity};
use freeform_curve_fit::{Degree, ImplicitPolynomial};
use freeform_decompose::{Decomposition, DecompositionError, Line};
use nalgebra::{Point2, Vector2};
use proptest::prelude::*;

fn quartic(terms: &[(usize, usize, f64)]) -> ImplicitPolynomial {
    let mut a = [0.0; 15];
    for &(i, j, value) in terms {
        a[freeform_curve_fit::monomial_index(i, j)] = value;
    }
    ImplicitPolynomial::new(Degree::Quartic, &a).expect("finite coefficients")
}

proptest! {
    #[test]
    fn expanding_the_factors_gives_the_coefficients_back(curve in any_degree_curves()) {
        let decomposition = Decomposition::of(&curve);
        prop_assume!(decomposition.is_ok());
        let decomposition = decomposition.expect("just tested");
        prop_assume!(decomposition.condition().number() < 1e5);
        prop_assert!(relative_difference(&curve, &decomposition.expand()) < 1e-9);
        let a_n0 = curve.coefficient(curve.degree().value(), 0);
        prop_assert!((decomposition.coefficient(curve.degree().value()) - a_n0).abs() <= 1e-14 * a_n0);
    }
}
