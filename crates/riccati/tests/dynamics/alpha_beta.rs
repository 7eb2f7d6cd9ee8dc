use freeform_decompose::Line;
use freeform_riccati::{
    AffineMotion, AlphaBeta, DynamicsError, RealVariables, level_factor, level_rate, line_rate, moved_line,
};
use nalgebra::{Affine2, Complex, Matrix3, Point2, Vector4};
use proptest::prelude::*;

use crate::support::{affine_motion, distance, dop853, line};

/// A monic quartic by its factors: two conjugate pairs, one conjugate pair, alpha and beta.
#[derive(Debug, Clone, Copy)]
struct Factors {
    quartic: [Line; 4],
    conic: [Line; 2],
    coefficients: AlphaBeta,
}

impl Factors {
    fn evaluate(&self, p: &Point2<f64>) -> f64 {
        let product = |lines: &[Line]| lines.iter().map(|line| line.evaluate(p)).product::<Complex<f64>>().re;
        product(&self.quartic) + self.coefficients.alpha * product(&self.conic) + self.coefficients.beta
    }

    fn moved(&self, map: &Affine2<f64>) -> Self {
        let moved = |line: Line| moved_line(&line, map).expect("complex lines stay in the chart").0;
        let coefficients = self.coefficients.moved(map, &self.quartic, &self.conic).expect("in the chart");
        Self { quartic: self.quartic.map(moved), conic: self.conic.map(moved), coefficients }
    }
}

fn factors() -> impl Strategy<Value = Factors> {
    (line(), line(), line(), -2.0..2.0, -2.0..2.0).prop_map(|(first, second, third, alpha, beta)| Factors {
        quartic: [first, first.conjugate(), second, second.conjugate()],
        conic: [third, third.conjugate()],
        coefficients: AlphaBeta { alpha, beta },
    })
}

/// Largest relative spread of `f'(T p) / f(p)` over a few points; 0 where f' is the moved f up to a factor.
fn ratio_spread(before: &Factors, after: &Factors, map: &Affine2<f64>) -> f64 {
    let values: Vec<_> = (0..12)
        .map(|i| Point2::new((1.7 * f64::from(i)).sin(), (2.9 * f64::from(i) + 0.4).sin()))
        .map(|p| (after.evaluate(&(map * p)), before.evaluate(&p)))
        .collect();
    // The common factor by least squares over the points.
    let factor = values.iter().map(|(a, b)| a * b).sum::<f64>() / values.iter().map(|(_, b)| b * b).sum::<f64>();
    let scale = values.iter().fold(0.0_f64, |m, (a, _)| m.max(a.abs()));
    values.iter().fold(0.0_f64, |m, (a, b)| m.max((a - factor * b).abs())) / scale
}

/// Equation 7 as printed, with the ratio of q upside down.
fn printed_alpha(map: &Affine2<f64>, factors: &Factors) -> f64 {
    let product =
        |lines: &[Line]| lines.iter().map(|l| moved_line(l, map).expect("in the chart").1).product::<Complex<f64>>();
    factors.coefficients.alpha / (product(&factors.quartic) * product(&factors.conic)).re
}

#[test]
fn equation_7_holds_with_the_ratio_of_q_the_right_way_up_and_not_as_printed() {
    let pair = |l1, l2, k1, k2| {
        let line = Line { l: Complex::new(l1, l2), k: Complex::new(k1, k2) };
        [line, line.conjugate()]
    };
    let ([a, b], [c, d]) = (pair(0.3, 0.8, 0.1, -0.4), pair(-0.5, 1.3, 0.2, 0.6));
    let factors = Factors {
        quartic: [a, b, c, d],
        conic: pair(0.2, 1.1, -0.3, 0.2),
        coefficients: AlphaBeta { alpha: -0.9, beta: 0.3 },
    };
    let map = AffineMotion { a1: 0.2, a2: 0.7, a3: -0.6, a4: -0.1, b1: 0.3, b2: -0.2 }.flow(0.8);
    let moved = factors.moved(&map);
    assert!(ratio_spread(&factors, &moved, &map) < 1e-13);
    let alpha = printed_alpha(&map, &factors);
    let printed = Factors { coefficients: AlphaBeta { alpha, ..moved.coefficients }, ..moved };
    assert!(ratio_spread(&factors, &printed, &map) > 1e-2);
}

#[test]
fn a_singular_map_gives_an_error_instead_of_a_factor() {
    let line = Line { l: Complex::new(0.0, 1.0), k: Complex::new(0.0, 0.0) };
    let singular = Affine2::from_matrix_unchecked(Matrix3::new(1., 1., 0., 1., 1., 0., 0., 0., 1.));
    assert!(matches!(level_factor(&singular, &[line], &[]), Err(DynamicsError::SingularMap { .. })));
}

proptest! {
    #[test]
    fn moved_factors_with_moved_alpha_and_beta_are_the_moved_curve(factors in factors(), motion in affine_motion()) {
        let map = motion.flow(0.9);
        let moved = factors.moved(&map);
        prop_assert!(ratio_spread(&factors, &moved, &map) < 1e-11);
    }

    #[test]
    fn closed_forms_of_alpha_and_beta_solve_their_differential_equations(
        factors in factors(), motion in affine_motion(), t in 0.1..1.0,
    ) {
        // One line of each pair, its conjugate implied, then alpha and beta.
        let a = motion.generator();
        let lines = [factors.quartic[0], factors.quartic[2], factors.conic[0]];
        let mut start = [0.0; 14];
        for (slot, line) in start.chunks_exact_mut(4).zip(lines) {
            slot.copy_from_slice(RealVariables::from(line).state().as_slice());
        }
        start[12] = factors.coefficients.alpha;
        start[13] = factors.coefficients.beta;
        let rate = |_: f64, y: &[f64; 14]| {
            let [p, q, r] = [0, 4, 8].map(|i| Line::from(RealVariables::from(Vector4::new(y[i], y[i + 1], y[i + 2], y[i + 3]))));
            let mut out = [0.0; 14];
            for (slot, line) in out.chunks_exact_mut(4).zip([p, q, r]) {
                let rate = line_rate(&a, &line);
                slot.copy_from_slice(&[rate.l.re, rate.l.im, rate.k.re, rate.k.im]);
            }
            let coefficients = AlphaBeta { alpha: y[12], beta: y[13] };
            let rate = coefficients.rate(
                &motion, &[p, p.conjugate(), q, q.conjugate()], &[r, r.conjugate()]);
            (out[12], out[13]) = (rate.alpha, rate.beta);
            out
        };
        let end = dop853(rate, start, 0.0, t);
        let moved = factors.moved(&motion.flow(t)).coefficients;
        prop_assert!((moved.alpha - end[12]).abs() < 1e-12 * moved.alpha.abs().max(1.0));
        prop_assert!((moved.beta - end[13]).abs() < 1e-12 * moved.beta.abs().max(1.0));
    }

    #[test]
    fn the_rate_of_a_general_level_is_the_derivative_of_its_factor(
        lines in prop::collection::vec(line(), 4), m in 0_usize..4, motion in affine_motion(),
    ) {
        let all: Vec<_> = lines.iter().flat_map(|line| [*line, line.conjugate()]).collect();
        let level: Vec<_> = all[..2 * m].iter().map(|line| Line { l: line.l * 0.7, k: line.k }).collect();
        let factor = |t: f64| level_factor(&motion.flow(t), &all, &level).expect("in the chart").ln();
        let h = 1e-3;
        // Central differences of order 4.
        let slope = (8.0 * (factor(h) - factor(-h)) - (factor(2.0 * h) - factor(-2.0 * h))) / (12.0 * h);
        prop_assert!((slope - level_rate(&motion, &all, &level)).abs() < 1e-8);
    }

    #[test]
    fn factors_of_the_chart_compose_over_two_maps(line in line(), first in affine_motion(), second in affine_motion()) {
        let (first, second) = (first.flow(0.5), second.flow(0.5));
        let (moved, s) = moved_line(&line, &first).expect("in the chart");
        let (_, r) = moved_line(&moved, &second).expect("in the chart");
        let (_, whole) = moved_line(&line, &(second * first)).expect("in the chart");
        prop_assert!(distance(s * r, whole) < 1e-13);
    }
}
