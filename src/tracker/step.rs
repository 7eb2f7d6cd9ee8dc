//! What became of one frame of an object, and what is to be said of how it was followed.
use freeform_curve_fit::Fit;
use freeform_estimate::{MotionEstimate, MotionState, PlaneEstimate, PointVelocity};
use freeform_outline_filter::{Ambiguity, MotionFilter, Phase, PlaneAmbiguity, Unstated};

use super::observation::ObjectPhase;
use crate::AdaptiveProgress;
use crate::rejection::{RejectionCause, are_many_rejected};
use crate::warning::Warning;

/// What became of one frame.
#[derive(Debug, Default)]
pub(super) struct Step {
    pub(super) phase: Option<ObjectPhase>,
    pub(super) estimate: Option<MotionEstimate>,
    pub(super) hidden: Vec<&'static str>,
    pub(super) velocity: Option<PointVelocity>,
    pub(super) hides_velocity: bool,
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

/// Names of the parameters of an estimate that are not stated.
pub(super) fn unstated_of(estimate: &MotionEstimate) -> impl Iterator<Item = &'static str> {
    estimate.parameters().filter(|p| p.value.is_none()).map(|p| p.name)
}

/// What is to be said of how an object was followed: it is lost, with the time in seconds until which it was followed, it was begun anew, or many of
/// its frames do not fit.
pub(super) fn of_following(filter: &MotionFilter, last_known: Option<f64>) -> Vec<Warning> {
    let rejected = filter.frames_rejected();
    let frames = filter.frames_accepted() + rejected;
    let restarts = filter.restarts();
    let unstated = match filter.unstated() {
        Some(Unstated::ManyRejected { rejected, frames }) => Some(Warning::TooManyRejected { rejected, frames }),
        _ => None,
    };
    let warnings = [
        (filter.phase() == Phase::Lost).then_some(Warning::Lost { last_known }),
        unstated,
        (restarts > 0).then_some(Warning::Restarted { times: restarts }),
        are_many_rejected(rejected, frames).then_some(Warning::FramesRejected { rejected, frames }),
    ];
    // What stands in front of an object says so by its edges.
    let part = filter.disagreeing_part().filter(|_| filter.standing_edges().len() == 0);
    let part = part.map(|share| Warning::PartDisagrees { share });
    let edges = filter.standing_edges().chain(filter.former_edges()).map(Warning::StandingEdge);
    edges.chain(part).chain(warnings.into_iter().flatten()).collect()
}
