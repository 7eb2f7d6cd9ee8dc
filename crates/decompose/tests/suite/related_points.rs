//! Related points move with the curve, and the values there change by one common factor.
use crate::common::{C, affine_maps, any_degree_curves, bounded_curves, similarity};
use freeform_curve_fit::{Degree, ImplicitPolynomial};
use freeform_decompose::{
    AffineInvariants, Correspondence, CorrespondenceError, Criterion, Decomposition, RelatedPoints,
    from_rotation_chart, rotation_chart,
};
use nalgebra::{Point2, Vector2};
use proptest::prelude::*;

fn well_conditioned(curve: &ImplicitPolynomial) -> Option<Decomposition> {
    Decomposition::of(curve).ok().filter(|d| d.condition().number() < 1e4)
}

proptest! {
    #[test]
    fn related_points_move_with_the_curve_and_their_values_share_one_positive_factor(
        curve in any_degree_curves(), map in affine_maps(),
    ) {
        let moved_curve = curve.moved(&map).expect("regular");
        let (Some(before), Some(after)) = (well_conditioned(&curve), well_conditioned(&moved_curve)) else {
            return Ok(());
        };
        let (before, after) = (RelatedPoints::of(&before), RelatedPoints::of(&after));
        prop_assert_eq!(before.as_slice().len(), after.as_slice().len());
        let n = curve.degree().value();
        let s = curve.coefficient(n, 0) / moved_curve.coefficient(n, 0);
        prop_assert!(s > 0.0);
        let largest = before.as_slice().iter().fold(before.beta().abs(), |m, d| m.max(d.value.abs()));
        for d in before.as_slice() {
            let expected = map * d.point;
            let error = |e: &freeform_decompose::RelatedPoint| {
                let apart = (e.point - expected).norm() / (1.0 + expected.coords.norm());
                apart.max((e.value / s - d.value).abs() / largest)
            };
            let best = after.level(d.level).map(error).fold(f64::INFINITY, f64::min);
            prop_assert!(best < 1e-7, "level {}, off by {}", d.level, best);
        }
        prop_assert!((after.beta() / s - before.beta()).abs() < 1e-7 * largest);
    }

    #[test]
    fn the_related_points_lie_on_their_lines(curve in any_degree_curves()) {
        let Some(decomposition) = well_conditioned(&curve) else { return Ok(()) };
        for d in RelatedPoints::of(&decomposition).as_slice() {
            for line in &decomposition.level(d.level)[2 * d.pair..2 * d.pair + 2] {
                let size = d.point.x.abs() + (line.l * d.point.y).norm() + line.k.norm();
                prop_assert!(line.evaluate(&d.point).norm() <= 1e-12 * size);
            }
        }
    }

    #[test]
    fn the_centre_of_the_conic_needs_no_factoring(curve in any_degree_curves()) {
        let Some(decomposition) = well_conditioned(&curve) else { return Ok(()) };
        let (lines, whole) = (RelatedPoints::of(&decomposition), RelatedPoints::of_polynomial(&curve).expect("exists"));
        prop_assert_eq!(lines.as_slice().len(), whole.as_slice().len());
        let largest = lines.as_slice().iter().fold(1.0, |m, d| d.value.abs().max(m));
        for (a, b) in lines.as_slice().iter().zip(whole.as_slice()) {
            prop_assert!((a.point - b.point).norm() < 1e-9 * (1.0 + a.point.coords.norm()));
            prop_assert!((a.value - b.value).abs() < 1e-9 * largest);
        }
        prop_assert!((lines.beta() - whole.beta()).abs() < 1e-9 * largest);
    }

    #[test]
    fn ordering_finds_the_pairs_again_after_any_affine_motion(
        curve in bounded_curves(Degree::Sextic), map in affine_maps(),
    ) {
        let moved_curve = curve.moved(&map).expect("regular");
        let (Some(before), Some(after)) = (well_conditioned(&curve), well_conditioned(&moved_curve)) else {
            return Ok(());
        };
        let found = Correspondence::between(&before, &after, 1.0).expect("three pairs each");
        prop_assume!(found.ordering_margin() > 1e-4);
        prop_assert_eq!(found.by_ordering(), true_permutation(&before.moved(&map).expect("moves"), &after));
    }

    #[test]
    fn continuity_finds_the_pairs_again_after_a_small_motion(
        curve in prop_oneof![bounded_curves(Degree::Quartic), bounded_curves(Degree::Sextic), bounded_curves(Degree::Octic)],
        angle in -0.03..0.03_f64, bx in -0.02..0.02_f64, by in -0.02..0.02_f64,
    ) {
        let map = similarity(angle, 1.0, Vector2::new(bx, by));
        let moved_curve = curve.moved(&map).expect("regular");
        let (Some(before), Some(after)) = (well_conditioned(&curve), well_conditioned(&moved_curve)) else {
            return Ok(());
        };
        let found = Correspondence::between(&before, &after, 1.0).expect("pairs");
        prop_assert_eq!(found.by_continuity(), true_permutation(&before.moved(&map).expect("moves"), &after));
        prop_assert!(found.continuity_cost() < found.runner_up_cost());
    }

    #[test]
    fn a_mirror_symmetric_curve_ties_the_order_and_continuity_decides_right(
        radius in 0.2..0.7_f64, phase in 0.5..2.6_f64, y in -0.5..0.5_f64, conic in 0.2..1.0_f64,
        turn in -0.05..0.05_f64, start in 0.0..6.3_f64,
    ) {
        // Mirror images of each other in the y axis: w and its conjugate, and only even powers of x.
        let w = [C::from_polar(radius, phase), C::from_polar(radius, -phase)];
        let mut lower = [0.0; 10];
        (lower[0], lower[2], lower[3], lower[7], lower[9]) = (-0.5, y, -conic, 0.4 * y, 0.3);
        let symmetric = crate::common::bounded_curve(Degree::Quartic, &w, &lower, 1.0);
        let first = symmetric.moved(&similarity(start, 1.0, Vector2::new(0.1, 0.2))).expect("regular");
        let map = similarity(turn, 1.0, Vector2::new(0.01, -0.02));
        let second = first.moved(&map).expect("regular");
        let (Some(before), Some(after)) = (well_conditioned(&first), well_conditioned(&second)) else { return Ok(()) };
        let found = Correspondence::between(&before, &after, 1.0).expect("two pairs each");
        prop_assert!(found.ordering_margin() < 1e-6, "{}", found.ordering_margin());
        prop_assert_eq!(found.decided_by(), Criterion::Continuity);
        prop_assert_eq!(found.permutation(), true_permutation(&before.moved(&map).expect("moves"), &after));
    }

    #[test]
    fn invariants_stay_under_affine_maps_and_tell_curves_apart(
        curve in prop_oneof![bounded_curves(Degree::Quartic), bounded_curves(Degree::Sextic)], map in affine_maps(),
        other in bounded_curves(Degree::Quartic),
    ) {
        let moved_curve = curve.moved(&map).expect("regular");
        let (Some(before), Some(after)) = (well_conditioned(&curve), well_conditioned(&moved_curve)) else {
            return Ok(());
        };
        // A curve whose values all vanish has none.
        let (Some(a), Some(b)) = (AffineInvariants::of(&before), AffineInvariants::of(&after)) else { return Ok(()) };
        prop_assert!(a.distance(&b).expect("one degree") < 1e-7);
        let largest = (0..a.values().len()).max_by(|&i, &j| a.values()[i].abs().total_cmp(&a.values()[j].abs()));
        let largest = largest.expect("values");
        for i in 0..a.values().len() {
            prop_assert!((a.ratio(i, largest) - b.ratio(i, largest)).abs() < 1e-6);
        }
        if let Some(other) = well_conditioned(&other).and_then(|d| AffineInvariants::of(&d)) {
            match a.distance(&other) {
                None => prop_assert_eq!(curve.degree(), Degree::Sextic),
                Some(distance) => prop_assert!(distance > 1e-6),
            }
        }
    }

    #[test]
    fn the_rotation_chart_turns_by_twice_the_angle_and_has_an_inverse(
        re in -3.0..3.0_f64, im in 0.1..3.0_f64, angle in -3.0..3.0_f64,
    ) {
        let line = freeform_decompose::Line { l: C::new(re, im), k: C::new(0.3, -0.2) };
        let (moved, _) = line.moved(&similarity(angle, 1.0, Vector2::new(0.4, 0.1))).expect("complex");
        let w = rotation_chart(line.l);
        prop_assert!((rotation_chart(moved.l) - w * C::from_polar(1.0, 2.0 * angle)).norm() < 1e-13);
        prop_assert!((from_rotation_chart(w) - line.l).norm() < 1e-12);
        prop_assert!(w.norm() < 1.0);
    }
}

/// Where the pairs really went: the nearest line in the later frame to each line moved by the known motion.
fn true_permutation(moved: &Decomposition, after: &Decomposition) -> Vec<usize> {
    let n = after.degree().value();
    let nearest = |l: C| {
        let distance = |other: C| (rotation_chart(l) - rotation_chart(other)).norm();
        let candidates = after.conjugate_pairs(n).map(|line| distance(line.l)).enumerate();
        candidates.min_by(|a, b| a.1.total_cmp(&b.1)).expect("a pair").0
    };
    moved.conjugate_pairs(n).map(|line| nearest(line.l)).collect()
}

#[test]
fn the_conic_keeps_its_centre_where_alpha_vanishes() {
    // x^4 + y^4 + x y + x - 1: the conic x y + x - 1 has its centre at (0, -1) and no line x + l y + k.
    let a = [-1.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    let curve = ImplicitPolynomial::new(Degree::Quartic, &a).expect("finite");
    assert!(Decomposition::of(&curve).is_err());
    let points = RelatedPoints::of_polynomial(&curve).expect("no factoring");
    assert_eq!(points.as_slice().len(), 3);
    let centre = points.level(2).next().expect("the conic's").point;
    assert!((centre - Point2::new(0.0, -1.0)).norm() < 1e-14);
}

#[test]
fn frames_that_cannot_be_matched_are_refused() {
    let conic = |a: &[f64]| Decomposition::of(&ImplicitPolynomial::new(Degree::Conic, a).expect("6")).expect("lines");
    let (ellipse, hyperbola) = (conic(&[-1.0, 0.0, 0.0, 1.0, 0.0, 2.0]), conic(&[-1.0, 0.0, 0.0, 1.0, 0.0, -2.0]));
    let differ = CorrespondenceError::PairCountDiffers { level: 2, earlier: 1, later: 0 };
    assert_eq!(Correspondence::between(&ellipse, &hyperbola, 1.0), Err(differ));
    let none = CorrespondenceError::NoConjugatePair { level: 2 };
    assert_eq!(Correspondence::between(&hyperbola, &hyperbola, 1.0), Err(none));
    for size in [0.0, -1.0, f64::INFINITY] {
        let refused = Correspondence::between(&ellipse, &ellipse, size);
        assert_eq!(refused, Err(CorrespondenceError::ObjectSize { size }));
    }
    assert!(Correspondence::between(&ellipse, &ellipse, f64::NAN).is_err());
    let single = Correspondence::between(&ellipse, &ellipse, 1.0).expect("one pair");
    assert_eq!(single.permutation(), [0]);
    assert!(single.agrees() && single.ordering_margin() == f64::INFINITY && single.continuity_cost() == 0.0);
}
