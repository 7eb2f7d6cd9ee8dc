use freeform_riccati::{AffineMotion, MAX_PARAMETERS, MotionModel};
use nalgebra::{Matrix4, SMatrix, SVector, Vector4};

use super::{origin_shift::OriginShift, regressor::quadratic_terms, structured_law::PairInput};

/// The estimator (21) as printed. Its 36 numbers `[A | C | B]` (4 by 9) multiply the 9 signals `(X, f(X), -1)`:
/// `Xh' = Am (Xh - X) + [A | C | B] signals`, `[A | C | B]' = -P (Xh - X) signals'`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PrintedLaw {
    stability: Matrix4<f64>,
    lyapunov: Matrix4<f64>,
    matrices: SMatrix<f64, 4, 9>,
}

impl PrintedLaw {
    /// Starts from the matrices that belong to a motion (equation 19).
    pub(crate) fn new(stability: Matrix4<f64>, lyapunov: Matrix4<f64>, motion: &AffineMotion) -> Self {
        Self { stability, lyapunov, matrices: plant_matrices(motion) }
    }

    /// `[A | C | B]` as adapted so far.
    pub(crate) fn matrices(&self) -> &SMatrix<f64, 4, 9> {
        &self.matrices
    }

    /// One step of `seconds` by the implicit midpoint rule, as in the structured law, over one pair.
    pub(crate) fn step(&mut self, seconds: f64, state: &mut Vector4<f64>, input: &PairInput) {
        let half = 0.5 * seconds;
        let signals = signals(&input.state);
        let drive = self.matrices * signals;
        // The mean matrices of the step are M - h/2 P e s'; put into the equation for the mean error e.
        let matrix = Matrix4::identity() - half * self.stability
            + half * half * input.weight * signals.norm_squared() * self.lyapunov;
        let Some(error) = matrix.lu().solve(&(*state - input.state + half * drive)) else { return };
        let change = -seconds * input.weight * self.lyapunov * error * signals.transpose();
        *state += seconds * (self.stability * error + drive) + half * (change * signals);
        self.matrices += change;
    }

    #[cfg(feature = "serde")]
    pub(crate) fn numbers_mut(&mut self) -> impl Iterator<Item = &mut f64> {
        self.matrices.iter_mut()
    }

    /// Goes on in other coordinates. The states of the estimator, which the caller holds, move as X does.
    pub(crate) fn shift_origin(&mut self, shift: &OriginShift) {
        self.matrices = shift.of_rates() * self.matrices * shift.inverse().of_signals();
    }

    /// The parameters of a model that the matrices hold, entries that should be equal averaged.
    pub(crate) fn parameters(&self, model: MotionModel) -> SVector<f64, MAX_PARAMETERS> {
        let m = &self.matrices;
        let a1 = 0.5 * (m[(2, 2)] + m[(3, 3)]);
        let a4 = a1 - 0.5 * (m[(0, 0)] + m[(1, 1)]);
        let a3 = 0.25 * (m[(0, 4)] + m[(1, 5)] + m[(2, 6)] + m[(3, 7)]);
        let (a2, b1) = (m[(0, 8)], m[(2, 8)]);
        let b2 = -0.5 * (m[(2, 0)] + m[(3, 1)]);
        let parameters = model.parameters_of(&AffineMotion { a1, a2, a3, a4, b1, b2 }.generator());
        parameters.into()
    }
}

/// The 36 numbers of equation 19 that belong to a motion: `[A | C | B]`, 4 by 9, which the signals `(X, f(X), -1)` of a line pair are
/// multiplied by.
#[must_use]
pub fn plant_matrices(motion: &AffineMotion) -> SMatrix<f64, 4, 9> {
    let AffineMotion { a1, a2, a3, a4, b1, b2 } = *motion;
    let mut matrices = SMatrix::zeros();
    (matrices[(0, 0)], matrices[(1, 1)], matrices[(2, 2)], matrices[(3, 3)]) = (a1 - a4, a1 - a4, a1, a1);
    (matrices[(2, 0)], matrices[(3, 1)]) = (-b2, -b2);
    (0..4).for_each(|i| matrices[(i, 4 + i)] = a3);
    (matrices[(0, 8)], matrices[(2, 8)]) = (a2, b1);
    matrices
}

fn signals(x: &Vector4<f64>) -> SVector<f64, 9> {
    let f = quadratic_terms(x);
    SVector::from([x[0], x[1], x[2], x[3], f[0], f[1], f[2], f[3], -1.0])
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use freeform_decompose::{Line, from_rotation_chart};
    use freeform_riccati::{RealVariables, line_flow};
    use nalgebra::Complex;
    use proptest::prelude::*;

    use super::*;
    use crate::solve_lyapunov;

    proptest! {
        #[test]
        fn the_matrices_of_a_motion_give_the_rate_of_the_lines_and_the_motion_back(
            x in prop::array::uniform4(-3.0..3.0_f64),
            p in prop::array::uniform6(-2.0..2.0_f64),
        ) {
            let motion = AffineMotion { a1: p[0], a2: p[1], a3: p[2], a4: p[3], b1: p[4], b2: p[5] };
            let state = Vector4::from(x);
            let rate = RealVariables::from(state).rate(&motion);
            prop_assert!((plant_matrices(&motion) * signals(&state) - rate).norm() < 1e-12);
            let law = PrintedLaw::new(-Matrix4::identity(), Matrix4::identity(), &motion);
            prop_assert!((law.parameters(MotionModel::Affine).fixed_rows::<6>(0) - SVector::from(p)).norm() < 1e-12);
        }

        #[test]
        fn any_matrices_give_the_same_rate_of_the_lines_where_the_origin_moves(
            x in prop::array::uniform4(-3.0..3.0_f64),
            entries in prop::collection::vec(-2.0..2.0_f64, 36),
            origin in prop::array::uniform2(-5.0..5.0_f64),
        ) {
            let (state, shift) = (Vector4::from(x), OriginShift::to(origin.into()));
            let matrices = SMatrix::<f64, 4, 9>::from_column_slice(&entries);
            let at_rest = PrintedLaw::new(-Matrix4::identity(), Matrix4::identity(), &AffineMotion::default());
            let mut law = PrintedLaw { matrices, ..at_rest };
            law.shift_origin(&shift);
            let moved = law.matrices * signals(&shift.state(&state));
            prop_assert!((moved - shift.of_rates() * matrices * signals(&state)).norm() < 1e-9);
        }

        /// Over a line at rest, whose true matrices are zero, so that the matrices are their own error.
        #[test]
        fn the_lyapunov_function_of_the_36_numbers_never_grows_whatever_the_line_gains_and_steps(
            x in prop::array::uniform4(-20.0..20.0_f64),
            error in prop::array::uniform4(-5.0..5.0_f64),
            p in prop::array::uniform6(-2.0..2.0_f64),
            decay in prop::array::uniform4(0.1..20.0_f64),
            step in 1e-3..10.0_f64,
        ) {
            let stability = -Matrix4::from_diagonal(&Vector4::from(decay));
            let lyapunov = solve_lyapunov(&stability, &Matrix4::identity()).expect("stable");
            let motion = AffineMotion { a1: p[0], a2: p[1], a3: p[2], a4: p[3], b1: p[4], b2: p[5] };
            let mut law = PrintedLaw::new(stability, lyapunov, &motion);
            let input = PairInput { state: Vector4::from(x), weight: 1.0 };
            let mut state = input.state + Vector4::from(error);
            let function = |law: &PrintedLaw, state: &Vector4<f64>| {
                let e = state - input.state;
                e.dot(&(lyapunov * e)) + law.matrices.norm_squared()
            };
            for _ in 0..20 {
                let before = function(&law, &state);
                law.step(step, &mut state, &input);
                let after = function(&law, &state);
                prop_assert!(after <= before * (1.0 + 1e-8) + 1e-12, "{} to {}", before, after);
            }
        }
    }

    #[test]
    fn the_error_of_the_state_decays_over_a_line_at_rest() {
        let paper = Vector4::new(-0.5, -0.5, -1.0, -1.0);
        let lyapunov = Matrix4::from_diagonal(&Vector4::new(0.5, 1.0, 1.0, 1.5));
        let mut law = PrintedLaw::new(Matrix4::from_diagonal(&paper), lyapunov, &AffineMotion::default());
        let input = PairInput { state: Vector4::new(0.4, 0.7, 0.1, -0.2), weight: 1.0 };
        let mut state = input.state + Vector4::new(0.3, -0.2, 0.1, 0.4);
        let start = (state - input.state).norm();
        (0..1800).for_each(|_| law.step(1.0 / 30.0, &mut state, &input));
        assert!((state - input.state).norm() < 1e-3 * start, "{start} to {}", (state - input.state).norm());
    }

    /// The flight bird in the image, f/Z0 = 0.1.
    const BIRD: AffineMotion = AffineMotion { a1: 0.0, a2: FRAC_PI_2, a3: -FRAC_PI_2, a4: 0.0, b1: -0.3, b2: 0.4 };

    /// Steps of one turn of the bird.
    const STEPS: usize = 480;

    /// The states of a line pair in the middle of every step of one turn.
    fn one_turn(w: (f64, f64), k: (f64, f64)) -> Vec<Vector4<f64>> {
        let line = Line { l: from_rotation_chart(Complex::from_polar(w.0, w.1)), k: Complex::new(k.0, k.1) };
        let state = |step: usize| {
            let seconds = 4.0 * (step as f64 + 0.5) / STEPS as f64;
            let (line, _) = line_flow(&BIRD.generator(), &line, seconds).expect("complex lines stay");
            Vector4::new(line.l.re, line.l.im, line.k.re, line.k.im)
        };
        (0..STEPS).map(state).collect()
    }

    /// Pairs that tell of rotation as well as those of the paper's objects.
    fn turning_pairs() -> [Vec<Vector4<f64>>; 3] {
        [one_turn((0.5, 0.4), (0.1, -0.2)), one_turn((0.4, -2.2), (-0.15, 0.1)), one_turn((0.6, 1.0), (0.3, 0.1))]
    }

    #[test]
    fn nine_signals_determine_the_36_numbers_and_excite_some_of_them_hundreds_of_times_less_than_others() {
        for states in turning_pairs() {
            let products = states.iter().map(|x| signals(x) * signals(x).transpose());
            let mean: SMatrix<f64, 9, 9> = products.sum::<SMatrix<f64, 9, 9>>() / STEPS as f64;
            let eigenvalues = mean.symmetric_eigen().eigenvalues;
            println!("{:.4} to {:.2}", eigenvalues.min(), eigenvalues.max());
            assert!(eigenvalues.min() > 1e-3, "excited persistently: {eigenvalues}");
            assert!(eigenvalues.max() > 300.0 * eigenvalues.min(), "{eigenvalues}");
        }
    }

    #[test]
    fn the_36_numbers_are_a_third_off_after_half_a_minute_and_near_the_truth_after_half_an_hour() {
        let truth = plant_matrices(&BIRD);
        for states in turning_pairs() {
            let stability = Matrix4::from_diagonal(&Vector4::new(-0.5, -0.5, -1.0, -1.0));
            let lyapunov = Matrix4::from_diagonal(&Vector4::new(0.5, 1.0, 1.0, 1.5));
            let mut law = PrintedLaw::new(stability, lyapunov, &AffineMotion::default());
            let mut state = states[0];
            // Seconds in: how far the matrices are off, and the largest error of the state in the turn before.
            let mut after = |turns: std::ops::Range<usize>| {
                let mut largest = 0.0_f64;
                for _ in turns {
                    largest = 0.0;
                    for x in &states {
                        law.step(4.0 / STEPS as f64, &mut state, &PairInput { state: *x, weight: 1.0 });
                        largest = largest.max((state - x).norm());
                    }
                }
                ((law.matrices - truth).norm() / truth.norm(), largest)
            };
            let (start, soon, late) = (after(0..1), after(1..8), after(8..450));
            println!("after 4 s {start:.4?}, 32 s {soon:.4?}, 1800 s {late:.4?}");
            assert!(soon.0 > 1.0 / 3.0 && late.0 < 0.1, "{soon:?} {late:?}");
            assert!(late.1 < 0.1 * start.1, "the error of the state goes to zero: {start:?} {late:?}");
        }
    }
}
