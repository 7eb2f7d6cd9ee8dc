//! The dynamics of lines and coefficients against decompositions of curves moved as a whole, of every degree.
use freeform_curve_fit::Degree;
use freeform_decompose::{Decomposition, Line};
use freeform_riccati::{AffineMotion, AlphaBeta, MotionModel, Transport, level_factor, moved_line};
use nalgebra::Complex;
use proptest::prelude::*;

use crate::support::{affine_motion, distance, line, relative_difference};

/// Decompositions with complex lines that keep some distance from each other.
fn decomposition() -> impl Strategy<Value = Decomposition> {
    let parts =
        (prop::collection::vec(line(), 10), prop::collection::vec(0.2..1.5, 5), prop::array::uniform5(any::<bool>()));
    (prop::sample::select(&Degree::ALL[..]), parts).prop_filter_map(
        "lines too near each other",
        |(degree, (lines, sizes, signs))| {
            let levels = degree.value() / 2;
            let pairs = levels * (levels + 1) / 2;
            let mut start = 0;
            for pairs in (1..=levels).rev() {
                let level = &lines[start..start + pairs];
                let upper = |line: &Line| if line.l.im < 0.0 { line.l.conj() } else { line.l };
                let near = |i: usize, j: usize| (upper(&level[i]) - upper(&level[j])).norm() < 0.4;
                if (0..pairs).any(|i| (0..i).any(|j| near(i, j))) {
                    return None;
                }
                start += pairs;
            }
            let lines: Vec<_> = lines[..pairs].iter().flat_map(|line| [*line, line.conjugate()]).collect();
            let mut coefficients: Vec<_> =
                sizes.iter().zip(signs).map(|(size, positive)| if positive { *size } else { -size }).collect();
            coefficients.truncate(levels + 1);
            Decomposition::from_parts(degree, &lines, &coefficients).ok()
        },
    )
}

/// Small motions, so that every curve on the way has a well-conditioned decomposition.
fn gentle_motion() -> impl Strategy<Value = AffineMotion> {
    affine_motion().prop_map(|m| {
        let [a1, a2, a3, a4, b1, b2] = [m.a1, m.a2, m.a3, m.a4, m.b1, m.b2].map(|v| 0.5 * v);
        AffineMotion { a1, a2, a3, a4, b1, b2 }
    })
}

fn nearest(lines: &[Line], to: Complex<f64>) -> Line {
    *lines.iter().min_by(|a, b| (a.l - to).norm().total_cmp(&(b.l - to).norm())).expect("not empty")
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn the_curve_rebuilt_from_moved_lines_and_coefficients_is_the_moved_curve(
        before in decomposition(), motion in gentle_motion(),
    ) {
        let map = motion.flow(1.0);
        let mut lines = Vec::new();
        let leading = before.level(before.degree().value());
        let c_n = before.coefficient(leading.len());
        // f' = prod s f'_monic: the leading coefficient picks up the chart's factors of its own level.
        let factor = leading.iter().map(|l| moved_line(l, &map).expect("in the chart").1).product::<Complex<f64>>().re;
        let mut coefficients = vec![];
        for level in before.levels().chain([0]) {
            let part = before.level(level);
            lines.extend(part.iter().map(|line| moved_line(line, &map).expect("in the chart").0));
            let monic = before.coefficient(level) / c_n * level_factor(&map, leading, part).expect("in the chart");
            coefficients.push(monic * c_n * factor);
        }
        let rebuilt = Decomposition::from_parts(before.degree(), &lines, &coefficients).expect("still apart").expand();
        let moved = before.expand().moved(&map).expect("regular");
        prop_assert!(relative_difference(rebuilt.coefficients(), moved.coefficients()) < 1e-11);
        let transport = Transport::new(before.degree(), &map).expect("regular");
        let transported = transport.polynomial(&before.expand()).expect("same degree");
        prop_assert!(relative_difference(rebuilt.coefficients(), transported.coefficients()) < 1e-11);
    }

    #[test]
    fn lines_and_coefficients_flow_to_the_decomposition_of_the_moved_curve(
        before in decomposition(), motion in gentle_motion(),
    ) {
        let map = motion.flow(1.0);
        let moved = before.expand().moved(&map).expect("regular");
        let after = Decomposition::of(&moved);
        prop_assume!(after.is_ok());
        let after = after.expect("assumed");
        let condition = after.condition().number();
        prop_assume!(condition < 1e5);
        let tolerance = 2e-14 * condition;
        let leading = before.level(before.degree().value());
        for level in before.levels() {
            for line in before.level(level) {
                let (flowed, _) = moved_line(line, &map).expect("in the chart");
                let found = nearest(after.level(level), flowed.l);
                prop_assert!(distance(flowed.l, found.l) < tolerance && distance(flowed.k, found.k) < tolerance);
            }
        }
        let monic = |d: &Decomposition, level: usize| d.coefficient(level) / d.coefficient(leading.len());
        for level in before.levels().chain([0]) {
            let factor = level_factor(&map, leading, before.level(level)).expect("in the chart");
            let expected = monic(&before, level) * factor;
            prop_assert!((monic(&after, level) - expected).abs() < tolerance * expected.abs().max(1.0));
        }
        if before.degree() == Degree::Quartic {
            let [quartic, conic] = [before.level(4), before.level(2)];
            let moved = AlphaBeta { alpha: before.alpha(), beta: before.beta() }
                .moved(&map, quartic.try_into().expect("four lines"), conic.try_into().expect("two lines"))
                .expect("in the chart");
            prop_assert!((moved.alpha - after.alpha()).abs() < tolerance * moved.alpha.abs().max(1.0));
            prop_assert!((moved.beta - after.beta()).abs() < tolerance * moved.beta.abs().max(1.0));
        }
    }

    #[test]
    fn decompositions_move_here_as_they_do_by_themselves(before in decomposition(), motion in gentle_motion()) {
        let parameters = [motion.a1, motion.a2, motion.a3, motion.a4, motion.b1, motion.b2];
        let after = before.moved(&motion.flow(0.5)).expect("stays in the chart");
        let map = MotionModel::Affine.flow(&parameters, 0.5);
        for level in before.levels() {
            for (line, expected) in before.level(level).iter().zip(after.level(level)) {
                let (moved, _) = moved_line(line, &map).expect("in the chart");
                prop_assert!(distance(moved.l, expected.l) < 1e-13 && distance(moved.k, expected.k) < 1e-13);
            }
        }
    }
}
