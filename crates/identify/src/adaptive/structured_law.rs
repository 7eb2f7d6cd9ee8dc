use nalgebra::{Const, DimMin, Matrix4, SMatrix, SVector, Vector4};

use super::regressor::Regressor;

/// The estimator (21) with the structure of its matrices known: over each line pair `Xh' = Am (Xh - X) + W(X) theta`, and
/// over all of them together `theta' = -sum W' P (Xh - X)`.
///
/// Steps are taken by the implicit midpoint rule, which keeps the Lyapunov function `sum e' P e + |theta error|^2` from
/// growing whatever the step, so that a line that swings far out cannot make the law unstable.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct StructuredLaw<const N: usize> {
    regressor: Regressor<N>,
    stability: Matrix4<f64>,
    lyapunov: Matrix4<f64>,
    parameters: SVector<f64, N>,
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
        Self { regressor, stability, lyapunov, parameters }
    }

    pub(crate) fn parameters(&self) -> &SVector<f64, N> {
        &self.parameters
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
            let gain = w.transpose() * self.lyapunov * (damping * (half * input.weight));
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
