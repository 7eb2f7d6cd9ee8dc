use freeform_curve_fit::Outline;
use freeform_estimate::{MotionEstimate, PlaneEstimate};
use freeform_motion::{Pipeline, PipelineSettings};
use freeform_outline_filter::{FilterSettings, MotionFilter, PlaneFilter};
use freeform_riccati::{MotionModel, PinholeCamera};

use crate::ExperimentError;
use crate::baseline::{AreaMomentEstimator, RegistrationEstimator};

/// A method of identification that is evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Method {
    /// The motion filter, with its default settings.
    Filter,
    /// The paper's adaptive identifier, with its default settings.
    Adaptive,
    /// The baseline [`AreaMomentEstimator`].
    Moments,
    /// The baseline [`RegistrationEstimator`].
    Icp,
}

impl Method {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Filter, Self::Adaptive, Self::Moments, Self::Icp];

    /// The word that stands for it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Filter => "filter",
            Self::Adaptive => "adaptive",
            Self::Moments => "moments",
            Self::Icp => "icp",
        }
    }

    /// What it is, in a line.
    #[must_use]
    pub const fn description(self) -> &'static str {
        match self {
            Self::Filter => "The motion filter",
            Self::Adaptive => "The paper's adaptive identifier, which takes 10 to 20 s to settle",
            Self::Moments => "Baseline: area moments, then least squares on the exact flow",
            Self::Icp => "Baseline: iterated closest points to the first frame, then least squares on the exact flow",
        }
    }
}

/// A method at work on one sequence.
#[derive(Debug)]
pub(super) enum Estimator {
    Filter {
        filter: Box<MotionFilter>,
        /// What it held when it last held something: it holds nothing while it looks for the object again.
        last_known: Box<Option<MotionEstimate>>,
    },
    Plane {
        filter: Box<PlaneFilter>,
        last_known: Box<Option<PlaneEstimate>>,
    },
    Adaptive(Box<Pipeline>),
    Moments(Box<AreaMomentEstimator>),
    Registration(Box<RegistrationEstimator>),
}

impl Estimator {
    /// One that has seen nothing yet.
    pub(super) fn new(method: Method, model: MotionModel) -> Result<Self, ExperimentError> {
        Ok(match method {
            Method::Filter => {
                let filter = MotionFilter::new(FilterSettings { model, ..FilterSettings::default() })?;
                Self::Filter { filter: Box::new(filter), last_known: Box::default() }
            }
            Method::Adaptive => Self::Adaptive(Box::new(Pipeline::new(PipelineSettings::for_model(model))?)),
            Method::Moments => Self::Moments(Box::new(AreaMomentEstimator::new(model)?)),
            Method::Icp => Self::Registration(Box::new(RegistrationEstimator::new(model))),
        })
    }

    /// One of a plane in space that has seen nothing yet: the motion filter.
    pub(super) fn of_plane(method: Method, camera: PinholeCamera) -> Result<Self, ExperimentError> {
        if method != Method::Filter {
            return Err(ExperimentError::NoPlane { method });
        }
        let filter = PlaneFilter::new(camera, FilterSettings::default())?;
        Ok(Self::Plane { filter: Box::new(filter), last_known: Box::default() })
    }

    /// Takes the outline seen at a time in seconds; whether it was used.
    pub(super) fn push(&mut self, time: f64, outline: &Outline) -> bool {
        match self {
            Self::Filter { filter, last_known } => {
                let accepted = filter.step(time, outline).is_ok_and(|step| step.is_accepted());
                **last_known = filter.estimate().or(**last_known);
                accepted
            }
            Self::Plane { filter, last_known } => {
                let accepted = filter.step(time, outline).is_ok_and(|step| step.is_accepted());
                **last_known = filter.estimate().or(**last_known);
                accepted
            }
            Self::Adaptive(pipeline) => pipeline.push(time, outline).is_ok(),
            Self::Moments(estimator) => estimator.step(time, outline).unwrap_or(false),
            Self::Registration(estimator) => estimator.step(time, outline).unwrap_or(false),
        }
    }

    /// The motion, if any was found.
    pub(super) fn estimate(&self) -> Option<MotionEstimate> {
        match self {
            Self::Filter { last_known, .. } => **last_known,
            Self::Plane { .. } => None,
            Self::Adaptive(pipeline) => pipeline.estimate(),
            Self::Moments(estimator) => estimator.estimate(),
            Self::Registration(estimator) => estimator.estimate(),
        }
    }

    /// The motion of a plane in space, if any was found.
    pub(super) fn plane(&self) -> Option<PlaneEstimate> {
        match self {
            Self::Plane { last_known, .. } => **last_known,
            _ => None,
        }
    }
}
