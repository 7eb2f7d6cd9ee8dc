//! The hypotheses taken together.
use freeform_riccati::MAX_PARAMETERS;
use nalgebra::{SMatrix, SVector};

use super::{
    centred::{Summary, by_rates, carried, centred_generator, of_both, parts},
    centroid_shift::{logarithm_of, of_logarithm},
    course::{Course, PointOfBody},
    hypothesis::Hypothesis,
    interacting::{InteractingHypotheses, MOST},
    steady_change::PossibleChange,
    weighed_changes::CentroidVelocity,
};
use crate::{
    belief::StateMatrix,
    tuning::{dynamics as tuning, statement::REACH},
};

/// What the hypotheses are taken together for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Purpose {
    /// To say where the object is expected.
    Prediction,
    /// As that, by those that do not have a constant generator.
    PredictionByOthers,
    /// To say how well the motion is known.
    Statement,
}

/// A hypothesis that is not left out, as it is taken together with others: the velocity is that of the plane of the object where the centroid
/// of the reference pose is.
#[derive(Debug, Clone, Copy)]
struct Part<const N: usize> {
    weight: f64,
    /// Weight in what is stated of the errors: no less than of late.
    counted: f64,
    mean: SVector<f64, N>,
    /// None for the least probable hypotheses, which have less than 5 % together: only their means count.
    covariance: Option<SMatrix<f64, N, N>>,
    /// Whether its pose is measured against the outline, and is not known together with it.
    is_measured: bool,
    /// Whether the centroid of the object accelerates, and no point aside.
    accelerates: bool,
}

impl<const N: usize> InteractingHypotheses<N> {
    /// The weight below which hypotheses are left out: all of them together are less probable than what lies outside of an interval.
    fn least_weight(weights: &[f64; MOST], outside: f64) -> f64 {
        let mut sorted = *weights;
        sorted.sort_unstable_by(f64::total_cmp);
        let mut sum = 0.0;
        sorted
            .into_iter()
            .find(|weight| {
                sum += weight;
                sum > outside
            })
            .unwrap_or(0.0)
    }

    /// Mean and covariance of what is given for a constant generator. Once the motion has changed, wrong poses have moved the outline that it
    /// is known with.
    fn of_generator(&self, given: &Summary) -> Option<(SVector<f64, N>, SMatrix<f64, N, N>)> {
        let (model, change) = (self.model, self.reference.about_centroid(self.model));
        let k = model.parameter_count();
        let (mut mean, covariance) = given.about_centroid(&change, k);
        let off = model.motion_between(&(given.pose * self.reference.pose.try_inverse()?), 1.0)?;
        let shift = if self.outline_has_moved { self.common.shift_in(&self.reference.pose) } else { SVector::zeros() };
        let moved = of_logarithm(model, &(change * (SVector::<f64, MAX_PARAMETERS>::from(off) + shift)))?;
        (0..k).for_each(|j| mean[j] = moved[j]);
        Some((mean, covariance))
    }

    /// Mean of a hypothesis, whose own velocity is that of the centroid where that is.
    fn mean_of(&self, hypothesis: &Hypothesis<N>) -> SVector<f64, N> {
        let k = self.model.parameter_count();
        let (mut mean, rates) = (hypothesis.mean, hypothesis.rates(self.model));
        let mut velocity = mean.fixed_rows_mut::<2>(2 * k - 2);
        velocity -= rates * hypothesis.mean.fixed_rows::<2>(k - 2);
        mean
    }

    /// Errors of that mean by those of a hypothesis.
    fn place_of(&self, hypothesis: &Hypothesis<N>) -> SMatrix<f64, N, N> {
        let (model, k) = (self.model, self.model.parameter_count());
        let apart = hypothesis.mean.fixed_rows::<2>(k - 2).into_owned();
        let mut change = SMatrix::<f64, N, N>::identity();
        change.fixed_view_mut::<2, 2>(2 * k - 2, k - 2).copy_from(&-hypothesis.rates(model));
        for (j, by_rate) in by_rates(model, &-apart).enumerate() {
            change.fixed_view_mut::<2, 1>(2 * k - 2, k + j).copy_from(&by_rate);
        }
        change
    }

    /// Covariance of that mean.
    fn covariance_of(&self, hypothesis: &Hypothesis<N>) -> SMatrix<f64, N, N> {
        carried(&self.place_of(hypothesis), &hypothesis.covariance, 2 * self.model.parameter_count())
    }

    /// What rates or a velocity that change at a steady rate add to hypotheses by which they are constant, weighted with them.
    fn possible_change(&self) -> Option<PossibleChange<N>> {
        let change = self.steady_change.as_ref().filter(|change| !change.is_over())?;
        let factors = self.factors();
        let mut sum = PossibleChange { probability: 0.0, apart: SMatrix::zeros(), beside: SMatrix::zeros() };
        for (hypothesis, weight) in self.hypotheses.iter().zip(&self.weights) {
            let velocity = match hypothesis.course {
                Course::ConstantGenerator => CentroidVelocity::Turns,
                course if course == Course::straight(PointOfBody::NearCentroid) => CentroidVelocity::Stays,
                // Where a point aside keeps its velocity the centroid does not, and neither where it accelerates: that is no change of this motion.
                Course::ConstantVelocity { .. } | Course::Accelerating { rates: false, .. } => {
                    CentroidVelocity::Changes
                }
                Course::Shaken { .. }
                | Course::Accelerating { .. }
                | Course::ChangingGenerator { .. }
                | Course::SteadyChange { .. } => continue,
            };
            if *weight > tuning::OUTSIDE_THREE_DEVIATIONS {
                // By poses of a camera that shakes, be it by this hypothesis or by the one that explains the frames best, a change is told as much less.
                let wider = (&factors, self.shaking.max(hypothesis.course.shaking()));
                let Some(possible) = change.possible(velocity, wider, &self.place_of(hypothesis)) else { continue };
                sum.probability += weight * possible.probability;
                sum.apart += possible.apart * *weight;
                sum.beside += possible.beside * *weight;
            }
        }
        Some(sum)
    }

    /// The states of all hypotheses taken together, that of a constant generator replaced by what is `given` for it, which knows the
    /// outline as well. The pose is counted from where the outline was when they began.
    pub(crate) fn combined(&self, given: Option<&Summary>, purpose: Purpose) -> Option<Summary> {
        let k = self.model.parameter_count();
        let of_generator = match given {
            Some(given) => Some(self.of_generator(given)?),
            None => None,
        };
        let parts_of_all = self.parts(of_generator, purpose);
        let all = || parts_of_all.iter().flatten();
        let sum: f64 = all().map(|part| part.weight).sum();
        // As long as a constant generator is not ruled out its own estimate is the best there is; the others only widen it.
        let mean = match of_generator {
            Some((mean, _)) => mean,
            _ => all().fold(SVector::zeros(), |mean, part| mean + part.mean * (part.weight / sum)),
        };
        let change = if purpose == Purpose::Statement { self.possible_change() } else { None };
        let counted: f64 = all().map(|part| part.counted).sum();
        let reach = if of_generator.is_some() { reach_of(1.0 - self.weights().generator / counted) } else { 1.0 };
        let mut covariance = SMatrix::<f64, N, N>::zeros();
        let (mut measured, mut accelerated) = (0.0, 0.0);
        for part in all() {
            let (weight, x) = (part.counted / counted, &part.mean);
            measured += if part.is_measured { weight } else { 0.0 };
            accelerated += if part.accelerates { weight } else { 0.0 };
            for j in 0..2 * k {
                for i in 0..2 * k {
                    let own = part.covariance.as_ref().map_or(0.0, |p| p[(i, j)]);
                    covariance[(i, j)] += weight * (own + reach * (x[i] - mean[i]) * (x[j] - mean[j]));
                }
            }
        }
        if let Some(PossibleChange { probability, apart, beside }) = change {
            covariance += apart * reach_of(probability) + beside;
        }
        if purpose == Purpose::Statement {
            let rates = parts(&centred_generator(self.model, &mean.as_slice()[k..2 * k])).0;
            self.common.add_to(&mut covariance, &self.reference, (measured, accelerated), &rates)?;
        }
        self.about_origin(&mean, &covariance)
    }

    /// How much a hypothesis has explained the frames of late. One that forgets soon has to have explained several: what explains a sudden push says nothing
    /// of the frames after it, and what has explained all of a body that swings fast explains them again once it has turned round.
    fn recent_weight(&self, number: usize) -> f64 {
        let recent = self.recent_weights[number];
        let is_forgetful = self.hypotheses.get(number).is_some_and(|hypothesis| hypothesis.course.is_forgetful());
        if is_forgetful && recent < tuning::SEVERAL { 0.0 } else { recent }
    }

    /// The hypotheses that are not left out, mean and covariance of a constant generator replaced by what is known of it, if that is.
    fn parts(
        &self,
        of_generator: Option<(SVector<f64, N>, SMatrix<f64, N, N>)>,
        purpose: Purpose,
    ) -> [Option<Part<N>>; MOST] {
        // What explained the frames of late may be needed again in the next.
        let counted: [f64; MOST] = match purpose {
            Purpose::Prediction | Purpose::PredictionByOthers => self.weights,
            Purpose::Statement => std::array::from_fn(|number| self.weights[number].max(self.recent_weight(number))),
        };
        let likely = Self::least_weight(&counted, tuning::OUTSIDE_INTERVAL);
        let least = match purpose {
            Purpose::Prediction | Purpose::PredictionByOthers => likely,
            Purpose::Statement => Self::least_weight(&counted, tuning::OUTSIDE_THREE_DEVIATIONS),
        };
        std::array::from_fn(|number| {
            let (hypothesis, weight) = (self.hypotheses.get(number)?, self.weights[number]);
            let counted = counted[number];
            let is_generator = hypothesis.course == Course::ConstantGenerator;
            let has_generator = is_generator || matches!(hypothesis.course, Course::Shaken { .. });
            let takes_part = counted >= least && !(has_generator && purpose == Purpose::PredictionByOthers);
            takes_part.then(|| match of_generator.filter(|_| is_generator) {
                Some((mean, covariance)) => {
                    let covariance = Some(covariance);
                    Part { weight, counted, mean, covariance, is_measured: self.outline_has_moved, accelerates: false }
                }
                None => {
                    let hypothesis = &*self.blended(number, hypothesis);
                    let mean = self.mean_of(hypothesis);
                    let covariance = (counted >= likely).then(|| self.covariance_of(hypothesis));
                    let accelerates = matches!(hypothesis.course, Course::Accelerating { .. });
                    Part { weight, counted, mean, covariance, is_measured: true, accelerates }
                }
            })
        })
    }

    /// Mean and covariance about the centroid, as pose and motion about the origin; `None` where they are not finite.
    fn about_origin(&self, mean: &SVector<f64, N>, covariance: &SMatrix<f64, N, N>) -> Option<Summary> {
        let (model, k) = (self.model, self.model.parameter_count());
        let to = self.reference.about_origin(model)?;
        let large =
            |at: usize| SVector::<f64, MAX_PARAMETERS>::from_fn(|j, _| if j < k { mean[at * k + j] } else { 0.0 });
        let (error, motion) = (to * logarithm_of(model, &large(0))?, to * large(1));
        let pose = model.flow(&error.as_slice()[..k], 1.0).into_inner() * self.reference.pose;
        let both = StateMatrix::from_fn(|i, j| if i < 2 * k && j < 2 * k { covariance[(i, j)] } else { 0.0 });
        let covariance = carried(&of_both(&to, k), &both, 2 * k);
        pose.iter().all(|e| e.is_finite()).then_some(Summary { pose, motion: motion.into(), covariance })
    }
}

/// What squared distances from what is stated count more than by the probability of `others`: an interval of 95 % reaches those that have as
/// much as lies outside.
fn reach_of(others: f64) -> f64 {
    if others > 0.0 { (REACH / others.max(tuning::OUTSIDE_INTERVAL)).max(1.0) } else { 1.0 }
}
