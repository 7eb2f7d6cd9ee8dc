//! The hypotheses side by side.
use std::borrow::Cow;

use freeform_riccati::MotionModel;
use nalgebra::{Point2, SMatrix, SVector};

use super::{
    arrival::Arrival,
    centred::{CentredDeviations, CentredPose, CentredVector, LARGEST, Summary, carried},
    centroid_shift::of_logarithm,
    common_error::CommonError,
    correction::{less_known, root_of, solved},
    course::{Course, PointOfBody},
    hypothesis::{CentredMeasurement, Hypothesis},
    innovations::InnovationSeries,
    mixing::mix,
    perspective::is_beyond_linear,
    setting::{Dynamics, DynamicsWeights},
    steady_change::SteadyChange,
    step::Step,
    usual_step::{Units, UsualStep},
};
#[cfg(feature = "serde")]
use crate::tuning::saved_state::SUM_OFF;
use crate::{belief::StateMatrix, map::NullDirection, tuning::dynamics as tuning, update::PoseMeasurement};

/// Hypotheses at most.
pub(super) const MOST: usize = 4
    + tuning::SHAKEN.len()
    + (tuning::LEVELS.len() + tuning::LEVELS_OF_VELOCITY.len() + tuning::LEVELS_OF_GENERATOR.len());

type Weights = [f64; MOST];

/// Hypotheses of how the motion goes on, each with a state of its own of N entries, three for each parameter of the model, and their
/// probabilities.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct InteractingHypotheses<const N: usize> {
    pub(super) model: MotionModel,
    setting: Dynamics,
    pub(super) hypotheses: Vec<Hypothesis<N>>,
    /// None but from a prediction to the end of its step.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) arrivals: Vec<Arrival<N>>,
    /// None while the motion is seen to change, and where a setting says how it goes on.
    pub(super) steady_change: Option<SteadyChange<N>>,
    /// In the same order; zeros behind them.
    pub(super) weights: Weights,
    /// Means over the last frames, none in frames in which no changing motion led.
    pub(super) recent_weights: Weights,
    /// What the errors of all poses are taken from.
    pub(super) reference: CentredPose,
    /// Variance of a pose as one frame tells it.
    pub(super) pose_variance: CentredVector,
    pub(super) usual_step: UsualStep,
    pub(super) common: CommonError,
    series: InnovationSeries<LARGEST>,
    /// Factor of the variance of a pose by the most probable hypothesis.
    pub(super) shaking: f64,
    pub(super) leads: bool,
    /// Whether a turn that the outline does not show is told by the path of the centroid, as whoever asks for a constant generator wants it.
    pub(super) turn_is_of_path: bool,
    /// Whether wrong poses have moved the outline: others than a constant generator have led, or the motion has changed.
    pub(super) outline_has_moved: bool,
    /// The centroid of the outline as it is now, by which that of the reference pose was placed last. `None` where it is to be placed anew.
    pub(super) centroid_now: Option<Point2<f64>>,
}

impl<const N: usize> InteractingHypotheses<N> {
    /// Begins with what is believed of an object after a step of so many seconds. `None` for numbers that do not allow it, and
    /// where the outline does not tell the place yet. Null directions must not be [beyond what is linear](is_beyond_linear).
    /// The place is the object's centroid in the body frame, with the null directions of its pose.
    pub(crate) fn begin(
        model: MotionModel,
        setting: Dynamics,
        (summary, given_outline): (&Summary, &StateMatrix),
        (centroid, null): (Point2<f64>, &[NullDirection]),
        seconds: f64,
    ) -> Option<Self> {
        let k = model.parameter_count();
        if 3 * k != N || seconds <= 0.0 {
            return None;
        }
        let reference = CentredPose { pose: summary.pose, centroid };
        // Poses are followed as they are measured, against the outline as it is.
        let [(mean, mut covariance), (_, measured)] = Self::about_centroid(model, (summary, given_outline), &reference);
        let common = CommonError::of_outline(model, &covariance, &measured, &reference);
        let deviation_of_step = |i: usize| covariance[(i, i)].sqrt() * seconds;
        if (2 * k - 2..2 * k).any(|i| deviation_of_step(i) > tuning::UNTOLD) {
            return None;
        }
        for (i, j) in (0..2 * k).flat_map(|i| (0..k).map(move |j| (i, j))) {
            (covariance[(i, j)], covariance[(j, i)]) = (measured[(i, j)], measured[(j, i)]);
        }
        let pose_variance =
            CentredVector::from_fn(|j, _| if j < k { covariance[(j, j)].max(tuning::LEAST_VARIANCE) } else { 1.0 });
        let mut filter = Self {
            model,
            setting,
            hypotheses: Vec::with_capacity(MOST),
            arrivals: Vec::with_capacity(MOST),
            steady_change: None,
            weights: [0.0; MOST],
            recent_weights: [0.0; MOST],
            reference,
            pose_variance,
            usual_step: UsualStep::of(seconds),
            common,
            series: InnovationSeries::default(),
            shaking: 1.0,
            outline_has_moved: false,
            centroid_now: Some(centroid),
            leads: false,
            turn_is_of_path: false,
        };
        for course in Course::all_of(setting) {
            filter.weights[filter.hypotheses.len()] = course.prior();
            let hypothesis = Hypothesis::begin((course, model), (mean, covariance), (&filter.pose_variance, seconds));
            filter.hypotheses.push(hypothesis);
        }
        filter.normalise();
        filter.reckon_with_change();
        if setting != Dynamics::Auto && setting != Dynamics::Generator {
            filter.lead_from_now_on();
        }
        if setting == Dynamics::Generator && model <= MotionModel::Similarity && !null.is_empty() {
            filter.add_turn_of_path(null, seconds);
        }
        Some(filter)
    }

    /// Mean and covariance about the centroid of what is believed, and of that if the outline is known.
    pub(super) fn about_centroid(
        model: MotionModel,
        (summary, given_outline): (&Summary, &StateMatrix),
        reference: &CentredPose,
    ) -> [(SVector<f64, N>, SMatrix<f64, N, N>); 2] {
        let (change, k) = (reference.about_centroid(model), model.parameter_count());
        let of_poses = Summary { covariance: *given_outline, ..*summary };
        [summary, &of_poses].map(|summary| summary.about_centroid(&change, k))
    }

    /// Begins to reckon with a steady change where the motion is constant: from the beginning, and after it has been seen to change.
    fn reckon_with_change(&mut self) {
        let DynamicsWeights { generator, velocity, .. } = self.weights();
        if self.setting == Dynamics::Auto && self.steady_change.is_none() && generator + velocity >= tuning::LEADS_UNTIL
        {
            let constant = self.hypotheses.iter().find(|hypothesis| hypothesis.course == Course::ConstantGenerator);
            let units = (&self.pose_variance, self.usual_step.seconds());
            self.steady_change =
                constant.map(|constant| SteadyChange::begin(self.model, (constant.mean, constant.covariance), units));
        }
    }

    fn normalise(&mut self) {
        let sum: f64 = self.weights.iter().sum();
        if sum > 0.0 && sum.is_finite() {
            self.weights.iter_mut().for_each(|weight| *weight /= sum);
        } else {
            let count = self.hypotheses.len();
            self.weights[..count].fill(1.0 / count as f64);
        }
    }

    /// Moves all hypotheses on by a step, after mixing their states; `pose` is where the object is predicted otherwise.
    /// Whether the numbers allow it.
    pub(crate) fn predict(&mut self, pose: &CentredPose, seconds: f64, null: &[NullDirection]) -> bool {
        if is_beyond_linear(self.model, null) {
            return false;
        }
        debug_assert!(self.arrivals.is_empty(), "the step before has not ended");
        let steps = self.usual_step.follow(seconds);
        self.reckon_with_change();
        let moved = CentredPose { pose: self.reference.pose, centroid: self.place_centroid(&pose.centroid) };
        let (model, reference) = (self.model, self.reference);
        if moved.centroid != reference.centroid {
            self.all().for_each(|hypothesis| hypothesis.move_centroid(model, &reference, &moved));
        }
        self.reference = moved;
        let to = CentredPose { pose: pose.pose, centroid: moved.centroid };
        let arrivals = self.leads.then_some(&mut self.arrivals);
        let units = Units { pose_variance: &self.pose_variance, usual: self.usual_step.seconds(), steps };
        mix(&mut self.hypotheses, &mut self.weights, self.model, units, arrivals);
        let step = Step::new((self.model, seconds), [&self.reference, &to], units);
        let possible = step.is_some_and(|step| {
            let fails = |change: &mut SteadyChange<N>| change.hypotheses().iter_mut().any(|h| !h.predict(&step));
            if self.steady_change.as_mut().is_some_and(fails) {
                self.steady_change = None;
            }
            let arrived = self.arrivals.iter_mut().map(|arrival| &mut arrival.state);
            self.hypotheses.iter_mut().chain(arrived).all(|hypothesis| hypothesis.predict(&step))
        });
        self.reference = to;
        if !self.turn_is_of_path {
            self.hold(null);
        }
        possible
    }

    /// All that are moved on, those without a weight too.
    pub(super) fn all(&mut self) -> impl Iterator<Item = &mut Hypothesis<N>> {
        let arrived = self.arrivals.iter_mut().map(|arrival| &mut arrival.state);
        self.hypotheses
            .iter_mut()
            .chain(arrived)
            .chain(self.steady_change.iter_mut().flat_map(SteadyChange::hypotheses))
    }

    /// Ends a step, also one whose frame has told nothing of the pose: takes those that have changed to each hypothesis to be one with those that
    /// have not.
    pub(crate) fn end_step(&mut self) {
        let Self { hypotheses, arrivals, .. } = self;
        arrivals.drain(..).for_each(|arrival| arrival.blend_into(&mut hypotheses[arrival.number]));
    }

    /// The hypothesis of a number with those that have changed to it.
    pub(super) fn blended<'a>(&self, number: usize, hypothesis: &'a Hypothesis<N>) -> Cow<'a, Hypothesis<N>> {
        let mut blended = Cow::Borrowed(hypothesis);
        if let Some(arrival) = self.arrivals.iter().find(|arrival| arrival.number == number) {
            arrival.blend_into(blended.to_mut());
        }
        blended
    }

    /// Updates by what an accepted frame tells of the pose: the error of the reference pose. `off` are standard deviations of that pose about the
    /// centroid which come to those of the frame, such as for rounding.
    pub(crate) fn update(&mut self, measured: &PoseMeasurement, off: &CentredDeviations) {
        let k = self.model.parameter_count();
        let Some(to) = self.reference.about_origin(self.model) else { return };
        let information = carried(&to.transpose(), &measured.information, k);
        let pulled = measured.pulled + measured.information * self.common.shift_in(&self.reference.pose);
        let pulled = to.transpose() * pulled;
        let pulled = CentredVector::from_fn(|i, _| if i < k { pulled[i] } else { 0.0 });
        let Some(deviation) = solved(&information, &pulled, k) else { return };
        // The correction is that of the solution: the deviation may be anything along what the frame hardly tells.
        let solution = self.reference.about_centroid(self.model) * measured.solution;
        let beyond = of_logarithm(self.model, &solution).map_or(CentredVector::zeros(), |error| error - solution);
        let deviation = deviation + beyond;
        let Some(information) = less_known(information, off) else { return };
        for j in 0..k {
            let own = information[(j, j)] / measured.noise_inflation;
            let variance = if own > 0.0 { (1.0 / own).min(tuning::LARGEST_VARIANCE) } else { tuning::LARGEST_VARIANCE };
            self.pose_variance[j] += tuning::VARIANCE_GAIN * (variance - self.pose_variance[j]);
        }
        let measurement =
            CentredMeasurement { root: root_of(&information, k), deviation, noise_inflation: measured.noise_inflation };
        let mut logarithms = [f64::NEG_INFINITY; MOST];
        let mut standardised = [None; MOST];
        for (number, hypothesis) in self.hypotheses.iter_mut().enumerate() {
            let innovation = hypothesis.update(&measurement);
            logarithms[number] = innovation.map_or(f64::NEG_INFINITY, |i| i.log_likelihood);
            standardised[number] = innovation.map(|i| i.standardised);
        }
        for arrival in &mut self.arrivals {
            let number = arrival.number;
            let (logarithm, score) = arrival.update(&measurement, (logarithms[number], standardised[number]));
            (logarithms[number], standardised[number]) = (logarithm, score);
        }
        if let Some(change) = &mut self.steady_change {
            let is_velocity = |h: &Hypothesis<N>| h.course == Course::straight(PointOfBody::NearCentroid);
            let velocity = self.hypotheses.iter().position(is_velocity);
            change.update((&measurement, &information), velocity.map(|number| logarithms[number]));
        }
        let largest = logarithms.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if !largest.is_finite() {
            return;
        }
        for (weight, logarithm) in self.weights.iter_mut().zip(&logarithms) {
            *weight *= (logarithm - largest).exp();
        }
        self.normalise();
        let best = (0..self.weights.len()).max_by(|a, b| self.weights[*a].total_cmp(&self.weights[*b]));
        if let Some((best, e)) = best.and_then(|best| Some((best, standardised[best]?))) {
            self.series.add(&e, k);
            self.shaking = self.hypotheses[best].course.shaking();
        }
        let weight = self.weights().generator;
        if self.setting == Dynamics::Auto {
            self.leads = if self.leads { weight < tuning::LEADS_UNTIL } else { weight < tuning::LEADS_FROM };
            if self.leads {
                self.record_that_outline_moves();
            }
            if self.weights().accelerating > 1.0 - tuning::OUTSIDE_INTERVAL {
                self.steady_change = None;
            }
        }
        let weights = self.hypotheses.iter().zip(&self.weights);
        for (recent, (hypothesis, weight)) in self.recent_weights.iter_mut().zip(weights) {
            let gain = if hypothesis.course.is_forgetful() { tuning::FORGETFUL_GAIN } else { tuning::RECENT_GAIN };
            *recent += gain * (if self.leads { *weight } else { 0.0 } - *recent);
        }
    }

    /// Whether the states of all hypotheses are finite. A covariance has no larger entries than its diagonal allows.
    pub(crate) fn is_finite(&self) -> bool {
        let numbers = |hypothesis: &Hypothesis<N>| hypothesis.mean.sum() + hypothesis.covariance.trace();
        self.hypotheses.iter().map(numbers).sum::<f64>().is_finite()
    }

    /// Records that the motion has changed in a way that no hypothesis models.
    pub(crate) fn record_change(&mut self) {
        self.record_that_outline_moves();
        self.steady_change = None;
    }

    /// Whether the hypotheses, and not a constant generator alone, say where the object is expected next.
    pub(crate) fn leads(&self) -> bool {
        self.leads
    }

    /// Whether a turn that the outline does not show is told by the path of the centroid.
    pub(crate) fn turn_is_of_path(&self) -> bool {
        self.turn_is_of_path
    }

    /// Whether hypotheses other than a constant generator are not ruled out, and do not lead already.
    pub(crate) fn has_others(&self) -> bool {
        let of_generator =
            self.hypotheses.iter().zip(&self.weights).find(|(h, _)| h.course == Course::ConstantGenerator);
        !self.leads && of_generator.is_some_and(|(_, weight)| 1.0 - weight > tuning::OUTSIDE_INTERVAL)
    }

    /// Factors, at least 1, by which the innovations say that deviations about the centroid are to be widened.
    pub(crate) fn factors(&self) -> CentredDeviations {
        let spread = self.series.spread(self.model.parameter_count());
        CentredDeviations::from_fn(|j, _| spread.get(j).copied().unwrap_or(1.0))
    }

    /// Whether the frames are explained best by a motion or a camera that changes at random.
    pub(crate) fn changes_at_random(&self) -> bool {
        self.shaking > 1.0 || self.weights().most_probable() == Dynamics::Accelerating
    }

    /// Mean square of the innovations, at least 1: how much larger than the model's errors are.
    pub(crate) fn widening(&self) -> f64 {
        let k = self.model.parameter_count();
        self.shaking * (0..k).map(|j| self.series.mean_square(j)).sum::<f64>().max(k as f64) / k as f64
    }
}

#[cfg(feature = "serde")]
impl<const N: usize> InteractingHypotheses<N> {
    /// Whether the hypotheses are those of a model and a setting, and all their numbers can be worked with.
    pub(crate) fn is_valid(&self, model: MotionModel, setting: Option<Dynamics>) -> bool {
        let is_finite = |numbers: &[f64]| numbers.iter().all(|number| number.is_finite());
        let count = self.hypotheses.len();
        let followed = self.hypotheses.iter().map(|hypothesis| hypothesis.course);
        let (weights, beyond) = self.weights.split_at(count.min(MOST));
        self.model == model
            && Some(self.setting) == setting
            && 3 * model.parameter_count() == N
            && followed.eq(Course::all_of(self.setting))
            && self.hypotheses.iter().all(|h| is_finite(h.mean.as_slice()) && is_finite(h.covariance.as_slice()))
            && weights.iter().chain(&self.recent_weights).all(|weight| (0.0..=1.0).contains(weight))
            && (weights.iter().sum::<f64>() - 1.0).abs() < SUM_OFF
            && beyond.iter().all(|weight| *weight == 0.0)
            && is_finite(self.reference.pose.as_slice())
            && is_finite(self.reference.centroid.coords.as_slice())
            && self.centroid_now.is_none_or(|centroid| is_finite(centroid.coords.as_slice()))
            && self.pose_variance.iter().all(|variance| variance.is_finite() && *variance > 0.0)
            && self.usual_step.is_valid()
            && self.steady_change.as_ref().is_none_or(SteadyChange::is_valid)
            && self.common.is_valid(model)
            && self.series.is_valid()
            && (self.shaking == 1.0
                || Course::all_of(self.setting).iter().any(|course| course.shaking() == self.shaking))
    }
}
