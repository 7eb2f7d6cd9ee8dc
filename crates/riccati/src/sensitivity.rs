use nalgebra::{Complex, Matrix3};

use crate::{
    exponential::{exponential, exponential_quotient, second_exponential_quotient},
    motion_model::MotionModel,
};

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

/// [`flow_sensitivity`] of an affine motion, for directions that are such motions too: the same sums without what the last rows have no part
/// in.
fn affine_sensitivity(generator: &Matrix3<f64>, direction: &Matrix3<f64>, seconds: f64) -> Matrix3<f64> {
    let norm = (generator * seconds).norm();
    if norm.is_nan() || norm > SERIES_NORM {
        return flow_sensitivity(generator, direction, seconds);
    }
    let rows = |m: &Matrix3<f64>| [[m.m11, m.m12, m.m13], [m.m21, m.m22, m.m23]];
    let product =
        |a: &[[f64; 3]; 2], b: &[[f64; 3]; 2]| a.map(|[x, y, _]| [0, 1, 2].map(|j| x * b[0][j] + y * b[1][j]));
    let largest = |m: &[[f64; 3]; 2]| m.iter().flatten().fold(0.0, |largest: f64, entry| largest.max(entry.abs()));
    let generator = rows(generator);
    let mut term = rows(&(direction * seconds));
    let mut sum = term;
    for k in 2..=SERIES_TERMS {
        let (left, right, factor) = (product(&generator, &term), product(&term, &generator), seconds / f64::from(k));
        for i in 0..2 {
            for j in 0..3 {
                term[i][j] = (left[i][j] - right[i][j]) * factor;
                sum[i][j] += term[i][j];
            }
        }
        if largest(&term) < LEFT_OUT * largest(&sum) {
            break;
        }
    }
    let [[m11, m12, m13], [m21, m22, m23]] = sum;
    Matrix3::new(m11, m12, m13, m21, m22, m23, 0.0, 0.0, 0.0)
}

/// [`flow_sensitivity`] of a similarity motion, for directions that are such motions too, in closed form.
///
/// With `q = x + j y` such a motion is `q' = a q + b`, and its flow takes the generator `(e, f)` along to `(e, exp(a s) f - e b phi(s))`, where
/// `phi(s) = (exp(a s) - 1) / a`. V is the integral of that over s.
fn similarity_sensitivity(generator: &Matrix3<f64>, seconds: f64) -> impl Fn(&Matrix3<f64>) -> Matrix3<f64> {
    let parts = |m: &Matrix3<f64>| (Complex::new(m.m11, m.m21), Complex::new(m.m13, m.m23));
    let (a, b) = parts(generator);
    let z = a * seconds;
    let by_shift = exponential_quotient(z) * seconds;
    let by_linear = b * second_exponential_quotient(z) * (seconds * seconds);
    move |direction| {
        let (e, f) = parts(direction);
        let (linear, shift) = (e * seconds, f * by_shift - e * by_linear);
        Matrix3::new(linear.re, -linear.im, shift.re, linear.im, linear.re, shift.im, 0.0, 0.0, 0.0)
    }
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
        if self <= Self::Similarity {
            let of_similarity = similarity_sensitivity(&generator, seconds);
            for (v, e) in sensitivities.iter_mut().zip(self.basis()) {
                *v = of_similarity(e);
            }
            return sensitivities;
        }
        let of_one = if self == Self::Affine { affine_sensitivity } else { flow_sensitivity };
        for (v, e) in sensitivities.iter_mut().zip(self.basis()) {
            *v = of_one(&generator, e, seconds);
        }
        sensitivities
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sensitivities_of_similarities_in_closed_form_are_those_of_the_series() {
        let motions = [[0.2, -1.3, 0.4, -0.7], [0.0, 0.0, 3.0, 4.0], [-0.5, 4.0, 1.0, 2.0], [1e-9, 1e-7, 1.0, -1.0]];
        for (model, skipped) in [(MotionModel::Rigid, 1), (MotionModel::Similarity, 0)] {
            for (motion, seconds) in motions.iter().zip([0.03, 1.0, 2.5, 0.4]) {
                let parameters = &motion[skipped..];
                let found = model.flow_sensitivities(parameters, seconds);
                let generator = model.generator(parameters);
                for (v, e) in found.iter().zip(model.basis()) {
                    let expected = flow_sensitivity(&generator, e, seconds);
                    assert!(
                        (v - expected).amax() < 1e-12 * (1.0 + expected.amax()),
                        "{model} {seconds}: {v} {expected}"
                    );
                }
            }
        }
    }

    #[test]
    fn sensitivities_of_affine_motions_are_those_of_whole_matrices() {
        let motion = [0.2, -1.3, 0.9, -0.4, 0.7, -0.5];
        let model = MotionModel::Affine;
        let generator = model.generator(&motion);
        // The longest is beyond the norm that the series is taken for.
        for seconds in [1e-6, 0.03, 0.1, 2.0] {
            for (v, e) in model.flow_sensitivities(&motion, seconds).iter().zip(model.basis()) {
                assert_eq!(*v, flow_sensitivity(&generator, e, seconds), "{seconds}");
            }
        }
    }
}
