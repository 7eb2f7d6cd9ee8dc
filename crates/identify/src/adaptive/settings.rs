use freeform_riccati::{MAX_PARAMETERS, MotionModel};
use nalgebra::{DMatrix, Matrix4, Vector4};

/// How the parameters are adapted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum AdaptiveLaw {
    /// Equation 21 as printed: all entries of A, B and C, 36 numbers, of which the motion is read off. One line pair excites
    /// some of them so little that they take many minutes, of exact lines; it is here for comparison. At most affine motion.
    Printed,
    /// Equation 21 with the structure that equations 14 to 17 give A, B and C: only the motion parameters are adapted,
    /// `theta' = -W' P e`.
    Structured,
    /// Least squares on the filtered regression `X' = W theta` with exponential forgetting: settles in a fraction of a
    /// second (Slotine, Li, Applied Nonlinear Control, 1991, section 8.7).
    FilteredLeastSquares,
    /// Dynamic regressor extension and mixing on the same regression: a law for each parameter by itself, whose error never grows of
    /// exact lines (Aranovskiy, Bobtsov, Ortega, Pyrkin, Performance enhancement of parameter estimators via dynamic regressor
    /// extension and mixing, 2017).
    RegressorMixing,
}

/// Which conjugate pairs drive the identification.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum PairChoice {
    /// The pair with the best signal against its noise, judged from all frames so far.
    Best,
    /// One given pair, counted from 0 in the order of the first frame.
    Given(usize),
    /// All pairs, each weighted by its noise relative to that of the best.
    All,
}

/// What an adaptive law is doing, for those who study it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdaptiveDiagnostics {
    /// Norm of the error e = Xh - X of the estimator over all pairs in use, weighted as they are; of the laws on the filtered regression, of
    /// the error of that.
    pub error: f64,
    /// `sum e' P e`: the part of the Lyapunov function `sum e' P e + |theta - theta_true|^2` that is known without the truth.
    pub energy: f64,
    /// Mean of `sum W' W` over the last four seconds, forgotten exponentially, row by row; zero beyond the parameters of the model.
    pub(crate) regressor_square: [[f64; MAX_PARAMETERS]; MAX_PARAMETERS],
    pub(crate) parameters: usize,
}

impl AdaptiveDiagnostics {
    /// Smallest eigenvalue of the mean of `sum W' W` over the last four seconds, forgotten exponentially: how much the parameters that are
    /// excited least are excited. 0 where something is not excited at all.
    #[must_use]
    pub fn excitation(&self) -> f64 {
        let n = self.parameters;
        let square = DMatrix::from_fn(n, n, |i, j| self.regressor_square[i][j]);
        square.symmetric_eigenvalues().iter().copied().fold(f64::INFINITY, f64::min).max(0.0)
    }
}

/// Settings of an [`AdaptiveIdentifier`](crate::AdaptiveIdentifier).
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AdaptiveSettings {
    /// Motion model; the printed law is for rigid, similarity and affine motion.
    pub model: MotionModel,
    /// How the parameters are adapted.
    pub law: AdaptiveLaw,
    /// Which pairs are used.
    pub pairs: PairChoice,
    /// The stability matrix Am, per second. All its eigenvalues must have negative real parts.
    pub stability: Matrix4<f64>,
    /// The symmetric positive-definite matrix Q of the Lyapunov equation `Am' P + P Am = -Q`.
    pub definite: Matrix4<f64>,
    /// Parameters to start from, in the order of the model; empty for all zero.
    pub initial_values: Vec<f64>,
}

impl Default for AdaptiveSettings {
    /// Rigid motion by the structured law over all pairs, from zero, with the paper's Am and Q.
    fn default() -> Self {
        Self {
            model: MotionModel::Rigid,
            law: AdaptiveLaw::Structured,
            pairs: PairChoice::All,
            stability: Matrix4::from_diagonal(&Vector4::new(-0.5, -0.5, -1.0, -1.0)),
            definite: Matrix4::from_diagonal(&Vector4::new(0.5, 1.0, 2.0, 3.0)),
            initial_values: Vec::new(),
        }
    }
}
