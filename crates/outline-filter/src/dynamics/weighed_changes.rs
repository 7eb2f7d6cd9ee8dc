//! Rates of change weighed against none.
use std::ops::Range;

use nalgebra::{Cholesky, Const};

use super::centred::{CentredMatrix, CentredVector, LARGEST};
use crate::tuning::steady_change as tuning;

/// What the velocity of the centroid does if nothing changes at a steady rate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum CentroidVelocity {
    /// It turns with the object.
    Turns,
    Stays,
    /// It changes, at random or as a point aside runs straight.
    Changes,
}

/// What frames say of rates of change, in their units.
pub(super) struct Changes {
    pub(super) information: CentredMatrix,
    pub(super) score: CentredVector,
}

/// Rates of change weighed against none: the probability that they matter, and the moments of those that the rates have alone and of the others.
pub(super) struct Weighed {
    pub(super) probability: f64,
    pub(super) of_rates: Moments,
    pub(super) others: Moments,
}

/// Second moments of rates of change, each times its probability: of what is found, and of what may be there beside that.
pub(super) struct Moments {
    pub(super) apart: CentredMatrix,
    pub(super) beside: CentredMatrix,
}

impl Moments {
    fn none() -> Self {
        Self { apart: CentredMatrix::zeros(), beside: CentredMatrix::zeros() }
    }

    fn divided(self, by: f64) -> Self {
        Self { apart: self.apart / by, beside: self.beside / by }
    }
}

/// Rates of change of some sizes beforehand, in their units.
pub(super) struct OfSizes {
    /// Logarithm of their Bayes factor against none.
    pub(super) logarithm: f64,
    found: CentredVector,
    /// Inverse of the share of their variance that is left.
    factor: Cholesky<f64, Const<LARGEST>>,
}

/// A size of some parameters, none of the others.
pub(super) fn sized(members: &Range<usize>, size: f64) -> CentredVector {
    CentredVector::from_fn(|i, _| if members.contains(&i) { size } else { 0.0 })
}

impl Changes {
    /// Changes of sizes beforehand, as deviations.
    pub(super) fn of_sizes(&self, sizes: &CentredVector) -> Option<OfSizes> {
        let of_prior =
            CentredMatrix::from_fn(|i, j| f64::from(u8::from(i == j)) + sizes[i] * self.information[(i, j)] * sizes[j]);
        let factor = of_prior.cholesky()?;
        let score = self.score.component_mul(sizes);
        let found = factor.solve(&score);
        let logarithm = 0.5 * (score.dot(&found) - factor.ln_determinant());
        Some(OfSizes { logarithm, found: found.component_mul(sizes), factor })
    }

    /// Weighs changes of k parameters beside what the velocity does otherwise, with a logarithm `against` those of the velocity; those of the rates alone
    /// by what is said of them.
    pub(super) fn weighed(
        &self,
        k: usize,
        (velocity, against): (CentroidVelocity, f64),
        of_rates: &Self,
    ) -> Option<Weighed> {
        let (mut by_rates, mut others) = (Moments::none(), Moments::none());
        // The rates, the velocity, or all together.
        let together = [0..k - 2, k - 2..k, 0..k];
        let some = if velocity == CentroidVelocity::Changes { &together[..1] } else { &together[..] };
        let each = tuning::PRIOR / (some.len() * tuning::SIZES.len()) as f64;
        let (mut all, mut probability) = (1.0 - tuning::PRIOR, 0.0);
        for members in some {
            let is_of_rates = members.end < k;
            let (changes, against) = if is_of_rates { (of_rates, 0.0) } else { (self, against) };
            let moments = if is_of_rates { &mut by_rates } else { &mut others };
            for size in tuning::SIZES {
                let sizes = sized(members, size);
                let OfSizes { logarithm, found, factor } = changes.of_sizes(&sizes)?;
                let left = factor.inverse();
                let weight = each * (logarithm + against).min(tuning::LARGEST_LOGARITHM).exp();
                all += weight;
                // Of a size that frames do not tell from none, a change is no other motion.
                probability += weight * members.clone().map(|i| 1.0 - left[(i, i)]).fold(0.0, f64::max);
                moments.apart += found * found.transpose() * weight;
                moments.beside += left.component_mul(&(sizes * sizes.transpose())) * weight;
            }
        }
        let [of_rates, others] = [by_rates, others].map(|moments| moments.divided(all));
        Some(Weighed { probability: probability / all, of_rates, others })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Changes of three parameters that are each found with a deviation of 0.5, the first one so many deviations from none.
    fn found_at(deviations: f64) -> Weighed {
        let information = CentredMatrix::from_diagonal(&CentredVector::from_fn(|i, _| if i < 3 { 4.0 } else { 1.0 }));
        let score = CentredVector::from_fn(|i, _| if i == 0 { 2.0 * deviations } else { 0.0 });
        let changes = Changes { information, score };
        changes.weighed(3, (CentroidVelocity::Stays, 0.0), &changes).expect("regular")
    }

    #[test]
    fn a_change_that_is_not_found_is_less_probable_than_before_and_one_of_six_deviations_is_beyond_doubt() {
        let [none, some, clear] = [0.0, 2.0, 6.0].map(found_at);
        let apart = |weighed: &Weighed| weighed.of_rates.apart + weighed.others.apart;
        assert!(none.probability < 0.3 * tuning::PRIOR && apart(&none).amax() == 0.0, "{}", none.probability);
        assert!(none.probability < some.probability && some.probability < 0.5, "{}", some.probability);
        assert!(clear.probability > 0.9, "{}", clear.probability);
        // Nearly all of the three units that are found are there, known to about half a unit.
        let size = apart(&clear)[(0, 0)].sqrt();
        assert!((2.7..3.0).contains(&size), "{size}");
        let beside = clear.of_rates.beside + clear.others.beside;
        assert!((0.4..0.5).contains(&beside[(0, 0)].sqrt()), "{beside}");
    }

    #[test]
    fn what_explains_a_change_of_the_velocity_rules_out_no_change_of_the_spin() {
        let information = CentredMatrix::from_diagonal(&CentredVector::from_fn(|i, _| if i < 3 { 4.0 } else { 1.0 }));
        let whole = |score: CentredVector| Changes { information, score };
        // Whatever way the centroid goes.
        let alone = |score: CentredVector| {
            let information =
                CentredMatrix::from_diagonal(&CentredVector::from_fn(|i, _| if i == 0 { 4.0 } else { 1.0 }));
            Changes { information, score: CentredVector::from_fn(|i, _| if i == 0 { score[i] } else { 0.0 }) }
        };
        // Six deviations of the turn, or of the velocity; with nothing else to explain them, and with something that does so far better.
        let [[spin, velocity], [spin_beside, velocity_beside]] = [0.0, -100.0].map(|against| {
            [0, 2].map(|number| {
                let score = CentredVector::from_fn(|i, _| if i == number { 12.0 } else { 0.0 });
                whole(score).weighed(3, (CentroidVelocity::Stays, against), &alone(score)).expect("regular")
            })
        });
        assert!([spin, velocity].iter().all(|weighed| weighed.probability > 0.9));
        assert!(
            spin_beside.probability > 0.9 && spin_beside.of_rates.apart[(0, 0)] > 2.0,
            "{}",
            spin_beside.probability
        );
        // Of the velocity nothing is left.
        assert!(velocity_beside.probability < 0.3 * tuning::PRIOR && velocity_beside.others.apart.amax() < 1e-12);
        assert!(velocity_beside.of_rates.apart.amax() < 1e-12, "{}", velocity_beside.of_rates.apart);
    }

    #[test]
    fn of_a_velocity_that_changes_anyway_a_steady_change_is_no_news_and_of_the_rates_it_is() {
        let information = CentredMatrix::from_diagonal(&CentredVector::from_fn(|i, _| if i < 8 { 4.0 } else { 1.0 }));
        // Eight deviations of the turn, or of the velocity; and as many of the other, which is said by what is not asked for.
        let by = |number: usize| CentredVector::from_fn(|i, _| if i == number { 16.0 } else { 0.0 });
        for k in [3, 4, 6, 8] {
            let [spin, velocity] = [[0, k - 1], [k - 1, 0]].map(|[asked, other]| {
                let changes = |number| Changes { information, score: by(number) };
                changes(other).weighed(k, (CentroidVelocity::Changes, 0.0), &changes(asked)).expect("regular")
            });
            assert!(spin.probability > 0.8 && spin.of_rates.apart[(0, 0)] > 2.0, "{k}: {}", spin.probability);
            assert!(velocity.probability < tuning::PRIOR && velocity.of_rates.apart.amax() == 0.0, "{k}");
            assert!([spin, velocity].iter().all(|weighed| weighed.others.apart.amax() == 0.0), "{k}");
        }
    }
}
