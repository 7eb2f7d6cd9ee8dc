//! The identifier of one object, whichever method it is.
#[cfg(feature = "serde")]
use std::sync::Arc;

use freeform_curve_fit::{Fit, Outline};
use freeform_estimate::{MotionEstimate, MotionState, PlaneEstimate, PointVelocity};
use freeform_outline_filter::{
    Ambiguity, DynamicsWeights, KnownOutline, MotionFilter, Phase, PlaneAmbiguity, PlaneFilter, Unstated,
};
use nalgebra::DMatrix;

#[cfg(feature = "serde")]
use super::resting::{RestingError, RestingFilter, StateFile};
use super::{
    observation::ObjectPhase,
    plane_object::PlaneObject,
    settings::{MethodSettings, TrackerError},
};
use crate::rejection::RejectionCause;
use crate::warning::{MANY_REJECTED, Warning};
use crate::{AdaptiveProgress, Pipeline, PipelineSettings};

/// What is known of one object. While it rests in a file it takes no frames, and only how often it was begun anew and whether its motion
/// changed can be asked for.
#[derive(Debug, Clone)]
pub(super) enum Identifier {
    /// The paper's identifier on the lines of fitted curves.
    Adaptive(Box<Pipeline>),
    /// The motion filter on the points of the outlines.
    Filter(Box<FilteredObject>),
    /// The motion filter, and all frames together for the motion in space.
    Plane(Box<PlaneObject>),
    /// A motion filter whose state is in a file.
    #[cfg(feature = "serde")]
    Resting(Arc<RestingFilter>),
}

/// A filter, and what it knew before it began to look for the object again.
#[derive(Debug, Clone)]
pub(super) struct FilteredObject {
    pub(super) filter: MotionFilter,
    /// Time in seconds and motion when it was last known.
    pub(super) last_known: Option<(f64, MotionEstimate)>,
}

/// What became of one frame.
#[derive(Debug, Default)]
pub(super) struct Step {
    pub(super) phase: Option<ObjectPhase>,
    pub(super) estimate: Option<MotionEstimate>,
    pub(super) hidden: Vec<&'static str>,
    pub(super) velocity: Option<PointVelocity>,
    pub(super) plane: Option<Box<PlaneEstimate>>,
    pub(super) plane_ambiguity: Option<Box<PlaneAmbiguity>>,
    pub(super) fit: Option<Fit>,
    pub(super) progress: Option<AdaptiveProgress>,
    pub(super) residual: Option<f64>,
    pub(super) innovation: Option<f64>,
    pub(super) state: Option<MotionState>,
    pub(super) ambiguity: Option<Ambiguity>,
    pub(super) aliases: Vec<f64>,
    pub(super) rejected_because: Option<RejectionCause>,
}

impl Identifier {
    /// One that has seen nothing yet.
    pub(super) fn new(settings: &MethodSettings) -> Result<Self, TrackerError> {
        Ok(match settings {
            MethodSettings::Adaptive(settings) => {
                Self::Adaptive(Box::new(Pipeline::new(PipelineSettings::clone(settings))?))
            }
            MethodSettings::Filter(settings) => {
                Self::Filter(Box::new(FilteredObject { filter: MotionFilter::new(*settings)?, last_known: None }))
            }
            MethodSettings::Plane(camera, settings) => {
                Self::Plane(Box::new(PlaneObject::new(PlaneFilter::new(*camera, *settings)?)))
            }
        })
    }

    /// Takes the outline seen at a time in seconds.
    pub(super) fn push(&mut self, time: f64, outline: &Outline) -> Step {
        match self {
            Self::Adaptive(pipeline) => match pipeline.push(time, outline) {
                Ok(result) => {
                    let phase = if result.estimate.is_some() { ObjectPhase::Adapt } else { ObjectPhase::Start };
                    let residual = Some(result.fit.diagnostics().geometric_residual);
                    let (estimate, fit, progress) = (result.estimate, Some(result.fit), result.progress);
                    let hidden = estimate.as_ref().map_or_else(Vec::new, |estimate| unstated_of(estimate).collect());
                    Step { phase: Some(phase), estimate, hidden, fit, progress, residual, ..Step::default() }
                }
                Err(error) => Step { rejected_because: Some(RejectionCause::Pipeline(error)), ..Step::default() },
            },
            Self::Filter(object) => object.push(time, outline),
            Self::Plane(object) => object.push(time, outline),
            #[cfg(feature = "serde")]
            Self::Resting(_) => Step::default(),
        }
    }

    /// Puts a motion filter to rest in a file; other methods stay as they are.
    #[cfg(feature = "serde")]
    pub(super) fn rest(&mut self, file: &Arc<StateFile>) -> Result<(), RestingError> {
        if let Self::Filter(object) = self {
            *self = Self::Resting(Arc::new(RestingFilter::of(object, file)?));
        }
        Ok(())
    }

    /// As it is when it is awake, if it rests.
    #[cfg(feature = "serde")]
    pub(super) fn awake(&self) -> Result<Option<Self>, RestingError> {
        match self {
            Self::Resting(state) => Ok(Some(Self::Filter(Box::new(state.read()?)))),
            _ => Ok(None),
        }
    }

    /// The motion as it was last known; `None` before two frames were used.
    pub(super) fn estimate(&self) -> Option<MotionEstimate> {
        match self {
            Self::Adaptive(pipeline) => pipeline.estimate(),
            Self::Filter(object) => object.last_known.map(|(_, estimate)| estimate),
            Self::Plane(_) => None,
            #[cfg(feature = "serde")]
            Self::Resting(_) => None,
        }
    }

    /// Covariance of the motion in the order of its parameters, image units, if the method gives it and the motion is known at the end.
    pub(super) fn covariance(&self) -> Option<DMatrix<f64>> {
        match self {
            Self::Filter(object) => object.filter.estimate().and_then(|_| object.filter.covariance()),
            _ => None,
        }
    }

    /// The motion of a plane in space as it was last known.
    pub(super) fn plane(&self) -> Option<PlaneEstimate> {
        match self {
            Self::Plane(object) => object.estimate(),
            _ => None,
        }
    }

    /// Two motions of a plane in space that the outlines do not decide between.
    pub(super) fn plane_ambiguity(&self) -> Option<PlaneAmbiguity> {
        match self {
            Self::Plane(object) => object.estimate().and_then(|_| object.filter.ambiguity()),
            _ => None,
        }
    }

    /// Velocity of the middle of the object at the end, if the method estimates it and it is known.
    pub(super) fn velocity(&self) -> Option<PointVelocity> {
        match self {
            Self::Filter(object) => object.filter.velocity(),
            _ => None,
        }
    }

    /// Turns that the outlines do not decide between, if any.
    pub(super) fn ambiguity(&self) -> Option<Ambiguity> {
        match self {
            Self::Filter(object) => object.filter.ambiguity(),
            _ => None,
        }
    }

    /// Other angular velocities that explain the outlines as well, rad/s.
    pub(super) fn aliases(&self) -> Vec<f64> {
        match self {
            Self::Filter(object) => object.filter.aliases(),
            _ => Vec::new(),
        }
    }

    /// Probabilities of the hypotheses of dynamics, where they are told.
    pub(super) fn dynamics(&self) -> Option<DynamicsWeights> {
        match self {
            Self::Filter(object) => object.filter.dynamics(),
            _ => None,
        }
    }

    /// As [`TrajectoryRow::segment`](super::TrajectoryRow::segment).
    pub(super) fn segment(&self) -> usize {
        match self {
            Self::Filter(object) => object.filter.segment(),
            Self::Plane(object) => object.filter.follower().segment(),
            #[cfg(feature = "serde")]
            Self::Resting(state) => state.segment,
            Self::Adaptive(_) => 0,
        }
    }

    /// The outline as far as it is known.
    pub(super) fn known_outline(&self) -> Option<KnownOutline> {
        match self {
            Self::Filter(object) => object.filter.known_outline(),
            _ => None,
        }
    }

    /// Whether the motion was seen to change, which a smoother that takes it for constant does not know.
    pub(super) fn motion_changed(&self) -> bool {
        match self {
            Self::Filter(object) => object.filter.motion_changed(),
            // The generator of a plane changes with its normal.
            Self::Plane(_) => true,
            #[cfg(feature = "serde")]
            Self::Resting(state) => state.motion_changed,
            Self::Adaptive(_) => false,
        }
    }

    /// What a user should know of the result.
    pub(super) fn warnings(&self) -> Vec<Warning> {
        match self {
            Self::Adaptive(pipeline) => pipeline.warnings(),
            Self::Filter(object) => object.warnings(),
            Self::Plane(object) => object.warnings(),
            #[cfg(feature = "serde")]
            Self::Resting(_) => Vec::new(),
        }
    }
}

impl FilteredObject {
    fn push(&mut self, time: f64, outline: &Outline) -> Step {
        let step = match self.filter.step(time, outline) {
            Ok(step) => step,
            Err(error) => return Step { rejected_because: Some(RejectionCause::Filter(error)), ..Step::default() },
        };
        let estimate = self.filter.estimate();
        if let Some(estimate) = estimate {
            // Of a lost object nothing is stated, but when something was.
            let is_stated = estimate.parameters().any(|p| p.value.is_some());
            let since = self.last_known.filter(|_| !is_stated && self.filter.phase() == Phase::Lost);
            self.last_known = Some((since.map_or(time, |(since, _)| since), estimate));
        }
        Step {
            phase: Some(step.phase.into()),
            hidden: estimate.as_ref().map_or_else(Vec::new, |estimate| self.hidden(estimate)),
            estimate,
            velocity: estimate.and_then(|_| self.filter.velocity()),
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

    fn warnings(&self) -> Vec<Warning> {
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
            if !hidden.is_empty() {
                warnings.push(Warning::NotObservable { parameters: hidden });
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
        warnings.extend(of_following(filter));
        warnings.extend(ambiguity.map(Warning::Ambiguous));
        if let Some(family) = filter.wrong_family() {
            warnings.push(Warning::WrongFamily { family, motion: filter.settings().model });
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

/// Names of the parameters of an estimate that are not stated.
fn unstated_of(estimate: &MotionEstimate) -> impl Iterator<Item = &'static str> {
    estimate.parameters().filter(|p| p.value.is_none()).map(|p| p.name)
}

/// What is to be said of how an object was followed: it is lost, it was begun anew, or many of its frames do not fit.
pub(super) fn of_following(filter: &MotionFilter) -> Vec<Warning> {
    let rejected = filter.frames_rejected();
    let frames = filter.frames_accepted() + rejected;
    let restarts = filter.restarts();
    let are_many = rejected as f64 > MANY_REJECTED * frames as f64;
    let unstated = match filter.unstated() {
        Some(Unstated::ManyRejected { rejected, frames }) => Some(Warning::TooManyRejected { rejected, frames }),
        _ => None,
    };
    let warnings = [
        (filter.phase() == Phase::Lost).then_some(Warning::Lost),
        unstated,
        (restarts > 0).then_some(Warning::Restarted { times: restarts }),
        are_many.then_some(Warning::FramesRejected { rejected, frames }),
    ];
    warnings.into_iter().flatten().collect()
}
