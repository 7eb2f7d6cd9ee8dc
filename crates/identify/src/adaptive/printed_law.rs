use freeform_riccati::{AffineMotion, MotionModel};
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
        Self { stability, lyapunov, matrices: matrices_of(motion) }
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

    /// Goes on in other coordinates. The states of the estimator, which the caller holds, move as X does.
    pub(crate) fn shift_origin(&mut self, shift: &OriginShift) {
        self.matrices = shift.of_rates() * self.matrices * shift.inverse().of_signals();
    }

    /// The parameters of a model that the matrices hold, entries that should be equal averaged.
    pub(crate) fn parameters(&self, model: MotionModel) -> SVector<f64, 6> {
        let m = &self.matrices;
        let a1 = 0.5 * (m[(2, 2)] + m[(3, 3)]);
        let a4 = a1 - 0.5 * (m[(0, 0)] + m[(1, 1)]);
        let a3 = 0.25 * (m[(0, 4)] + m[(1, 5)] + m[(2, 6)] + m[(3, 7)]);
        let (a2, b1) = (m[(0, 8)], m[(2, 8)]);
        let b2 = -0.5 * (m[(2, 0)] + m[(3, 1)]);
        let parameters = model.parameters_of(&AffineMotion { a1, a2, a3, a4, b1, b2 }.generator());
        SVector::from_column_slice(&parameters[..6])
    }
}

/// `[A | C | B]` of equation 19.
fn matrices_of(motion: &AffineMotion) -> SMatrix<f64, 4, 9> {
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
    use freeform_riccati::RealVariables;
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn the_matrices_of_a_motion_give_the_rate_of_the_lines_and_the_motion_back(
            x in prop::array::uniform4(-3.0..3.0_f64),
            p in prop::array::uniform6(-2.0..2.0_f64),
        ) {
            let motion = AffineMotion { a1: p[0], a2: p[1], a3: p[2], a4: p[3], b1: p[4], b2: p[5] };
            let state = Vector4::from(x);
            let rate = RealVariables::from(state).rate(&motion);
            prop_assert!((matrices_of(&motion) * signals(&state) - rate).norm() < 1e-12);
            let law = PrintedLaw::new(-Matrix4::identity(), Matrix4::identity(), &motion);
            prop_assert!((law.parameters(MotionModel::Affine) - SVector::from(p)).norm() < 1e-12);
        }

        #[test]
        fn any_matrices_give_the_same_rate_of_the_lines_where_the_origin_moves(
            x in prop::array::uniform4(-3.0..3.0_f64),
            entries in prop::collection::vec(-2.0..2.0_f64, 36),
            origin in prop::array::uniform2(-5.0..5.0_f64),
        ) {
            let (state, shift) = (Vector4::from(x), OriginShift::to(origin.into()));
            let matrices = SMatrix::<f64, 4, 9>::from_column_slice(&entries);
            let mut law = PrintedLaw { matrices, ..PrintedLaw::new(-Matrix4::identity(), Matrix4::identity(), &AffineMotion::default()) };
            law.shift_origin(&shift);
            let moved = law.matrices * signals(&shift.state(&state));
            prop_assert!((moved - shift.of_rates() * matrices * signals(&state)).norm() < 1e-9);
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
}
