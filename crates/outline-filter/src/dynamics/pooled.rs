//! What leaves its course, all hypotheses taken together.
use freeform_riccati::MotionModel;
use nalgebra::{SMatrix, SVector};

use super::{
    accelerations::Accelerations, hypothesis::Hypothesis, interacting::MOST, transitions::leaving, usual_step::Units,
};
use crate::{tuning::dynamics as tuning, vectors::vectorised};

/// Mean and covariance of all hypotheses together, as one course or another has its state.
pub(super) struct Pooled<const N: usize> {
    pub(super) mean: SVector<f64, N>,
    pub(super) covariance: SMatrix<f64, N, N>,
    /// Share of those that know nothing of the accelerations.
    without: f64,
}

impl<const N: usize> Pooled<N> {
    /// As the state of what has changed to a hypothesis. Of what its course has alone nothing is known, whatever it has been: a motion that has ended has
    /// left there what no longer holds.
    pub(super) fn as_state_of(
        &self,
        hypothesis: &Hypothesis<N>,
        model: MotionModel,
        units: Units<'_>,
    ) -> Hypothesis<N> {
        let (course, shared) = (hypothesis.course, hypothesis.shared());
        let mean = SVector::from_fn(|i, _| if i < shared { self.mean[i] } else { 0.0 });
        let covariance = SMatrix::from_fn(|i, j| if i < shared && j < shared { self.covariance[(i, j)] } else { 0.0 });
        let mut state = Hypothesis { course, mean, covariance };
        self.add_unknown_to(&mut state, model, units, 1.0);
        state
    }

    /// Takes next to nothing to be known, in a share of a hypothesis, of what its course has alone, and of accelerations by those that have none.
    pub(super) fn add_unknown_to(
        &self,
        hypothesis: &mut Hypothesis<N>,
        model: MotionModel,
        units: Units<'_>,
        share: f64,
    ) {
        if hypothesis.course.has_more_than_motion() {
            let unknown = if hypothesis.shared() < hypothesis.size() { 1.0 } else { self.without };
            hypothesis.add_unknown(model, (units.pose_variance, units.usual), share * unknown);
        }
    }

    /// With accelerations of all parameters.
    pub(super) fn of(hypotheses: &[Hypothesis<N>], weights: &[f64], model: MotionModel) -> Self {
        let empty = Self { mean: SVector::zeros(), covariance: SMatrix::zeros(), without: 0.0 };
        empty.with_columns(0, (hypotheses, weights), model, Accelerations::All)
    }

    /// With accelerations beside what the turn makes of them; pose and motion are those with all.
    pub(super) fn of_generator(&self, hypotheses: &[Hypothesis<N>], weights: &[f64], model: MotionModel) -> Self {
        let first = 2 * (N / 3);
        let mut pooled = Self { mean: self.mean, covariance: self.covariance, without: 0.0 };
        pooled.mean.as_mut_slice()[first..].fill(0.0);
        pooled.covariance.data.0[first..].fill([0.0; N]);
        let mut pooled = pooled.with_columns(first, (hypotheses, weights), model, Accelerations::OfGenerator);
        let (before, from) = pooled.covariance.data.0.split_at_mut(first);
        for (j, column) in before.iter_mut().enumerate() {
            column[first..].iter_mut().zip(from.iter()).for_each(|(entry, of)| *entry = of[j]);
        }
        pooled
    }

    /// Adds the entries of the mean and the columns of the covariance from one on, which are none yet.
    fn with_columns(
        self,
        first: usize,
        (hypotheses, weights): (&[Hypothesis<N>], &[f64]),
        model: MotionModel,
        accelerations: Accelerations,
    ) -> Self {
        let (k, mut pooled) = (N / 3, self);
        let sources = counting(hypotheses, weights);
        let mut means = [SVector::zeros(); MOST];
        for ((source, share), mean) in sources.clone().zip(&mut means) {
            *mean = accelerations.mean_of(source, model);
            (first..N).for_each(|i| pooled.mean[i] += mean[i] * share);
        }
        for ((source, share), mean) in sources.zip(&means) {
            let apart = mean - pooled.mean;
            let known = if accelerations.are_part_of(source.course) { 3 * k } else { 2 * k };
            let (covariance, of_source) = (&mut pooled.covariance.data.0[first..], &source.covariance.data.0[first..]);
            vectorised(
                #[inline(always)]
                || {
                    let apart: [f64; N] = apart.into();
                    let of_known: [f64; N] = std::array::from_fn(|i| if i < known { share } else { 0.0 });
                    for (j, (entries, own)) in (first..N).zip(covariance.iter_mut().zip(of_source)) {
                        let (mut column, by_column) = ([0.0; N], share * apart[j]);
                        if j < known {
                            for i in 0..N {
                                column[i] = entries[i] + of_known[i] * own[i] + by_column * apart[i];
                            }
                        } else {
                            for i in 0..N {
                                column[i] = entries[i] + by_column * apart[i];
                            }
                        }
                        *entries = column;
                    }
                },
            );
            pooled.without += if known < 3 * k { share } else { 0.0 };
        }
        pooled
    }

    /// With the accelerations of the velocity of the centroid alone; pose and motion are those with all.
    pub(super) fn of_velocity(&self, hypotheses: &[Hypothesis<N>], weights: &[f64], model: MotionModel) -> Self {
        let k = N / 3;
        let mut pooled = Self { mean: self.mean, covariance: self.covariance, without: 0.0 };
        for i in 2 * k..3 * k {
            pooled.mean[i] = 0.0;
            pooled.covariance.row_mut(i).fill(0.0);
            pooled.covariance.column_mut(i).fill(0.0);
        }
        let (accelerations, sources) = (Accelerations::OfVelocity, counting(hypotheses, weights));
        for (source, share) in sources.clone() {
            let mean = accelerations.mean_of(source, model);
            (3 * k - 2..3 * k).for_each(|i| pooled.mean[i] += mean[i] * share);
        }
        let used = |i: usize| i < 2 * k || i >= 3 * k - 2;
        for (source, share) in sources {
            let apart = accelerations.mean_of(source, model) - pooled.mean;
            let is_known = accelerations.are_part_of(source.course);
            for j in 3 * k - 2..3 * k {
                let by_column = share * apart[j];
                for i in (0..N).filter(|i| used(*i)) {
                    let own = if is_known { share * source.covariance[(i, j)] } else { 0.0 };
                    pooled.covariance[(i, j)] += own + by_column * apart[i];
                }
            }
            pooled.without += if is_known { 0.0 } else { share };
        }
        for j in 3 * k - 2..3 * k {
            (0..3 * k - 2).for_each(|i| pooled.covariance[(j, i)] = pooled.covariance[(i, j)]);
        }
        pooled
    }
}

/// The hypotheses, each with the probability that the motion was of this course and has left it for a certain other.
pub(super) fn changing<'a, const N: usize>(
    hypotheses: &'a [Hypothesis<N>],
    weights: &'a [f64],
) -> impl Iterator<Item = (&'a Hypothesis<N>, f64)> + Clone {
    hypotheses.iter().zip(weights).map(|(hypothesis, weight)| (hypothesis, weight * leaving(hypothesis.course)))
}

/// Those of them that count, with their shares of all that change.
fn counting<'a, const N: usize>(
    hypotheses: &'a [Hypothesis<N>],
    weights: &'a [f64],
) -> impl Iterator<Item = (&'a Hypothesis<N>, f64)> + Clone {
    let all: f64 = changing(hypotheses, weights).map(|(_, weight)| weight).sum();
    let sources = move || changing(hypotheses, weights).filter(move |(_, weight)| *weight > tuning::LEAST_SHARE * all);
    let sum: f64 = sources().map(|(_, weight)| weight).sum();
    sources().map(move |(source, weight)| (source, weight / sum))
}
