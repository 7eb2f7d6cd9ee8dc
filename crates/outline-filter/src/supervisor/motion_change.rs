//! How fast the motion changes, estimated from the innovations.
use freeform_riccati::MAX_PARAMETERS;
use nalgebra::SVector;

#[cfg(feature = "serde")]
use super::settings::FilterSettings;
use crate::{
    belief::StateMatrix,
    dynamics::DynamicsFilter,
    map::NullDirections,
    prediction::{ByKind, PoseMatrix},
    track::{Outcome, Track},
    tuning::{motion_change as tuning, statement::REACH},
    update::{PoseInnovation, PoseMeasurement},
};
#[cfg(feature = "serde")]
use freeform_estimate::StateFormat;

/// One entry for each parameter of a pose.
pub(super) type PoseVector = SVector<f64, MAX_PARAMETERS>;

const KEPT: f64 = 1.0 - 1.0 / tuning::MEMORY;

/// Recursive maximum-likelihood estimates, by Fisher's scoring, of the variances by which the rates and the velocities of the motion change
/// per second; none until the evidence is significant.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct MotionChange {
    kinds: [Change; 2],
    /// Evidence for a change of either kind: one test for both keeps the false-alarm rate of a single test.
    of_both: Evidence,
    /// Whether it has ever changed from one frame to the next by more than such variances tell.
    pub(crate) was_sudden: bool,
}

/// What is known of how a motion changes: by its innovations, and by hypotheses of its dynamics.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct MotionHistory {
    pub(super) change: MotionChange,
    /// None before the third frame, and where dynamics are not told.
    pub(super) dynamics: Option<DynamicsFilter>,
    /// A frame that shows the object elsewhere than it was expected, and was not taken.
    contradiction: Option<Contradiction>,
    /// Time since a frame was taken last.
    pub(super) since_taken: f64,
}

/// A frame that shows the object elsewhere than it was expected, and was not taken: it is wrong, or the motion has changed.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Contradiction {
    apart: Apart,
    /// Time from the last frame that was taken to this one.
    after: f64,
}

/// How far an object lies from where it was expected, as a frame shows it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Apart {
    /// Error of the expected pose, like those of the belief, of a turn that is small.
    pub(super) error: PoseVector,
    pub(super) covariance: PoseMatrix,
    pub(super) shown: Shown,
}

impl Apart {
    /// As a frame tells it that shows the outline; along what the outline does not show, nothing.
    pub(super) fn measured(pose: &PoseMeasurement, shown: Shown, null: &NullDirections) -> Option<Self> {
        let (mut error, mut covariance) = pose.error()?;
        null.subtract_from(&mut error.data.0[0]);
        // On both sides: of the columns, and of the rows as columns.
        for _ in 0..2 {
            covariance.data.0.iter_mut().for_each(|column| null.subtract_from(column));
            covariance.transpose_mut();
        }
        Some(Self { error, covariance, shown })
    }
}

/// How much of an object a frame shows elsewhere than it was expected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) enum Shown {
    /// All of it: its motion has changed, unless it is something else.
    Whole,
    /// A part: it may as well be hidden.
    InPart,
}

impl Shown {
    /// How many times faster than on the mean since a frame was taken last the object may move now.
    fn times_faster(self) -> f64 {
        match self {
            Self::Whole => tuning::TIMES_FASTER,
            Self::InPart => 1.0,
        }
    }
}

impl MotionHistory {
    /// Whether the motion has been seen to change by more than a constant generator does.
    pub(super) fn is_changing(&self) -> bool {
        let leads = |dynamics: &DynamicsFilter| dynamics.leads() && !dynamics.turn_is_of_path();
        self.change.is_seen() || self.dynamics.as_ref().is_some_and(leads)
    }

    /// Steps that the motion is known from, as hypotheses of dynamics say: without a limit where it is constant, in whatever sense.
    pub(super) fn memory(&self) -> Option<f64> {
        self.dynamics.as_ref().map(DynamicsFilter::memory)
    }

    /// By how many times larger the errors of the frames of a track are than the model's, such as those of a camera that shakes: these are no change
    /// of the motion.
    pub(super) fn widening(&self, track: &Track) -> f64 {
        let Some(dynamics) = &self.dynamics else { return 1.0 };
        // Those of a constant motion are told by the noise of the points, and compared by what may be more.
        let share = if dynamics.changes_at_random() { 1.0 } else { track.noise_over_comparable() };
        (dynamics.widening() * share * share).max(1.0)
    }

    /// Records what became of a frame some time after the one before; `apart` is how far the object lies from where it was expected, as one shows it that
    /// was not taken.
    pub(super) fn record(&mut self, outcome: &Outcome, seconds: f64, apart: Option<Apart>) {
        self.since_taken += seconds;
        if outcome.is_accepted() {
            (self.contradiction, self.since_taken) = (None, 0.0);
            if let Some((dynamics, measured)) = self.dynamics.as_mut().zip(outcome.pose.as_ref()) {
                dynamics.update(measured, &outcome.rounding);
                dynamics.add_shift(&outcome.shift);
                dynamics.forget(&outcome.forgotten, seconds);
                if self.change.is_seen() {
                    dynamics.record_change();
                }
                if !dynamics.is_finite() {
                    self.dynamics = None;
                }
            }
        } else if let Some(apart) = apart {
            self.contradiction = Some(Contradiction { apart, after: self.since_taken });
        }
        self.end_step();
    }

    /// Ends a step, whether a frame has told something or not.
    pub(super) fn end_step(&mut self) {
        self.dynamics.as_mut().into_iter().for_each(DynamicsFilter::end_step);
    }

    /// A covariance of pose and motion, of k parameters, by which an interval of 95 % reaches what a frame shows that has not been taken.
    pub(super) fn contradicted(&self, k: usize) -> Option<StateMatrix> {
        let Contradiction { apart: Apart { error, covariance, shown }, after } = self.contradiction?;
        let squares = REACH * error * error.transpose() + covariance;
        // Of the motion since that frame, and of the pose that it has led to.
        let faster = shown.times_faster() / after;
        let times = [1.0 + faster * (self.since_taken - after), faster];
        Some(StateMatrix::from_fn(|i, j| {
            if i < 2 * k && j < 2 * k { times[i / k] * times[j / k] * squares[(i % k, j % k)] } else { 0.0 }
        }))
    }

    /// Of another pose: without what was tied to this one.
    pub(super) fn begun_anew(&self) -> Self {
        Self { change: self.change, ..Self::default() }
    }
}

/// The variance of one kind of change, with the evidence for it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Change {
    /// Normalised units, per second.
    variance: f64,
    evidence: Evidence,
    has_changed: bool,
}

/// Slope of the likelihood by a variance at none, of every frame in its own standard deviations, over the frames looked back on. Frames in
/// which much is known count no more than others: their Fisher information is that of a variance of next to none.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Evidence {
    slope: f64,
    /// Roots of the Fisher information: what the slope is for a unit variance.
    by_variance: f64,
    frames: f64,
}

impl MotionChange {
    /// The variances, unless both are none.
    pub(crate) fn variances(&self) -> Option<ByKind> {
        let variances = self.kinds.map(|change| change.variance);
        variances.iter().any(|v| *v > 0.0).then_some(variances)
    }

    /// Whether the motion has been seen to change.
    pub(crate) fn is_seen(&self) -> bool {
        self.was_sudden || self.kinds.iter().any(|change| change.variance > 0.0 || change.has_changed)
    }

    /// Updates the variances by the innovation of an accepted frame of a motion with so many parameters.
    pub(crate) fn update(&mut self, innovation: &PoseInnovation, parameters: usize) {
        let limit = tuning::LIMIT * parameters as f64;
        let share = if innovation.squared > limit { limit / innovation.squared } else { 1.0 };
        let by_chance = innovation.squared < tuning::BEYOND_CHANCE * parameters as f64;
        for (change, (gradient, fisher)) in self.kinds.iter_mut().zip(innovation.gradient.iter().zip(innovation.fisher))
        {
            if fisher > 0.0 {
                change.update(gradient * share, fisher, by_chance);
            }
        }
        let open = |kind: &usize| self.kinds[*kind].variance <= 0.0;
        let gradient = (0..2).filter(open).map(|kind| innovation.gradient[kind] * share).sum();
        let is_open = (0..2).all(|kind| open(&kind));
        let fisher =
            if is_open { innovation.fisher_of_both } else { (0..2).filter(open).map(|k| innovation.fisher[k]).sum() };
        if fisher > 0.0 {
            self.of_both.add(gradient, fisher, by_chance);
        }
        let [rates, velocities] = &self.kinds;
        let significant =
            if rates.has_changed || velocities.has_changed { tuning::SIGNIFICANT_AGAIN } else { tuning::SIGNIFICANT };
        if self.of_both.deviations() > significant {
            let (clearest, other) =
                if rates.evidence.deviations() > velocities.evidence.deviations() { (0, 1) } else { (1, 0) };
            self.kinds[clearest].begin();
            // What the one explains is no evidence of the other.
            self.kinds[other].evidence = Evidence::default();
            self.of_both = Evidence::default();
        }
    }
}

impl Change {
    fn update(&mut self, gradient: f64, fisher: f64, by_chance: bool) {
        if self.variance <= 0.0 {
            self.evidence.add(gradient, fisher, by_chance);
            return;
        }
        self.variance += gradient / (tuning::MEMORY * fisher);
        if self.variance <= 0.0 {
            *self = Self { has_changed: true, ..Self::default() };
        }
    }

    fn begin(&mut self) {
        let Evidence { slope, by_variance, .. } = std::mem::take(&mut self.evidence);
        self.variance = slope / by_variance;
    }
}

impl Evidence {
    /// Adds that of one frame, no more than chance may make unless it is beyond that.
    fn add(&mut self, gradient: f64, fisher: f64, by_chance: bool) {
        let most = if by_chance { tuning::EVIDENCE } else { f64::INFINITY };
        self.slope = KEPT * self.slope + (gradient / fisher.sqrt()).min(most);
        self.by_variance = KEPT * self.by_variance + fisher.sqrt();
        self.frames = KEPT * self.frames + 1.0;
    }

    /// Slope in standard deviations; 0 where there is none.
    fn deviations(&self) -> f64 {
        if self.frames > 0.0 { self.slope / self.frames.sqrt() } else { 0.0 }
    }
}

#[cfg(feature = "serde")]
impl MotionHistory {
    /// Whether it is that of a filter with such settings, and all its numbers can be worked with.
    pub(super) fn is_valid(&self, settings: &FilterSettings) -> bool {
        let of_settings = |dynamics: &DynamicsFilter| dynamics.is_valid(settings.model, settings.followed_dynamics());
        let are_in_bounds = |numbers: &[f64]| numbers.iter().all(|entry| entry.abs() < StateFormat::LARGEST_NUMBER);
        let is_change = |Contradiction { apart, after }: &Contradiction| {
            let Apart { error, covariance, .. } = apart;
            are_in_bounds(error.as_slice())
                && are_in_bounds(covariance.as_slice())
                && covariance.diagonal().iter().all(|variance| *variance >= 0.0)
                && *after > 0.0
                && are_in_bounds(&[*after])
        };
        self.change.is_finite()
            && self.dynamics.as_ref().is_none_or(of_settings)
            && self.contradiction.as_ref().is_none_or(is_change)
            && (0.0..StateFormat::LARGEST_NUMBER).contains(&self.since_taken)
    }
}

#[cfg(feature = "serde")]
impl MotionChange {
    /// Whether every number is finite.
    pub(super) fn is_finite(&self) -> bool {
        let evidence = |e: &Evidence| [e.slope, e.by_variance, e.frames].iter().all(|number| number.is_finite());
        self.kinds.iter().all(|kind| kind.variance.is_finite() && evidence(&kind.evidence)) && evidence(&self.of_both)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_frame_that_chance_may_make_shows_no_change_but_several_in_a_row_do() {
        let innovation = PoseInnovation {
            squared: 20.0,
            gradient: [14.0, 2.0],
            fisher: [1.0; 2],
            fisher_of_both: 2.5,
            ..PoseInnovation::default()
        };
        let mut change = MotionChange::default();
        change.update(&innovation, 6);
        assert_eq!(change.variances(), None);
        (0..4).for_each(|_| change.update(&innovation, 6));
        let [rates, velocities] = change.variances().expect("a change");
        assert!(rates > 0.0 && velocities == 0.0);
    }
}
