//! Mixing: every hypothesis may have been one of the others a step ago.
use freeform_riccati::MotionModel;
use nalgebra::{SMatrix, SVector};

use super::{
    centred::{CentredVector, parts},
    hypothesis::{Course, Hypothesis},
};
use crate::tuning::dynamics as tuning;

/// Mean and covariance of all hypotheses together, as one course or another has its state.
struct Pooled<const N: usize> {
    mean: SVector<f64, N>,
    covariance: SMatrix<f64, N, N>,
    /// Share of those that know nothing of the accelerations.
    without: f64,
}

/// Takes every hypothesis to have been one of the others a step ago by chance; the probabilities sum up to one.
///
/// The change has the same probability between any two, so that every mixture has two parts: the hypothesis itself, and all together.
pub(super) fn mix<const N: usize>(
    hypotheses: &mut [Hypothesis<N>],
    weights: &mut [f64],
    model: MotionModel,
    (pose_variance, seconds): (&CentredVector, f64),
) {
    let (count, k) = (hypotheses.len(), N / 3);
    if count < 2 {
        return;
    }
    let stays = 1.0 - tuning::TRANSITION * (count - 1) as f64;
    let pooled = [Accelerations::All, Accelerations::OfVelocity]
        .map(|accelerations| Pooled::of(hypotheses, weights, accelerations, model));
    let all: f64 = weights.iter().sum();
    for (hypothesis, weight) in hypotheses.iter_mut().zip(weights) {
        let of_all = match Accelerations::of(hypothesis.course) {
            Accelerations::OfVelocity => &pooled[1],
            Accelerations::All | Accelerations::None => &pooled[0],
        };
        let total = tuning::TRANSITION * all + (stays - tuning::TRANSITION) * *weight;
        let [changed, own] = [tuning::TRANSITION * all / total, (stays - tuning::TRANSITION) * *weight / total];
        let n = hypothesis.size();
        // What a course has alone is as it was, or nothing is known of it.
        let shared = if hypothesis.course == Course::ConstantVelocity { 2 * k } else { n };
        let mut apart = [0.0; N];
        for (i, apart) in apart.iter_mut().enumerate().take(shared) {
            *apart = of_all.mean[i] - hypothesis.mean[i];
            hypothesis.mean[i] += changed * *apart;
        }
        for j in 0..n {
            for i in 0..n {
                let entry = &mut hypothesis.covariance[(i, j)];
                let of_all = if i < shared && j < shared { of_all.covariance[(i, j)] } else { 0.0 };
                *entry = changed * of_all + own * (*entry + changed * apart[i] * apart[j]);
            }
        }
        let unknown = if shared < n { 1.0 } else { of_all.without };
        if n > 2 * k {
            hypothesis.add_unknown(model, (pose_variance, seconds), changed * unknown);
        }
        *weight = total;
    }
}

impl<const N: usize> Pooled<N> {
    fn of(hypotheses: &[Hypothesis<N>], weights: &[f64], accelerations: Accelerations, model: MotionModel) -> Self {
        let k = N / 3;
        let all: f64 = weights.iter().sum();
        let mut pooled = Self { mean: SVector::zeros(), covariance: SMatrix::zeros(), without: 0.0 };
        let sources = || hypotheses.iter().zip(weights).filter(|(_, weight)| **weight > tuning::LEAST_SHARE * all);
        let sum: f64 = sources().map(|(_, weight)| weight).sum();
        for (source, weight) in sources() {
            pooled.mean += accelerations.mean_of(source, model) * (weight / sum);
        }
        for (source, weight) in sources() {
            let share = weight / sum;
            let apart = accelerations.mean_of(source, model) - pooled.mean;
            let known = if accelerations.are_part_of(source.course) { 3 * k } else { 2 * k };
            for j in 0..3 * k {
                for i in 0..3 * k {
                    let own = if i < known && j < known { source.covariance[(i, j)] } else { 0.0 };
                    pooled.covariance[(i, j)] += share * (own + apart[i] * apart[j]);
                }
            }
            pooled.without += if known < 3 * k { share } else { 0.0 };
        }
        if accelerations == Accelerations::OfVelocity {
            for i in 2 * k..3 * k - 2 {
                pooled.mean[i] = 0.0;
                pooled.covariance.row_mut(i).fill(0.0);
                pooled.covariance.column_mut(i).fill(0.0);
            }
        }
        pooled
    }
}

/// The accelerations that a course has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Accelerations {
    None,
    /// Of the velocity of the middle alone.
    OfVelocity,
    All,
}

impl Accelerations {
    fn of(course: Course) -> Self {
        match course {
            Course::Accelerating { rates: true, .. } => Self::All,
            Course::Accelerating { rates: false, .. } => Self::OfVelocity,
            Course::ConstantGenerator | Course::Shaken { .. } | Course::ConstantVelocity => Self::None,
        }
    }

    /// Whether a course has them all.
    fn are_part_of(self, course: Course) -> bool {
        let had = Self::of(course);
        had != Self::None && (had == Self::All || self != Self::All)
    }

    /// The state of a hypothesis with these accelerations: those that it does not have follow from its motion.
    fn mean_of<const N: usize>(self, source: &Hypothesis<N>, model: MotionModel) -> SVector<f64, N> {
        if self.are_part_of(source.course) {
            return source.mean;
        }
        let k = N / 3;
        let mut mean = source.mean;
        match source.course {
            // Along an arc the velocity of the middle turns all the time.
            Course::ConstantGenerator | Course::Shaken { .. } => {
                let (a, v) = parts(&model.generator(&source.mean.as_slice()[k..2 * k]));
                mean.fixed_rows_mut::<2>(3 * k - 2).copy_from(&(a * v));
            }
            Course::ConstantVelocity => {
                let turning = source.mean.fixed_rows::<2>(3 * k - 2).into_owned();
                mean.fixed_rows_mut::<2>(3 * k - 2).copy_from(&(source.rates(model) * turning));
            }
            Course::Accelerating { .. } => {}
        }
        mean
    }
}
