//! Curves at the edge of what has a decomposition: nearly double lines, nearly circular leading forms, alpha near 0. What is
//! given out multiplies out to the curve and is right to what its condition number says; the rest is refused by name.
use crate::common::{C, relative_difference, similarity};
use freeform_curve_fit::{Degree, ImplicitPolynomial};
use freeform_decompose::{Decomposition, DecompositionError, Line, RelatedPoints};
use nalgebra::Vector2;
use proptest::prelude::*;

/// A quartic with the pairs `l` and `l + separation` at level 4, and alpha times a conic below.
fn quartic(l: C, separation: C, k: [C; 2], alpha: f64) -> Option<(Decomposition, ImplicitPolynomial)> {
    let with_conjugate = |line: Line| [line, line.conjugate()];
    let conic = Line { l: C::new(0.3, 0.8), k: C::new(0.1, -0.2) };
    let lines = [Line { l, k: k[0] }, Line { l: l + separation, k: k[1] }, conic].map(with_conjugate).concat();
    let truth = Decomposition::from_parts(Degree::Quartic, &lines, &[1.0, alpha, -0.4]).ok()?;
    let curve = truth.expand();
    Some((truth, curve))
}

fn largest_error(found: &Decomposition, truth: &Decomposition) -> f64 {
    let nearest = |line: &Line, list: &[Line]| {
        let distance =
            |other: &Line| ((line.l - other.l).norm() + (line.k - other.k).norm()) / (1.0 + line.l.norm_sqr());
        list.iter().map(distance).fold(f64::INFINITY, f64::min)
    };
    let level = |m: usize| found.level(m).iter().map(move |line| nearest(line, truth.level(m)));
    level(4).chain(level(2)).fold(0.0, f64::max)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    #[test]
    fn nearly_double_lines_are_right_to_what_their_condition_says_or_refused(
        (re, im) in (-1.0..1.0_f64, 0.2..2.0_f64),
        exponent in -14.0..-0.5_f64,
        direction in 0.0..std::f64::consts::TAU,
        k in prop::array::uniform4(-0.5..0.5_f64),
    ) {
        let separation = C::from_polar(10.0_f64.powf(exponent), direction);
        let k = [C::new(k[0], k[1]), C::new(k[2], k[3])];
        let Some((truth, curve)) = quartic(C::new(re, im), separation, k, 0.7) else { return Ok(()) };
        match Decomposition::of(&curve) {
            Ok(found) => {
                prop_assert!(relative_difference(&found.expand(), &curve) < 1e-5);
                let (error, condition) = (largest_error(&found, &truth), truth.condition().number());
                prop_assert!(error < 1e-13 * condition, "{error:e}, condition {condition:e}");
            }
            Err(error) => {
                let expected = matches!(
                    error,
                    DecompositionError::NearDoubleLines { .. }
                        | DecompositionError::IllConditioned { .. }
                        | DecompositionError::CircularLeadingForm { .. }
                );
                prop_assert!(expected && exponent < -2.0, "{separation}: {error}");
            }
        }
    }

    #[test]
    fn leading_forms_near_the_circle_are_refused_or_turn_with_the_curve(
        exponent in -14.0..-0.5_f64,
        direction in 0.0..std::f64::consts::TAU,
        k in prop::array::uniform4(-0.5..0.5_f64),
        turn in -3.0..3.0_f64,
    ) {
        // (x^2 + y^2)^2 has the double roots +-i.
        let away = C::from_polar(10.0_f64.powf(exponent), direction);
        let k = [C::new(k[0], k[1]), C::new(k[2], k[3])];
        let Some((_, curve)) = quartic(C::new(0.0, 1.0) - away, 2.0 * away, k, 0.7) else { return Ok(()) };
        let map = similarity(turn, 1.0, Vector2::new(0.3, -0.2));
        let turned = curve.moved(&map).expect("a similarity");
        match (Decomposition::of(&curve), Decomposition::of(&turned)) {
            (Ok(here), Ok(there)) => {
                let expected = here.moved(&map).expect("no real line at level 4");
                let condition = here.condition().number().max(there.condition().number());
                let error = largest_error(&there, &expected);
                prop_assert!(error < 1e-13 * condition, "{error:e}, condition {condition:e}");
            }
            (here, there) => {
                // At the limit one of the two may pass.
                let refused = here.err().or(there.err()).expect("one error");
                prop_assert!(exponent < -2.0, "{exponent}: {refused}");
            }
        }
    }

    #[test]
    fn alpha_near_zero_costs_the_conic_and_nothing_else(
        exponent in -18.0..0.0_f64,
        k in prop::array::uniform4(-0.5..0.5_f64),
    ) {
        let alpha = 10.0_f64.powf(exponent);
        let k = [C::new(k[0], k[1]), C::new(k[2], k[3])];
        let (truth, curve) = quartic(C::new(0.4, 0.6), C::new(-0.9, 0.5), k, alpha).expect("apart");
        // The related points of level 4 need no conic.
        match Decomposition::of(&curve) {
            Ok(found) => {
                prop_assert!(relative_difference(&found.expand(), &curve) < 1e-5);
                let condition = truth.condition().number();
                let error = largest_error(&found, &truth);
                prop_assert!(error < 1e-13 * condition, "{error:e}, condition {condition:e}");
                for related in RelatedPoints::of(&found).as_slice() {
                    prop_assert!(related.point.coords.iter().all(|c| c.is_finite()) && related.value.is_finite());
                }
            }
            Err(error) => {
                let expected = matches!(
                    error,
                    DecompositionError::VanishingLeadingCoefficient { level: 2, .. }
                        | DecompositionError::IllConditioned { .. }
                        | DecompositionError::NearDoubleLines { level: 2, .. }
                );
                prop_assert!(expected && exponent < -5.0, "alpha {alpha:e}: {error}");
            }
        }
    }

    #[test]
    fn units_from_a_millionth_to_a_million_change_nothing_but_the_unit(
        exponent in -6.0..6.0_f64,
        k in prop::array::uniform4(-0.5..0.5_f64),
    ) {
        let k = [C::new(k[0], k[1]), C::new(k[2], k[3])];
        let (truth, curve) = quartic(C::new(0.4, 0.6), C::new(-0.9, 0.5), k, 0.7).expect("apart");
        let unit = 10.0_f64.powf(exponent);
        let map = similarity(0.0, unit, Vector2::zeros());
        let there = Decomposition::of(&curve.moved(&map).expect("a similarity"));
        let back = similarity(0.0, 1.0 / unit, Vector2::zeros());
        match there {
            Ok(there) => {
                let error = largest_error(&there.moved(&back).expect("a similarity"), &truth);
                prop_assert!(error < 1e-9, "unit {unit:e}: {error:e}");
            }
            // Beyond, the powers of the unit leave too few digits, which is said.
            Err(error) => prop_assert!(
                matches!(error, DecompositionError::IllConditioned { .. }) && exponent.abs() > 1.0,
                "unit {unit:e}: {error}"
            ),
        }
    }
}
