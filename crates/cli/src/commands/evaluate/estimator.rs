use freeform_experiments::baseline::{AreaMomentEstimator, RegistrationEstimator};
use freeform_motion::curve_fit::Outline;
use freeform_motion::estimate::MotionEstimate;
use freeform_motion::riccati::MotionModel;

use crate::args::{EvaluatedMethod, IdentifyMethod, MotionChoice, TrackOptions};
use crate::failure::Failure;
use crate::identifier::Identifier;

/// A method at work on one sequence.
#[derive(Debug)]
pub(super) enum Estimator {
    Identifier(Identifier),
    Moments(Box<AreaMomentEstimator>),
    Registration(Box<RegistrationEstimator>),
}

impl Estimator {
    /// One that has seen nothing yet.
    pub(super) fn new(method: EvaluatedMethod, model: MotionModel) -> Result<Self, Failure> {
        let identifier = |method| {
            let motion = match model {
                MotionModel::Rigid => MotionChoice::Rigid,
                MotionModel::Similarity => MotionChoice::Similarity,
                _ => MotionChoice::Affine,
            };
            Identifier::new(&TrackOptions { motion, method, degree: None, scale: None }).map(Self::Identifier)
        };
        match method {
            EvaluatedMethod::Filter => identifier(IdentifyMethod::Filter),
            EvaluatedMethod::Adaptive => identifier(IdentifyMethod::Adaptive),
            EvaluatedMethod::Moments => {
                let estimator = AreaMomentEstimator::new(model).map_err(Failure::unusable)?;
                Ok(Self::Moments(Box::new(estimator)))
            }
            EvaluatedMethod::Icp => Ok(Self::Registration(Box::new(RegistrationEstimator::new(model)))),
        }
    }

    /// Takes the outline seen at a time in seconds; whether it was used.
    pub(super) fn push(&mut self, time: f64, outline: &Outline) -> bool {
        match self {
            Self::Identifier(identifier) => identifier.push(time, outline).rejected_because.is_none(),
            Self::Moments(estimator) => estimator.step(time, outline).unwrap_or(false),
            Self::Registration(estimator) => estimator.step(time, outline).unwrap_or(false),
        }
    }

    /// The motion, if any was found.
    pub(super) fn estimate(&self) -> Option<MotionEstimate> {
        match self {
            Self::Identifier(identifier) => identifier.estimate(),
            Self::Moments(estimator) => estimator.estimate(),
            Self::Registration(estimator) => estimator.estimate(),
        }
    }
}
