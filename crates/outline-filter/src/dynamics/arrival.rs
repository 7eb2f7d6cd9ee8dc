//! What changes to a hypothesis in a step, a component of its mixture: blended with it at once, as in an interacting multiple model, or after the
//! measurement, as in a generalised pseudo-Bayesian estimator of second order (C.-B. Chang and M. Athans, State estimation for discrete systems with
//! switching parameters, 1978).
use nalgebra::{SMatrix, SVector};

use super::{
    centred::CentredVector,
    hypothesis::{CentredMeasurement, Hypothesis},
};
use crate::vectors::vectorised;

/// Those that have changed to a hypothesis in the last step.
#[derive(Debug, Clone)]
pub(super) struct Arrival<const N: usize> {
    /// Of the hypothesis.
    pub(super) number: usize,
    /// Their share of its probability.
    pub(super) share: f64,
    pub(super) state: Hypothesis<N>,
}

impl<const N: usize> Arrival<N> {
    /// Takes them to be one with those of the hypothesis that have not changed.
    pub(super) fn blend_into(&self, hypothesis: &mut Hypothesis<N>) {
        let Self { share, state, .. } = self;
        hypothesis.blend((&state.mean, &state.covariance), *share);
    }

    /// Corrects them by a measurement, and their share by how well each part explains it. Of those that have not changed the logarithm of the
    /// likelihood and the standardised innovation are given, if there are any; those of both parts are what comes back.
    pub(super) fn update(
        &mut self,
        measurement: &CentredMeasurement,
        (of_others, score_of_others): (f64, Option<CentredVector>),
    ) -> (f64, Option<CentredVector>) {
        let innovation = self.state.update(measurement);
        let own = innovation.map_or(f64::NEG_INFINITY, |innovation| innovation.log_likelihood);
        let score = innovation.map(|innovation| innovation.standardised);
        // Where one part is all, the other may be so much more probable that no number says it.
        if self.share == 1.0 {
            return (own, score);
        }
        let largest = own.max(of_others);
        if self.share == 0.0 || !largest.is_finite() {
            return (of_others, score_of_others);
        }
        let [stayed, came] = [(1.0 - self.share) * (of_others - largest).exp(), self.share * (own - largest).exp()];
        self.share = came / (stayed + came);
        let score = if came > stayed { score } else { score_of_others };
        (largest + (stayed + came).ln(), score)
    }
}

impl<const N: usize> Hypothesis<N> {
    /// Takes a share of it to be in another state of its course.
    pub(super) fn blend(&mut self, (mean, of_covariance): (&SVector<f64, N>, &SMatrix<f64, N, N>), share: f64) {
        let (own, size) = (1.0 - share, self.size());
        let mut apart = [0.0; N];
        for (i, apart) in apart.iter_mut().enumerate().take(size) {
            *apart = mean[i] - self.mean[i];
            self.mean[i] += share * *apart;
        }
        let (covariance, of_covariance) = (&mut self.covariance.data.0, &of_covariance.data.0);
        vectorised(
            #[inline(always)]
            || {
                // Columns are written anew, where nothing else is.
                let columns = covariance.iter_mut().zip(of_covariance).enumerate();
                if size == N {
                    for (j, (entries, of_other)) in columns {
                        let (mut column, by_column) = ([0.0; N], share * apart[j]);
                        for i in 0..N {
                            column[i] = share * of_other[i] + own * (entries[i] + by_column * apart[i]);
                        }
                        *entries = column;
                    }
                    return;
                }
                // What lies beyond the entries in use is none, in all of them.
                let of_used: [f64; N] = std::array::from_fn(|i| if i < size { share } else { 0.0 });
                for (j, (entries, of_other)) in columns.take(size) {
                    let (mut column, by_column) = ([0.0; N], share * apart[j]);
                    for i in 0..N {
                        column[i] = of_used[i] * of_other[i] + own * (entries[i] + by_column * apart[i]);
                    }
                    *entries = column;
                }
            },
        );
    }
}

#[cfg(test)]
mod tests {
    use freeform_riccati::MotionModel;

    use super::*;
    use crate::{
        dynamics::{centred::CentredMatrix, correction::root_of, course::Course},
        tuning::dynamics::LEVELS,
    };

    /// A hypothesis of so large a variance of every entry.
    fn of_variance(variance: f64) -> Hypothesis<9> {
        let course = Course::Accelerating { level: LEVELS[0], rates: true };
        Hypothesis { course, mean: SVector::zeros(), covariance: SMatrix::identity() * variance }
    }

    fn measured_at(deviation: f64) -> CentredMeasurement {
        let k = MotionModel::Rigid.parameter_count();
        let information = CentredMatrix::from_fn(|i, j| f64::from(u8::from(i == j && i < k)));
        let deviation = CentredVector::from_fn(|i, _| if i == 0 { deviation } else { 0.0 });
        CentredMeasurement { root: root_of(&information, k), deviation, noise_inflation: 1.0 }
    }

    /// The likelihood of all by which a hypothesis explains a measurement, the share of those that have come to it, and its variance.
    fn apart(measurement: &CentredMeasurement, share: f64) -> (f64, f64, f64) {
        let (mut stayed, mut arrival) = (of_variance(0.01), Arrival { number: 0, share, state: of_variance(1e6) });
        let innovation = stayed.update(measurement).expect("regular");
        let (logarithm, _) = arrival.update(measurement, (innovation.log_likelihood, None));
        arrival.blend_into(&mut stayed);
        (logarithm, arrival.share, stayed.covariance[(0, 0)])
    }

    #[test]
    fn a_few_that_know_nothing_do_not_make_the_many_explain_what_neither_expects() {
        let measurement = measured_at(20.0);
        let (logarithm, share, _) = apart(&measurement, 1e-4);
        let mut blended = of_variance(0.01);
        let few = of_variance(1e6);
        blended.blend((&few.mean, &few.covariance), 1e-4);
        let of_blended = blended.update(&measurement).expect("regular").log_likelihood;
        // It is explained by the few alone, 1e-4 times over.
        let alone = of_variance(1e6).update(&measurement).expect("regular").log_likelihood;
        assert!((logarithm - alone - 1e-4_f64.ln()).abs() < 1e-6 && share > 0.999_999, "{logarithm} {alone} {share}");
        assert!(of_blended > logarithm + 5.0, "{of_blended} {logarithm}");
    }

    #[test]
    fn where_all_have_come_to_a_hypothesis_or_none_the_other_part_counts_for_nothing() {
        let far = measured_at(2000.0);
        for share in [0.0, 1.0] {
            let (mut stayed, mut arrival) = (of_variance(0.01), Arrival { number: 0, share, state: of_variance(0.01) });
            let improbable = stayed.update(&far).expect("regular").log_likelihood;
            let likely = (0.0, None);
            let (logarithm, _) = if share == 1.0 {
                arrival.update(&far, likely)
            } else {
                arrival.update(&measured_at(0.0), (improbable, None))
            };
            assert!((logarithm - improbable).abs() < 1e-9 && arrival.share == share, "{share}: {logarithm}");
            arrival.blend_into(&mut stayed);
            assert!(stayed.mean.iter().chain(&stayed.covariance).all(|number| number.is_finite()));
        }
    }

    #[test]
    fn what_the_many_explain_is_theirs_and_no_less_known_for_the_few() {
        let (_, share, variance) = apart(&measured_at(0.5), 1e-4);
        assert!(share < 1e-9 && (variance - 0.01 / 1.01).abs() < 1e-6, "{share} {variance}");
    }
}
