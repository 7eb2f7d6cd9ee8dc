//! Line products against the polynomials that they come from.
use crate::common::{C, affine, affine_maps, any_degree_curves, bounded_curves, relative_difference, similarity};
use freeform_curve_fit::{Degree, ImplicitPolynomial, monomial_index};
use freeform_decompose::{Decomposition, DecompositionError, Line, RelatedPoints};
use nalgebra::{Point2, Vector2};
use proptest::prelude::*;

fn polynomial(degree: Degree, terms: &[(usize, usize, f64)]) -> ImplicitPolynomial {
    let mut a = vec![0.0; degree.coefficient_count()];
    for &(i, j, value) in terms {
        a[monomial_index(i, j)] = value;
    }
    ImplicitPolynomial::new(degree, &a).expect("finite coefficients")
}

fn error_of(degree: Degree, terms: &[(usize, usize, f64)]) -> DecompositionError {
    Decomposition::of(&polynomial(degree, terms)).expect_err("no decomposition")
}

/// Largest distance of a line of one level to its nearest in the other, relative to the largest number in the level.
fn level_distance(a: &[Line], b: &[Line]) -> f64 {
    let size = a.iter().fold(1.0_f64, |m, line| m.max(line.l.norm()).max(line.k.norm()));
    let apart = |p: &Line, q: &Line| (p.l - q.l).norm().max((p.k - q.k).norm());
    a.iter().map(|p| b.iter().map(|q| apart(p, q)).fold(f64::INFINITY, f64::min)).fold(0.0, f64::max) / size
}

/// The same distance, measured so that a rotation does not change it much: lines with a large l count as near.
fn homogeneous_distance(a: &[Line], b: &[Line]) -> f64 {
    let size = |line: &Line| 1.0 + line.l.norm_sqr();
    let scale = a.iter().fold(1.0_f64, |m, line| m.max(line.k.norm() / size(line).sqrt()));
    let apart = |p: &Line, q: &Line| (p.l - q.l).norm().max((p.k - q.k).norm() / scale) / size(p);
    a.iter().map(|p| b.iter().map(|q| apart(p, q)).fold(f64::INFINITY, f64::min)).fold(0.0, f64::max)
}

#[test]
fn a_product_of_known_lines_plus_a_conic_gives_these_lines_and_numbers_back() {
    let upper = [(C::new(0.3, 0.6), C::new(0.1, -0.2)), (C::new(-0.5, 1.5), C::new(-0.3, 0.4))];
    let conic = (C::new(0.2, 0.9), C::new(0.5, 0.1));
    let pair = |(l, k): (C, C)| [Line { l, k }, Line { l: l.conj(), k: k.conj() }];
    let lines = [pair(upper[1]), pair(upper[0]), pair(conic)].concat();
    let coefficients = [2.0, -0.6, -0.8];
    let given = Decomposition::from_parts(Degree::Quartic, &lines, &coefficients).expect("a decomposition");
    let found = Decomposition::of(&given.expand()).expect("well-conditioned");
    assert!(level_distance(found.level(4), &lines[..4]) < 1e-13);
    assert!(level_distance(found.level(2), &lines[4..]) < 1e-13);
    for (level, c) in [4, 2, 0].into_iter().zip(coefficients) {
        assert!((found.coefficient(level) - c).abs() < 1e-13);
    }
    assert!((found.alpha() + 0.3).abs() < 1e-13 && (found.beta() + 0.4).abs() < 1e-13);
    assert!(found.level(3).is_empty() && found.level(6).is_empty() && found.coefficient(3) == 0.0);
}

#[test]
fn a_conic_that_is_a_circle_has_its_centre_for_a_related_point() {
    // (x - 1)^2 + (y + 2)^2 - 9
    let terms = [(2, 0, 1.0), (0, 2, 1.0), (1, 0, -2.0), (0, 1, 4.0), (0, 0, -4.0)];
    let circle = Decomposition::of(&polynomial(Degree::Conic, &terms)).expect("two lines");
    let d = RelatedPoints::of(&circle).as_slice()[0];
    assert!((d.point - Point2::new(1.0, -2.0)).norm() < 1e-15);
    assert!((d.value + 9.0).abs() < 1e-14);
}

#[test]
fn conics_of_lower_levels_may_have_real_lines() {
    // (x^2 + y^2) (x^2 + 4 y^2) + (x - y) (x + 2 y) - 1
    let terms = [(4, 0, 1.0), (2, 2, 5.0), (0, 4, 4.0), (2, 0, 1.0), (1, 1, 1.0), (0, 2, -2.0), (0, 0, -1.0)];
    let decomposition = Decomposition::of(&polynomial(Degree::Quartic, &terms)).expect("a decomposition");
    let l: Vec<C> = decomposition.level(2).iter().map(|line| line.l).collect();
    assert_eq!(decomposition.conjugate_pairs(2).count(), 0);
    assert!((l[0] - 2.0).norm() < 1e-14 && (l[1] + 1.0).norm() < 1e-14, "{l:?}");
}

#[test]
fn curves_without_a_decomposition_are_refused_by_name() {
    use DecompositionError::{CircularLeadingForm, NearDoubleLines, VanishingLeadingCoefficient};
    // (x^2 + y^2)^2 - 1: a circle written as a quartic.
    let circle = error_of(Degree::Quartic, &[(4, 0, 1.0), (2, 2, 2.0), (0, 4, 1.0), (0, 0, -1.0)]);
    assert!(matches!(circle, CircularLeadingForm { level: 4, separation } if separation < 1e-6), "{circle}");
    // (x^2 + 4 y^2)^2 - x - 1
    let double = error_of(Degree::Quartic, &[(4, 0, 1.0), (2, 2, 8.0), (0, 4, 16.0), (1, 0, -1.0), (0, 0, -1.0)]);
    assert!(matches!(double, NearDoubleLines { level: 4, l, .. } if (l.im.abs() - 2.0).abs() < 1e-5), "{double}");
    // x^4 + y^4 - 1 has nothing between its leading form and its constant.
    let no_conic = error_of(Degree::Quartic, &[(4, 0, 1.0), (0, 4, 1.0), (0, 0, -1.0)]);
    assert_eq!(no_conic, VanishingLeadingCoefficient { level: 2, relative: 0.0 });
    // x^4 + y^4 + x y - 1: alpha is 0 in this orientation only.
    let no_alpha = error_of(Degree::Quartic, &[(4, 0, 1.0), (0, 4, 1.0), (1, 1, 1.0), (0, 0, -1.0)]);
    assert_eq!(no_alpha, VanishingLeadingCoefficient { level: 2, relative: 0.0 });
    let no_a40 = error_of(Degree::Quartic, &[(4, 0, 1e-12), (2, 2, 1.0), (0, 4, 1.0), (0, 0, -1.0)]);
    assert!(matches!(no_a40, VanishingLeadingCoefficient { level: 4, .. }), "{no_a40}");
    assert!(matches!(error_of(Degree::Octic, &[]), VanishingLeadingCoefficient { level: 8, .. }));
}

#[test]
fn a_curve_turned_out_of_the_orientation_without_alpha_can_be_decomposed() {
    let f = polynomial(Degree::Quartic, &[(4, 0, 1.0), (0, 4, 1.0), (1, 1, 1.0), (0, 0, -1.0)]);
    let turned = f.moved(&similarity(0.3, 1.0, Vector2::zeros())).expect("a rotation");
    let decomposition = Decomposition::of(&turned).expect("alpha is there now");
    assert!(relative_difference(&turned, &decomposition.expand()) < 1e-13);
}

#[test]
fn parts_that_do_not_belong_together_are_refused() {
    let line = |re, im| Line { l: C::new(re, im), k: C::new(0.1, im) };
    let of = |lines: &[Line], c: &[f64]| Decomposition::from_parts(Degree::Conic, lines, c);
    let pair = [line(0.2, 1.0), line(0.2, -1.0)];
    assert!(of(&pair, &[1.0, -1.0]).is_ok());
    assert!(matches!(of(&pair[..1], &[1.0, -1.0]), Err(DecompositionError::WrongCount { lines_needed: 2, .. })));
    let strangers = of(&[line(0.2, 1.0), line(0.3, -1.0)], &[1.0, -1.0]);
    assert_eq!(strangers, Err(DecompositionError::NotConjugate { level: 2, index: 0 }));
    let half_real = of(&[line(0.2, 0.0), line(0.2, -1.0)], &[1.0, -1.0]);
    assert_eq!(half_real, Err(DecompositionError::NotConjugate { level: 2, index: 0 }));
    assert_eq!(of(&pair, &[f64::NAN, -1.0]), Err(DecompositionError::NotFinite { level: 2 }));
    assert!(matches!(of(&pair, &[0.0, -1.0]), Err(DecompositionError::VanishingLeadingCoefficient { .. })));
    let twice = of(&[line(0.5, 0.0), line(0.5, 0.0)], &[1.0, -1.0]);
    assert!(matches!(twice, Err(DecompositionError::NearDoubleLines { .. })));
}

#[test]
fn maps_that_lose_a_line_are_refused() {
    let terms = [(2, 0, 1.0), (0, 2, -1.0), (0, 0, -1.0)];
    let hyperbola = Decomposition::of(&polynomial(Degree::Conic, &terms)).expect("x + y and x - y");
    let singular = hyperbola.moved(&affine([[1.0, 2.0], [2.0, 4.0]], [0.0, 0.0]));
    assert!(matches!(singular, Err(DecompositionError::SingularMap { .. })));
    // Turns x - y parallel to the x axis.
    let turned = hyperbola.moved(&similarity(std::f64::consts::FRAC_PI_4, 1.0, Vector2::zeros()));
    assert!(matches!(turned, Err(DecompositionError::LineLeavesChart { level: 2, .. })), "{turned:?}");
}

proptest! {
    #[test]
    fn expanding_the_factors_gives_the_coefficients_back(curve in any_degree_curves()) {
        let decomposition = Decomposition::of(&curve);
        prop_assume!(decomposition.is_ok());
        let decomposition = decomposition.expect("just tested");
        let difference = relative_difference(&curve, &decomposition.expand());
        let condition = decomposition.condition().number();
        prop_assert!(difference < 4.0 * f64::EPSILON * condition, "{} at condition {}", difference, condition);
        prop_assert!(condition > 1e5 || difference < 1e-9);
        let n = curve.degree().value();
        prop_assert!((decomposition.coefficient(n) / curve.coefficient(n, 0) - 1.0).abs() < 1e-14);
    }

    #[test]
    fn nearly_all_bounded_curves_of_unit_size_are_decomposed(
        curves in prop::collection::vec(bounded_curves(Degree::Quartic), 40),
    ) {
        let refused = curves.iter().filter(|curve| Decomposition::of(curve).is_err()).count();
        prop_assert!(refused <= 1);
    }

    #[test]
    fn perturbed_coefficients_move_the_lines_by_no_more_than_the_condition_number_says(
        curve in bounded_curves(Degree::Quartic), noise in prop::collection::vec(-1.0..1.0_f64, 15),
    ) {
        let size = curve.coefficients().iter().fold(0.0_f64, |m, a| m.max(a.abs()));
        let perturbed: Vec<f64> =
            curve.coefficients().iter().zip(&noise).map(|(a, e)| a + 1e-9 * e * size).collect();
        let perturbed = ImplicitPolynomial::new(Degree::Quartic, &perturbed).expect("finite");
        let (Ok(a), Ok(b)) = (Decomposition::of(&curve), Decomposition::of(&perturbed)) else {
            return Err(TestCaseError::reject("not decomposable"));
        };
        let condition = a.condition().number();
        prop_assume!(condition < 1e5);
        for level in a.levels() {
            let moved = homogeneous_distance(a.level(level), b.level(level));
            prop_assert!(moved < 30.0 * 1e-9 * condition, "{} at condition {}", moved, condition);
        }
    }

    #[test]
    fn every_level_stands_in_exact_conjugate_pairs_and_then_real_lines(curve in any_degree_curves()) {
        let Ok(decomposition) = Decomposition::of(&curve) else { return Ok(()) };
        for m in decomposition.levels() {
            let complex = 2 * decomposition.conjugate_pairs(m).count();
            let (pairs, real) = decomposition.level(m).split_at(complex);
            prop_assert!(pairs.chunks_exact(2).all(|p| p[0].l.im > 0.0 && p[1] == p[0].conjugate()));
            prop_assert!(real.iter().all(|line| line.l.im == 0.0 && line.k.im == 0.0));
        }
        prop_assert_eq!(decomposition.conjugate_pairs(curve.degree().value()).count(), curve.degree().value() / 2);
    }

    #[test]
    fn moving_the_lines_is_decomposing_the_moved_polynomial(
        curve in any_degree_curves(), map in affine_maps(), mirrored in any::<bool>(),
    ) {
        let map = if mirrored { map * affine([[-1.0, 0.0], [0.0, 1.0]], [0.0, 0.0]) } else { map };
        let moved_curve = curve.moved(&map).expect("regular");
        let (Ok(before), Ok(after)) = (Decomposition::of(&curve), Decomposition::of(&moved_curve)) else {
            return Ok(());
        };
        prop_assume!(before.condition().number().max(after.condition().number()) < 1e5);
        let moved = before.moved(&map).expect("no line leaves the chart");
        prop_assert!(relative_difference(&moved_curve, &moved.expand()) < 1e-9);
        for m in moved.levels() {
            prop_assert!(level_distance(moved.level(m), after.level(m)) < 1e-8);
            let (c, expected) = (moved.coefficient(m), after.coefficient(m));
            prop_assert!((c - expected).abs() < 1e-8 * (c.abs() + after.coefficient(curve.degree().value())));
            prop_assert!(moved.conjugate_pairs(m).count() == before.conjugate_pairs(m).count());
        }
    }

    #[test]
    fn lines_made_in_centred_coordinates_keep_their_digits_a_million_sizes_away(
        curve in bounded_curves(Degree::Quartic), angle in 0.0..6.3_f64, px in -1.5..1.5_f64, py in -1.5..1.5_f64,
    ) {
        let Ok(centred) = Decomposition::of(&curve) else { return Ok(()) };
        prop_assume!(centred.condition().number() < 1e4);
        let turn = similarity(angle, 1.0, Vector2::zeros());
        let Ok(near) = centred.moved(&turn) else { return Ok(()) };
        let Ok(far) = near.moved(&similarity(0.0, 1.0, Vector2::new(1e6, -1e6))) else { return Ok(()) };
        let offset = Vector2::new(1e6, -1e6);
        // One ulp at 1e6 is 1e-10; k carries a few of them, and l multiplies those of y.
        for (a, b) in RelatedPoints::of(&near).as_slice().iter().zip(RelatedPoints::of(&far).as_slice()) {
            let line = near.level(a.level)[2 * a.pair];
            let magnified = (1.0 + line.l.norm()) * (1.0 + line.l.norm()) / (near.level(a.level)[2 * a.pair + 1].l - line.l).norm();
            prop_assert!((b.point - offset - a.point).norm() < 3e-9 * magnified.max(1.0), "{} at {}", (b.point - offset - a.point).norm(), magnified);
        }
        let p = Point2::new(px, py);
        let (here, there) = (near.evaluate(&p), far.evaluate(&(p + offset)));
        let size = near.expand().coefficients().iter().fold(0.0_f64, |m, a| m.max(a.abs()));
        prop_assert!((here - there).abs() < 1e-6 * (size + here.abs()));
        // Decomposing out there is refused, or is far off; it must not look right and be wrong.
        let out_there = curve.moved(&similarity(angle, 1.0, offset)).expect("regular");
        prop_assert!(Decomposition::of(&out_there).is_err());
    }

    #[test]
    fn evaluating_the_lines_is_evaluating_the_polynomial(
        curve in any_degree_curves(), x in -1.5..1.5_f64, y in -1.5..1.5_f64,
    ) {
        let Ok(decomposition) = Decomposition::of(&curve) else { return Ok(()) };
        prop_assume!(decomposition.condition().number() < 1e5);
        let p = Point2::new(x, y);
        let (lines, powers) = (decomposition.evaluate(&p), curve.evaluate(&p));
        let size = curve.coefficients().iter().fold(0.0_f64, |m, a| m.max(a.abs()));
        prop_assert!((lines - powers).abs() < 1e-8 * (size + powers.abs()));
    }

    #[test]
    fn parts_put_together_again_are_the_same_decomposition(curve in any_degree_curves()) {
        let Ok(decomposition) = Decomposition::of(&curve) else { return Ok(()) };
        let lines: Vec<Line> = decomposition.levels().flat_map(|m| decomposition.level(m).to_vec()).collect();
        let n = curve.degree().value();
        let c: Vec<f64> = (0..=n / 2).rev().map(|half| decomposition.coefficient(2 * half)).collect();
        prop_assert_eq!(Decomposition::from_parts(curve.degree(), &lines, &c), Ok(decomposition));
    }

    #[test]
    fn wild_coefficients_give_finite_results_or_an_error(
        degree in prop_oneof![Just(Degree::Conic), Just(Degree::Quartic), Just(Degree::Sextic), Just(Degree::Octic)],
        wild in prop::collection::vec(
            prop_oneof![any::<f64>().prop_filter("finite", |a| a.is_finite()), -1.0..1.0_f64, Just(0.0)], 45),
        moderate in any::<bool>(),
        map in affine_maps(),
    ) {
        let mut a = wild[..degree.coefficient_count()].to_vec();
        if moderate {
            a.iter_mut().for_each(|a| *a = a.signum() * a.abs().powf(0.02));
        }
        let curve = ImplicitPolynomial::new(degree, &a).expect("finite");
        if let Ok(points) = RelatedPoints::of_polynomial(&curve) {
            prop_assert!(points.as_slice().iter().all(|d| (d.point.x + d.point.y).is_finite() && d.value.is_finite()));
        }
        let Ok(decomposition) = Decomposition::of(&curve) else { return Ok(()) };
        for d in [Ok(decomposition), decomposition.moved(&map)].into_iter().flatten() {
            prop_assert!(d.expand().coefficients().iter().all(|a| a.is_finite()));
            prop_assert!(d.condition().number().is_finite() && d.condition().smallest_separation() >= 0.0);
            prop_assert!(d.levels().all(|m| d.level(m).iter().all(|line| line.l.is_finite() && line.k.is_finite())));
            prop_assert!(RelatedPoints::of(&d).as_slice().iter().all(|d| d.value.is_finite()));
        }
    }
}
