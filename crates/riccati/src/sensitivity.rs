use nalgebra::Matrix3;

use crate::{exponential::exponential, motion_model::MotionModel};

/// Norm up to which the series below is summed; larger motions are halved first.
const SERIES_NORM: f64 = 0.25;
/// Terms of the series, enough for full precision at twice that norm (a commutator at most doubles it).
const SERIES_TERMS: u32 = 16;
/// Size of a term, beside the sum, from which on those that follow, each less than half of the one before, are far below its rounding.
const LEFT_OUT: f64 = 1e-19;

/// Derivative of a flow in the direction of another generator:
/// `d/d eps expm((A + eps E) t) = V expm(A t)`, `V = integral over s from 0 to t of expm(A s) E expm(-A s)`.
///
/// V is t times a mean of E along the flow, itself a 3x3 generator, so it can be lifted: the derivative of the transported
/// coefficients is `L(V) T_n a` with [`Lift`](crate::Lift) and [`Transport`](crate::Transport).
#[must_use]
pub fn flow_sensitivity(generator: &Matrix3<f64>, direction: &Matrix3<f64>, seconds: f64) -> Matrix3<f64> {
    let norm = (generator * seconds).norm();
    if !norm.is_finite() {
        return Matrix3::repeat(f64::NAN);
    }
    let halvings = (norm / SERIES_NORM).log2().ceil().max(0.0) as i32;
    let step = seconds * 0.5_f64.powi(halvings);
    // V = sum over k of t^(k + 1) / (k + 1)! times the k-fold commutator of A with E.
    let mut term = direction * step;
    let mut sum = term;
    for k in 2..=SERIES_TERMS {
        term = (generator * term - term * generator) * (step / f64::from(k));
        sum += term;
        if term.amax() < LEFT_OUT * sum.amax() {
            break;
        }
    }
    // V(2 t) = V(t) + expm(A t) V(t) expm(-A t).
    for doubling in 0..halvings {
        let time = step * 2.0_f64.powi(doubling);
        sum += exponential(&(generator * time)) * sum * exponential(&(generator * -time));
    }
    sum
}

impl MotionModel {
    /// [`flow_sensitivity`] for every parameter: entry j has `d flow / d theta_j = V_j flow`. Entries beyond the number of
    /// parameters are zero.
    ///
    /// # Panics
    /// If `parameters` does not have `parameter_count` entries.
    #[must_use]
    pub fn flow_sensitivities(self, parameters: &[f64], seconds: f64) -> [Matrix3<f64>; Self::MAX_PARAMETERS] {
        let generator = self.generator(parameters);
        let mut sensitivities = [Matrix3::zeros(); Self::MAX_PARAMETERS];
        for (v, e) in sensitivities.iter_mut().zip(self.basis()) {
            *v = flow_sensitivity(&generator, e, seconds);
        }
        sensitivities
    }
}
