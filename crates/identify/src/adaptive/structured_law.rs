use nalgebra::{Const, DimMin, Matrix4, SMatrix, SVector, Vector4};

use super::{origin_shift::OriginShift, regressor::Regressor};

/// The estimator (21) with the structure of its matrices known: over each line pair `Xh' = Am (Xh - X) + W(X) theta`, and
/// over all of them together `theta' = -sum W' P (Xh - X)`.
///
/// Steps are taken by the implicit midpoint rule. Over lines at rest during a step it keeps the Lyapunov function `sum e' P e
/// + |theta error|^2` from growing whatever the step, so that a line that swings far out does not make the law unstable.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct StructuredLaw<const N: usize> {
    regressor: Regressor<N>,
    stability: Matrix4<f64>,
    lyapunov: Matrix4<f64>,
    parameters: SVector<f64, N>,
    /// Whether the linear part of the motion follows the slopes l alone.
    by_slopes: bool,
}

/// The state Xh of the estimator over one line pair.
pub(crate) type EstimatorState = Vector4<f64>;

/// What one pair contributes to one step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PairInput {
    /// X in the middle of the step.
    pub(crate) state: Vector4<f64>,
    /// Weight of the pair, 1 for the best.
    pub(crate) weight: f64,
}

impl<const N: usize> StructuredLaw<N>
where
    Const<N>: DimMin<Const<N>, Output = Const<N>>,
{
    pub(crate) fn new(
        regressor: Regressor<N>,
        stability: Matrix4<f64>,
        lyapunov: Matrix4<f64>,
        parameters: SVector<f64, N>,
    ) -> Self {
        Self { regressor, stability, lyapunov, parameters, by_slopes: false }
    }

    pub(crate) fn parameters(&self) -> &SVector<f64, N> {
        &self.parameters
    }

    #[cfg(feature = "serde")]
    pub(crate) fn numbers_mut(&mut self) -> impl Iterator<Item = &mut f64> {
        self.parameters.iter_mut()
    }

    #[cfg(feature = "serde")]
    pub(crate) fn by_slopes_mut(&mut self) -> &mut bool {
        &mut self.by_slopes
    }

    /// Goes on in other coordinates. The states of the estimator, which the caller holds, move as X does.
    ///
    /// With every shift the error of b takes in that of the linear part. Were it to act back on it, through k, a fast object
    /// could make the law unstable; the linear part then follows the slopes l alone, as `by_slopes` says.
    pub(crate) fn shift_origin(&mut self, shift: &OriginShift, by_slopes: bool) {
        self.by_slopes = by_slopes;
        self.parameters = shift.of_parameters(self.regressor.model()) * self.parameters;
    }

    /// How the errors pull on the parameters: W', or what is left of it for an object that travels.
    fn pull(&self, w: &SMatrix<f64, 4, N>) -> SMatrix<f64, N, 4> {
        let mut pull = w.transpose();
        if self.by_slopes {
            for (mut row, acts_on_slopes) in pull.row_iter_mut().zip(self.regressor.acts_on_slopes()) {
                if acts_on_slopes {
                    row.fixed_columns_mut::<2>(2).fill(0.0);
                }
            }
        }
        pull
    }

    /// One step of `seconds`, over the estimator states and inputs of all pairs.
    ///
    /// The midpoint rule in the mean error e and the mean parameters theta of the step:
    /// `(I - h/2 Am) e = Xh - X + h/2 W theta` for every pair and `theta = theta_0 - h/2 sum W' P e`. Eliminating the
    /// errors leaves N equations.
    pub(crate) fn step(&mut self, seconds: f64, states: &mut [EstimatorState], inputs: &[PairInput]) {
        let half = 0.5 * seconds;
        let Some(damping) = (Matrix4::identity() - half * self.stability).try_inverse() else { return };
        let mut matrix = SMatrix::<f64, N, N>::identity();
        let mut right = self.parameters;
        for (state, input) in states.iter().zip(inputs) {
            let w = self.regressor.at(&input.state);
            let gain = self.pull(&w) * self.lyapunov * (damping * (half * input.weight));
            matrix += gain * w * half;
            right -= gain * (state - input.state);
        }
        let Some(mean) = matrix.lu().solve(&right) else { return };
        for (state, input) in states.iter_mut().zip(inputs) {
            let w = self.regressor.at(&input.state);
            let error = damping * (*state - input.state + half * (w * mean));
            *state += seconds * (self.stability * error + w * mean);
        }
        self.parameters = 2.0 * mean - self.parameters;
    }
}

#[cfg(test)]
mod tests {
    use freeform_riccati::MotionModel;
    use proptest::prelude::*;

    use super::*;
    use crate::solve_lyapunov;

    proptest! {
        /// Over a plant at rest in each step: X stays, so that the error of Xh is driven by the parameters alone.
        #[test]
        fn the_lyapunov_function_never_grows_whatever_the_lines_gains_weights_and_steps(
            lines in prop::collection::vec(prop::array::uniform4(-20.0..20.0_f64), 1..5),
            errors in prop::array::uniform16(-5.0..5.0_f64),
            parameters in prop::array::uniform3(-3.0..3.0_f64),
            weight in 0.0..1.0_f64,
            decay in prop::array::uniform4(0.1..20.0_f64),
            skew in -5.0..5.0_f64,
            step in 1e-3..10.0_f64,
        ) {
            let mut stability = -Matrix4::from_diagonal(&Vector4::from(decay));
            (stability[(0, 1)], stability[(1, 0)]) = (skew, -skew);
            let lyapunov = solve_lyapunov(&stability, &Matrix4::identity()).expect("stable");
            // The parameters of a plant at rest are zero, so that the parameters are their own error.
            let mut law =
                StructuredLaw::new(Regressor::<3>::new(MotionModel::Rigid), stability, lyapunov, parameters.into());
            let inputs: Vec<_> =
                lines.iter().map(|x| PairInput { state: Vector4::from(*x), weight }).collect();
            let mut states: Vec<_> = inputs
                .iter()
                .zip(errors.chunks_exact(4))
                .map(|(input, e)| input.state + Vector4::from_column_slice(e))
                .collect();
            let function = |law: &StructuredLaw<3>, states: &[EstimatorState]| {
                let energy = |(s, i): (&EstimatorState, &PairInput)| (s - i.state).dot(&(lyapunov * (s - i.state)));
                weight * states.iter().zip(&inputs).map(energy).sum::<f64>() + law.parameters().norm_squared()
            };
            for _ in 0..20 {
                let before = function(&law, &states);
                law.step(step, &mut states, &inputs);
                let after = function(&law, &states);
                prop_assert!(after <= before * (1.0 + 1e-8) + 1e-12, "{before} to {after}");
            }
        }
    }
}
