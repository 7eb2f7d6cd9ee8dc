use nalgebra::{Const, DimMin, SMatrix, SVector, Vector4};

use super::{origin_shift::OriginShift, regressor::Regressor};

/// Rate of the filters that stand in for differentiation, per second.
const FILTER_RATE: f64 = 4.0;
/// Rate at which old data is forgotten, per second: slow, so that constant motion is averaged over many seconds.
const FORGETTING_RATE: f64 = 0.05;

/// Filtered least squares: with every signal passed through `1 / (s + lambda)`, `X' = W theta` becomes
/// `X - lambda X_f - X(0) e^(-lambda t) = W_f theta`, which is linear in theta and free of derivatives.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LeastSquaresLaw<const N: usize> {
    regressor: Regressor<N>,
    information: SMatrix<f64, N, N>,
    projection: SVector<f64, N>,
    initial: SVector<f64, N>,
}

/// The filters over one line pair.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FilteredPair<const N: usize> {
    state: Vector4<f64>,
    regressor: SMatrix<f64, 4, N>,
    /// `X(0) e^(-lambda t)`, what the filter still remembers of its start.
    transient: Vector4<f64>,
}

impl<const N: usize> FilteredPair<N> {
    pub(crate) fn starting_at(state: &Vector4<f64>) -> Self {
        Self { state: Vector4::zeros(), regressor: SMatrix::zeros(), transient: *state }
    }

    /// How far the regression is off at X with these parameters.
    pub(crate) fn error(&self, x: &Vector4<f64>, parameters: &SVector<f64, N>) -> Vector4<f64> {
        self.regressor * parameters - (x - FILTER_RATE * self.state - self.transient)
    }

    /// Goes on in other coordinates; `old_from_new` takes the parameters back.
    ///
    /// A constant that is added to X is part of what the filter remembers of its start, as if it had been there all along.
    pub(crate) fn shift_origin(&mut self, shift: &OriginShift, old_from_new: &SMatrix<f64, N, N>) {
        self.state = shift.of_rates() * self.state;
        self.transient = shift.state(&self.transient);
        self.regressor = shift.of_rates() * self.regressor * old_from_new;
    }

    #[cfg(feature = "serde")]
    pub(crate) fn numbers_mut(&mut self) -> impl Iterator<Item = &mut f64> {
        self.state.iter_mut().chain(self.regressor.iter_mut()).chain(self.transient.iter_mut())
    }

    /// Passes constant signals through the filters for `seconds`.
    pub(crate) fn advance(&mut self, seconds: f64, state: &Vector4<f64>, regressor: &SMatrix<f64, 4, N>) {
        let decay = (-FILTER_RATE * seconds).exp();
        let gain = (1.0 - decay) / FILTER_RATE;
        self.state = decay * self.state + gain * state;
        self.regressor = decay * self.regressor + gain * regressor;
        self.transient *= decay;
    }
}

impl<const N: usize> LeastSquaresLaw<N> {
    pub(crate) fn new(regressor: Regressor<N>, initial: SVector<f64, N>) -> Self {
        // A weak prior keeps the first estimates finite; a fraction of a second of data outweighs it.
        let prior = 1e-6;
        Self { regressor, information: SMatrix::identity() * prior, projection: initial * prior, initial }
    }

    /// One that nothing is known of beforehand: without an estimate until all parameters have been excited.
    pub(crate) fn without_prior(regressor: Regressor<N>, initial: SVector<f64, N>) -> Self {
        Self { regressor, information: SMatrix::zeros(), projection: SVector::zeros(), initial }
    }

    pub(crate) fn regressor(&self) -> &Regressor<N> {
        &self.regressor
    }

    /// Goes on in other coordinates; `old_from_new` takes the parameters back. The filters move by themselves.
    pub(crate) fn shift_origin(&mut self, shift: &OriginShift, old_from_new: &SMatrix<f64, N, N>) {
        self.information = old_from_new.tr_mul(&self.information) * old_from_new;
        self.projection = old_from_new.tr_mul(&self.projection);
        self.initial = shift.of_parameters(self.regressor.model()) * self.initial;
    }

    #[cfg(feature = "serde")]
    pub(crate) fn numbers_mut(&mut self) -> impl Iterator<Item = &mut f64> {
        self.information.iter_mut().chain(self.projection.iter_mut()).chain(self.initial.iter_mut())
    }

    /// Forgets old data for `seconds`.
    pub(crate) fn forget(&mut self, seconds: f64) {
        let keep = (-FORGETTING_RATE * seconds).exp();
        self.information *= keep;
        self.projection *= keep;
    }

    /// Takes in what the filters of one pair say at a frame where its state is X, with noise of relative variance
    /// `1 / weight`.
    pub(crate) fn take(&mut self, seconds: f64, filtered: &FilteredPair<N>, x: &Vector4<f64>, weight: f64) {
        let right = x - FILTER_RATE * filtered.state - filtered.transient;
        let precision = noise_precision(x) * (weight * seconds);
        self.information += precision * filtered.regressor.tr_mul(&filtered.regressor);
        self.projection += precision * filtered.regressor.tr_mul(&right);
    }

    /// How evenly all parameters are excited: the determinant of the information over that of a multiple of the identity with its trace,
    /// from 0 to 1.
    pub(crate) fn excitation(&self) -> f64
    where
        Const<N>: DimMin<Const<N>, Output = Const<N>>,
    {
        let mean = self.information.trace() / N as f64;
        if mean > 0.0 { (self.information / mean).determinant().clamp(0.0, 1.0) } else { 0.0 }
    }

    pub(crate) fn parameters(&self) -> SVector<f64, N> {
        self.solution().unwrap_or(self.initial)
    }

    /// The solution of the normal equations; `None` where they have none.
    pub(crate) fn solution(&self) -> Option<SVector<f64, N>> {
        self.information.cholesky().map(|factor| factor.solve(&self.projection))
    }
}

/// Inverse of the relative variance of the noise on each entry of X: noise is the same for all orientations in the rotation chart w, and
/// `l = j (1 + w) / (1 - w)` magnifies it by `|1 + |l|^2 + ...|`, that is by `|l + j|^2 / 2` where the line swings out.
fn noise_precision(x: &Vector4<f64>) -> f64 {
    let magnification = 0.5 * (x[0] * x[0] + (x[1].abs() + 1.0).powi(2));
    1.0 / (magnification * magnification)
}
