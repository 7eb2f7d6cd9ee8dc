//! The identifier of one object, whichever method it is.
use std::sync::Arc;

use freeform_curve_fit::Outline;
use freeform_estimate::{ExpectedState, MotionEstimate, PlaneEstimate, PointVelocity};
use freeform_outline_filter::{Ambiguity, DynamicsWeights, KnownOutline, MotionFilter, PlaneAmbiguity, PlaneFilter};
use nalgebra::DMatrix;

#[cfg(feature = "serde")]
use super::resting::{RestingError, RestingFilter, StateFile};
use super::{
    filtered_object::FilteredObject,
    observation::ObjectPhase,
    plane_object::PlaneObject,
    settings::{MethodSettings, TrackerError},
    step::{Step, unstated_of},
};
use crate::rejection::RejectionCause;
use crate::warning::Warning;
use crate::{Pipeline, PipelineSettings};

/// What is known of one object. All that have seen nothing yet share what they begin with, as many may wait for their first frame at once.
/// While one rests in a file it takes no frames, and only how often it was begun anew and whether its motion changed can be asked for.
#[derive(Debug, Clone)]
pub(super) enum Identifier {
    /// The paper's identifier on the lines of fitted curves.
    Adaptive(Arc<Pipeline>),
    /// The motion filter on the points of the outlines.
    Filter(Arc<FilteredObject>),
    /// The motion filter, and all frames together for the motion in space.
    Plane(Arc<PlaneObject>),
    /// A motion filter whose state is in a file.
    #[cfg(feature = "serde")]
    Resting(Arc<RestingFilter>),
}

impl Identifier {
    /// One that has seen nothing yet.
    pub(super) fn new(settings: &MethodSettings) -> Result<Self, TrackerError> {
        Ok(match settings {
            MethodSettings::Adaptive(settings) => {
                Self::Adaptive(Arc::new(Pipeline::new(PipelineSettings::clone(settings))?))
            }
            MethodSettings::Filter(settings) => {
                Self::Filter(Arc::new(FilteredObject { filter: MotionFilter::new(*settings)?, last_known: None }))
            }
            MethodSettings::Plane(camera, settings) => {
                Self::Plane(Arc::new(PlaneObject::new(PlaneFilter::new(*camera, *settings)?)))
            }
        })
    }

    /// Takes the outline seen at a time in seconds.
    pub(super) fn push(&mut self, time: f64, outline: &Outline) -> Step {
        match self {
            Self::Adaptive(pipeline) => match Arc::make_mut(pipeline).push(time, outline) {
                Ok(result) => {
                    let phase = if result.estimate.is_some() { ObjectPhase::Adapt } else { ObjectPhase::Start };
                    let residual = Some(result.fit.diagnostics().geometric_residual);
                    let (estimate, fit, progress) = (result.estimate, Some(result.fit), result.progress);
                    let hidden = estimate.as_ref().map_or_else(Vec::new, |estimate| unstated_of(estimate).collect());
                    Step { phase: Some(phase), estimate, hidden, fit, progress, residual, ..Step::default() }
                }
                Err(error) => Step { rejected_because: Some(RejectionCause::Pipeline(error)), ..Step::default() },
            },
            Self::Filter(object) => Arc::make_mut(object).push(time, outline),
            Self::Plane(object) => Arc::make_mut(object).push(time, outline),
            #[cfg(feature = "serde")]
            Self::Resting(_) => Step::default(),
        }
    }

    /// What is expected of the object at a time in seconds.
    pub(super) fn expected_state(&self, time: f64) -> Option<ExpectedState> {
        match self {
            Self::Filter(object) => object.filter.expected_state(time),
            _ => None,
        }
    }

    /// Does a part of the work that waits for the next outline, if there is any; whether more is waiting.
    pub(super) fn prepare(&mut self) -> bool {
        match self {
            Self::Filter(object) => Arc::make_mut(object).filter.prepare(),
            Self::Plane(object) => Arc::make_mut(object).filter.prepare(),
            Self::Adaptive(_) => false,
            #[cfg(feature = "serde")]
            Self::Resting(_) => false,
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
            Self::Resting(state) => Ok(Some(Self::Filter(Arc::new(state.read()?)))),
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

    /// Whether the outlines do not show the velocity of the middle.
    pub(super) fn hides_velocity(&self) -> bool {
        match self {
            Self::Filter(object) => object.filter.hides_velocity(),
            _ => false,
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
