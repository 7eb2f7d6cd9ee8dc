//! Invariants of bounded and unbounded curves, and how uncertain they are.
use crate::common::{C, affine_maps, product, similarity};
use freeform_curve_fit::{Degree, ImplicitPolynomial, coefficient_count};
use freeform_decompose::{
    AffineInvariants, CurveUncertainty, Decomposition, RelatedPoint, RelatedPoints, from_rotation_chart,
};
use nalgebra::{DMatrix, DVector, Vector2};
use proptest::prelude::*;
use rand::SeedableRng as _;

/// `prod |x + l y|^2` times the real lines x cos t + y sin t, plus terms of lower degree: unbounded, of either sign.
fn unbounded(w: f64, turn: f64, real: [f64; 2], sign: f64, lower: &[f64]) -> ImplicitPolynomial {
    let l = from_rotation_chart(C::from_polar(w, turn));
    let pair = [0.0, 0.0, 0.0, 1.0, 2.0 * l.re, l.norm_sqr()];
    let line = |t: f64| [0.0, t.cos(), t.sin()];
    let mut form = product(&product(&pair, 2, &line(real[0]), 1), 3, &line(real[1]), 1);
    form.iter_mut().zip(lower).for_each(|(a, b)| *a += b);
    form.iter_mut().for_each(|a| *a *= sign);
    ImplicitPolynomial::new(Degree::Quartic, &form).expect("finite coefficients")
}

fn well_conditioned(curve: &ImplicitPolynomial) -> Option<Decomposition> {
    Decomposition::of(curve).ok().filter(|d| d.condition().number() < 1e4)
}

proptest! {
    #[test]
    fn invariants_of_unbounded_curves_stay_under_affine_maps(
        (w, turn) in (0.1..0.8_f64, 0.0..6.3_f64),
        (first, apart) in (0.0..3.1_f64, 0.5..2.6_f64),
        positive in any::<bool>(),
        lower in prop::collection::vec(-1.0..1.0_f64, coefficient_count(3)),
        map in affine_maps(),
        quarter_turns in 0..4_i32,
    ) {
        let curve = unbounded(w, turn, [first, first + apart], if positive { 1.0 } else { -1.0 }, &lower);
        // Quarter turns bring either sign to the coefficient of x^4.
        let map = map * similarity(f64::from(quarter_turns) * std::f64::consts::FRAC_PI_2, 1.0, Vector2::zeros());
        let moved = curve.moved(&map).expect("regular");
        let (Some(before), Some(after)) = (well_conditioned(&curve), well_conditioned(&moved)) else { return Ok(()) };
        let (Some(a), Some(b)) = (AffineInvariants::of(&before), AffineInvariants::of(&after)) else { return Ok(()) };
        prop_assert!(a.distance(&b).expect("one degree") < 1e-6, "{a:?} {b:?}");
    }

    #[test]
    fn invariants_keep_the_sign_of_the_polynomial(
        (w, turn) in (0.1..0.8_f64, 0.0..6.3_f64),
        lower in prop::collection::vec(-1.0..1.0_f64, coefficient_count(3)),
    ) {
        let [plus, minus] = [1.0, -1.0].map(|sign| unbounded(w, turn, [0.3, 1.7], sign, &lower));
        let (Some(plus), Some(minus)) = (well_conditioned(&plus), well_conditioned(&minus)) else { return Ok(()) };
        let [Some(a), Some(b)] = [plus, minus].map(|d| AffineInvariants::of(&d)) else { return Ok(()) };
        prop_assert!((a.values()[3] + b.values()[3]).abs() < 1e-9);
    }
}

#[test]
fn a_curve_with_four_real_lines_has_no_invariants() {
    let line = |t: f64| [0.0, t.cos(), t.sin()];
    let two = |a: f64, b: f64| product(&line(a), 1, &line(b), 1);
    let mut form = product(&two(0.2, 0.9), 2, &two(1.6, 2.5), 2);
    form.iter_mut().zip([-0.3, 0.1, 0.2, 0.5, -0.1, 0.7, 0.3, 0.1, -0.2, 0.1]).for_each(|(a, b)| *a += b);
    let curve = ImplicitPolynomial::new(Degree::Quartic, &form).expect("finite");
    assert_eq!(AffineInvariants::of(&Decomposition::of(&curve).expect("lines")), None);
}

#[test]
fn the_uncertainty_of_points_and_invariants_is_that_of_many_curves() {
    let coefficients = [-1.0, 0.2, 0.0, -0.2, 0.5, 0.0, 0.0, 1.0, 0.5, 0.0, 2.0, 0.0, 5.0, 0.0, 2.0];
    let curve = ImplicitPolynomial::new(Degree::Quartic, &coefficients).expect("finite");
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(7);
    let mut uniform = || rng.random::<f64>() - 0.5;
    let root = DMatrix::from_fn(15, 15, |_, _| 1e-4 * uniform());
    let uncertainty = CurveUncertainty::carried(&curve, &(&root * root.transpose())).expect("lines");
    // Pairs have no order of their own.
    let wanted = RelatedPoints::of(&Decomposition::of(&curve).expect("lines")).as_slice()[0].point;
    let nearest = |decomposition: &Decomposition| {
        let points = RelatedPoints::of(decomposition);
        let distance = |d: &&RelatedPoint| (d.point - wanted).norm();
        points.level(4).min_by(|a, b| distance(a).total_cmp(&distance(b))).expect("two points").point
    };
    let draws = 1000;
    let (mut points, mut invariants) = (Vec::new(), Vec::new());
    for _ in 0..draws {
        // Twelve uniform numbers have the variance 1.
        let normal = DVector::from_fn(15, |_, _| (0..12).map(|_| uniform()).sum::<f64>());
        let moved = DVector::from_column_slice(&coefficients) + &root * normal;
        let moved = Decomposition::of(&ImplicitPolynomial::new(Degree::Quartic, moved.as_slice()).expect("finite"));
        let moved = moved.expect("lines");
        points.push(nearest(&moved).x);
        invariants.push(AffineInvariants::of(&moved).expect("invariants").values()[1]);
    }
    let variance = |values: &[f64]| {
        let mean = values.iter().sum::<f64>() / f64::from(draws);
        values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / f64::from(draws)
    };
    let stated = (uncertainty.points()[0][(0, 0)], uncertainty.invariants().expect("invariants")[(1, 1)]);
    for (stated, found) in [(stated.0, variance(&points)), (stated.1, variance(&invariants))] {
        assert!((stated / found - 1.0).abs() < 0.2, "{stated:e} {found:e}");
    }
}

#[test]
fn a_mahalanobis_distance_counts_standard_deviations_and_leaves_out_what_cannot_vary() {
    let coefficients = [-1.0, 0.2, 0.0, -0.2, 0.5, 0.0, 0.0, 1.0, 0.5, 0.0, 2.0, 0.0, 5.0, 0.0, 2.0];
    let curve = ImplicitPolynomial::new(Degree::Quartic, &coefficients).expect("finite");
    let uncertainty = CurveUncertainty::carried(&curve, &(DMatrix::identity(15, 15) * 1e-8)).expect("lines");
    let covariance = uncertainty.invariants().expect("invariants");
    let of = |curve: &ImplicitPolynomial| {
        AffineInvariants::of(&Decomposition::of(curve).expect("lines")).expect("invariants")
    };
    let mut moved = coefficients;
    moved[4] += 3e-4;
    let moved = ImplicitPolynomial::new(Degree::Quartic, &moved).expect("finite");
    let distance = of(&curve).mahalanobis(&of(&moved), covariance).expect("one degree");
    // Three deviations of one coefficient of fifteen; three invariants see a part of it.
    assert!((0.05..3.1).contains(&distance), "{distance}");
    assert!((of(&curve).mahalanobis(&of(&curve), covariance).expect("one degree")).abs() < 1e-12);
    assert_eq!(of(&curve).mahalanobis(&of(&moved), &DMatrix::identity(3, 3)), None);
}
