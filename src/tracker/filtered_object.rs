//! One object that the motion filter follows, and what is known of it.
use freeform_curve_fit::Outline;
use freeform_estimate::MotionEstimate;
use freeform_outline_filter::{MotionFilter, Phase};

use super::{
    result::VELOCITY_NAMES,
    step::{Step, of_following, unstated_of},
};
use crate::picture_tracing::{TracedContours, TracedGround};
use crate::rejection::RejectionCause;
use crate::warning::Warning;

/// A filter, and what it knew before it began to look for the object again.
#[derive(Debug, Clone)]
pub(super) struct FilteredObject {
    pub(super) filter: MotionFilter,
    /// The motion as it was last known, and the time in seconds of the last frame that was used while it was.
    pub(super) last_known: Option<(f64, MotionEstimate)>,
}

impl FilteredObject {
    pub(super) fn push(&mut self, time: f64, outline: &Outline) -> Step {
        let step = match self.filter.step(time, outline) {
            Ok(step) => step,
            Err(error) => return Step { rejected_because: Some(RejectionCause::Filter(error)), ..Step::default() },
        };
        let estimate = self.filter.estimate();
        if let Some(estimate) = estimate {
            // A frame that is not used tells nothing of when the object was followed.
            let last_used =
                if step.is_accepted() { Some(time) } else { self.last_known.map(|(last_used, _)| last_used) };
            self.last_known = last_used.map(|last_used| (last_used, estimate));
        }
        let velocity = estimate.and_then(|_| self.filter.velocity());
        Step {
            phase: Some(step.phase.into()),
            hidden: estimate.as_ref().map_or_else(Vec::new, |estimate| self.hidden(estimate)),
            estimate,
            velocity,
            // One that is stated is shown.
            hides_velocity: velocity.is_none() && self.filter.hides_velocity(),
            residual: step.measurement.and_then(|measurement| measurement.noise),
            innovation: step.measurement.map(|measurement| measurement.innovation),
            state: self.filter.state(),
            ambiguity: self.filter.ambiguity(),
            aliases: self.filter.aliases(),
            rejected_because: step.rejection.map(RejectionCause::NotAccepted),
            ..Step::default()
        }
    }

    /// Parameters of an estimate that the outlines do not show.
    fn hidden(&self, estimate: &MotionEstimate) -> Vec<&'static str> {
        // Mostly all is stated.
        if unstated_of(estimate).next().is_none() {
            return Vec::new();
        }
        let parameters = estimate.parameters().zip(self.filter.hidden_parameters());
        parameters.filter(|(p, is_hidden)| p.value.is_none() && *is_hidden).map(|(p, _)| p.name).collect()
    }

    pub(super) fn warnings(&self) -> Vec<Warning> {
        let Self { filter, last_known } = self;
        let ambiguity = filter.ambiguity();
        let mut warnings = Vec::new();
        if let Some((_, estimate)) = last_known {
            let ambiguous = ambiguity.as_ref().map_or(&[][..], |ambiguity| &ambiguity.parameters);
            let unknown = estimate.parameters().zip(filter.hidden_parameters()).filter(|(p, _)| p.value.is_none());
            let (mut hidden, mut others) = (Vec::new(), Vec::new());
            for (parameter, is_hidden) in unknown.filter(|(p, _)| !ambiguous.contains(&p.name)) {
                if is_hidden { &mut hidden } else { &mut others }.push(parameter.name);
            }
            // It may be known less well than all parameters are: where it is worth stating is judged by the size of the object, not by its distance.
            if filter.estimate().is_some() && filter.velocity().is_none() && ambiguity.is_none() {
                if filter.hides_velocity() { &mut hidden } else { &mut others }.extend(VELOCITY_NAMES);
            }
            if !hidden.is_empty() {
                warnings.push(Warning::NotObservable { parameters: hidden, contours: TracedContours::default() });
            }
            if !others.is_empty() {
                warnings.push(Warning::NotKnown { parameters: others });
            }
            if filter.turn_is_told_by_path() && estimate.parameters().next().is_some_and(|p| p.value.is_some()) {
                warnings.push(Warning::RotationFromPath);
            }
        }
        if let (Phase::Acquiring, Some((time, _))) = (filter.phase(), last_known) {
            warnings.push(Warning::Reacquiring { last_known: *time });
        }
        warnings.extend(of_following(filter, last_known.map(|(time, _)| time)));
        warnings.extend(ambiguity.map(Warning::Ambiguous));
        if let Some(family) = filter.wrong_family() {
            let (motion, ground) = (filter.settings().model, TracedGround::default());
            warnings.push(Warning::WrongFamily { family, motion, ground });
        }
        let aliases = filter.aliases();
        if !aliases.is_empty() {
            warnings.push(Warning::Aliases { omega: aliases, motion: filter.settings().model });
        }
        if filter.motion_changed() {
            let dynamics = filter.dynamics().map(|weights| weights.most_probable());
            warnings.push(Warning::MotionChanged { dynamics });
        }
        warnings.sort_by_key(Warning::order);
        warnings
    }
}
