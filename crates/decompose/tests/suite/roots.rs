//! The iteration against the companion matrix, and both against known roots.
use crate::common::C;
use freeform_decompose::{RootError, Roots, binary_form_roots, companion_roots};
use proptest::prelude::*;

/// Coefficients, highest power first, of the polynomial with these conjugate pairs and real roots.
fn form_with(upper: &[C], real: &[f64]) -> Vec<f64> {
    let mut form = vec![1.0];
    let mut multiply = |factor: &[f64]| {
        let mut next = vec![0.0; form.len() + factor.len() - 1];
        for (i, a) in form.iter().enumerate() {
            for (j, b) in factor.iter().enumerate() {
                next[i + j] += a * b;
            }
        }
        form = next;
    };
    upper.iter().for_each(|z| multiply(&[1.0, -2.0 * z.re, z.norm_sqr()]));
    real.iter().for_each(|x| multiply(&[1.0, -x]));
    form
}

/// Largest distance from a root of one to the nearest root of the other, relative to the largest root.
fn distance(a: &Roots, b: &Roots) -> f64 {
    let size = a.as_slice().iter().fold(f64::MIN_POSITIVE, |m, z| m.max(z.norm()));
    let nearest =
        |z: &C, others: &Roots| others.as_slice().iter().map(|o| (z - o).norm()).fold(f64::INFINITY, f64::min);
    let one_way = |p: &Roots, q: &Roots| p.as_slice().iter().map(|z| nearest(z, q)).fold(0.0, f64::max);
    one_way(a, b).max(one_way(b, a)) / size
}

fn both(form: &[f64]) -> (Roots, Roots) {
    let iterated = binary_form_roots(form).expect("roots by iteration");
    (iterated, companion_roots(form).expect("roots by the companion matrix"))
}

#[test]
fn both_ways_agree_on_the_leading_forms_that_break_other_solvers() {
    let cases: [(&str, &[f64], f64); 9] = [
        ("x^4 + 1", &[1.0, 0.0, 0.0, 0.0, 1.0], 1e-14),
        ("x^4 + x^2 + 1", &[1.0, 0.0, 1.0, 0.0, 1.0], 1e-14),
        ("x^4 + 1e8", &[1.0, 0.0, 0.0, 0.0, 1e8], 1e-14),
        ("x^4 + 1e-200", &[1.0, 0.0, 0.0, 0.0, 1e-200], 1e-14),
        ("x^8 + 1", &[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], 1e-14),
        ("x^4", &[1.0, 0.0, 0.0, 0.0, 0.0], 0.0),
        ("x^4 + x^2", &[1.0, 0.0, 1.0, 0.0, 0.0], 1e-7),
        ("(x^2 + 1)^2", &[1.0, 0.0, 2.0, 0.0, 1.0], 1e-6),
        ("(x^2 + 1)^3", &[1.0, 0.0, 3.0, 0.0, 3.0, 0.0, 1.0], 1e-3),
    ];
    for (name, form, tolerance) in cases {
        let (iterated, companion) = both(form);
        assert!(distance(&iterated, &companion) <= tolerance, "{name}: {iterated:?} {companion:?}");
    }
}

#[test]
fn the_roots_of_x4_plus_1_are_the_odd_eighth_roots_of_unity() {
    let roots = binary_form_roots(&[1.0, 0.0, 0.0, 0.0, 1.0]).expect("roots");
    let h = 0.5_f64.sqrt();
    let expected = [C::new(-h, h), C::new(-h, -h), C::new(h, h), C::new(h, -h)];
    assert_eq!(roots.conjugate_pair_count(), 2);
    for (z, e) in roots.as_slice().iter().zip(expected) {
        assert!((z - e).norm() < 4e-16, "{z} is not {e}");
    }
}

#[test]
fn bad_coefficients_are_refused_with_the_reason() {
    assert_eq!(binary_form_roots(&[1.0, 2.0]), Err(RootError::UnsupportedDegree { count: 2 }));
    assert_eq!(binary_form_roots(&[]), Err(RootError::UnsupportedDegree { count: 0 }));
    assert_eq!(binary_form_roots(&[1.0, f64::NAN, 1.0]), Err(RootError::NotFinite { index: 1 }));
    let vanishing = RootError::VanishingLeadingCoefficient { leading: 0.0, largest: 2.0 };
    assert_eq!(binary_form_roots(&[0.0, 2.0, 1.0]), Err(vanishing));
    assert_eq!(companion_roots(&[0.0, 2.0, 1.0]), Err(vanishing));
}

fn forms() -> impl Strategy<Value = Vec<f64>> {
    prop_oneof![Just(3_usize), Just(5), Just(7), Just(9)]
        .prop_flat_map(|count| prop::collection::vec(-1.0..1.0_f64, count))
        .prop_filter("a leading coefficient", |form| form[0].abs() > 1e-3)
}

proptest! {
    #[test]
    fn conjugates_are_exact_and_real_roots_come_last(form in forms()) {
        let roots = binary_form_roots(&form).expect("roots");
        let (complex, real) = roots.as_slice().split_at(2 * roots.conjugate_pair_count());
        prop_assert_eq!(roots.as_slice().len(), form.len() - 1);
        for pair in complex.chunks_exact(2) {
            prop_assert!(pair[0].im > 0.0 && pair[1] == pair[0].conj());
        }
        prop_assert!(real.iter().all(|z| z.im == 0.0));
    }

    #[test]
    fn every_root_leaves_no_more_than_rounding(form in forms()) {
        let (iterated, companion) = both(&form);
        // The iteration is exact to rounding in every coefficient, the companion matrix only in the largest.
        let largest = companion.as_slice().iter().fold(0.0_f64, |m, z| m.max(z.norm()));
        for (roots, least_radius) in [(iterated, 0.0), (companion, largest)] {
            for z in roots.as_slice() {
                let value = form.iter().fold(C::ZERO, |sum, a| sum * z + *a);
                let size = form.iter().fold(0.0, |sum, a| sum * z.norm().max(least_radius) + a.abs());
                prop_assert!(value.norm() <= 1e-13 * size, "{} at {}", value, z);
            }
        }
    }

    #[test]
    fn separate_roots_are_found_to_rounding(
        upper in prop::collection::vec((-2.0..2.0_f64, 0.05..2.0_f64), 2..=3),
        real in prop_oneof![Just(vec![]), (-2.0..0.0_f64, 0.5..2.0_f64).prop_map(|(a, b)| vec![a, b])],
        scale in prop_oneof![Just(1.0), Just(1e-6), Just(1e6)],
    ) {
        let upper: Vec<C> = upper.into_iter().map(|(re, im)| C::new(re, im) * scale).collect();
        let real: Vec<f64> = real.into_iter().map(|x| x * scale).collect();
        let gaps = upper.iter().enumerate().flat_map(|(i, a)| upper[i + 1..].iter().map(move |b| (a - b).norm()));
        prop_assume!(gaps.fold(f64::INFINITY, f64::min) > 0.2 * scale);
        let (iterated, companion) = both(&form_with(&upper, &real));
        prop_assert_eq!(iterated.conjugate_pair_count(), upper.len());
        prop_assert!(distance(&iterated, &companion) < 1e-9);
        for z in &upper {
            let found = iterated.as_slice().iter().map(|r| (r - z).norm()).fold(f64::INFINITY, f64::min);
            prop_assert!(found < 1e-10 * scale, "{} missed by {}", z, found);
        }
    }

    #[test]
    fn near_double_roots_are_found_to_what_their_distance_allows(
        re in -1.0..1.0_f64, im in 0.3..1.0_f64, exponent in 1..16_i32, direction in 0.0..6.3_f64,
    ) {
        let (a, gap) = (C::new(re, im), 10.0_f64.powi(-exponent));
        let (iterated, companion) = both(&form_with(&[a, a + C::from_polar(gap, direction)], &[]));
        // A perturbation eps of the coefficients moves roots at the distance gap by eps / gap, at most by sqrt(eps).
        let allowed = (1e-14 / gap).min(1e-6);
        prop_assert!(distance(&iterated, &companion) < allowed, "{:?} {:?}", iterated, companion);
        prop_assert_eq!(iterated.conjugate_pair_count(), 2);
    }

    #[test]
    fn coefficients_of_any_size_give_finite_roots_or_an_error(
        form in prop_oneof![prop::collection::vec(any::<f64>(), 5), prop::collection::vec(any::<f64>(), 9)],
    ) {
        if let Ok(roots) = binary_form_roots(&form) {
            prop_assert!(roots.as_slice().iter().all(|z| z.is_finite()));
        }
    }
}
