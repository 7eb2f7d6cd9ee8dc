//! One object of a plane in space, and what is known of it.
use freeform_curve_fit::Outline;
use freeform_estimate::PlaneEstimate;
use freeform_outline_filter::{Phase, PlaneFilter, PlaneUnknown, Unstated};
use freeform_riccati::PlaneMotion;

use super::step::{Step, of_following};
use crate::rejection::RejectionCause;
use crate::warning::Warning;

/// Mean square of the innovations, over what is expected, from which on a motion is said not to fit.
const DOES_NOT_FIT: f64 = 1.2;

/// A filter for a plane, and what it knew when it last knew something.
#[derive(Debug, Clone)]
pub(super) struct PlaneObject {
    pub(super) filter: PlaneFilter,
    /// The motion as it was last known.
    last_known: Option<PlaneEstimate>,
    /// Time in seconds of the last frame that was used while a motion was known.
    last_used: Option<f64>,
}

impl PlaneObject {
    pub(super) const fn new(filter: PlaneFilter) -> Self {
        Self { filter, last_known: None, last_used: None }
    }

    pub(super) fn push(&mut self, time: f64, outline: &Outline) -> Step {
        let step = match self.filter.step(time, outline) {
            Ok(step) => step,
            Err(error) => return Step { rejected_because: Some(RejectionCause::Filter(error)), ..Step::default() },
        };
        let estimate = self.filter.estimate().filter(|_| self.filter.follower().unstated().is_none());
        // A frame that is used says what is known by now; one that is not leaves that as it was.
        if step.is_accepted() {
            self.last_known = estimate.or(self.last_known.map(|known| unknown(&known)));
            self.last_used = estimate.map(|_| time).or(self.last_used);
        }
        Step {
            phase: Some(step.phase.into()),
            hidden: match self.filter.unknown() {
                Some(PlaneUnknown::HardlyMoves) => {
                    let parameters = estimate.iter().flat_map(PlaneEstimate::parameters);
                    parameters.filter(|p| p.value.is_none()).map(|p| p.name).collect()
                }
                _ => Vec::new(),
            },
            plane: estimate.map(Box::new),
            residual: step.measurement.and_then(|measurement| measurement.noise),
            innovation: step.measurement.map(|measurement| measurement.innovation),
            state: self.filter.follower().state(),
            plane_ambiguity: estimate.and_then(|_| self.filter.ambiguity()).map(Box::new),
            rejected_because: step.rejection.map(RejectionCause::NotAccepted),
            ..Step::default()
        }
    }

    /// The motion as it was last known.
    pub(super) fn estimate(&self) -> Option<PlaneEstimate> {
        let is_lost = self.filter.follower().phase() == Phase::Lost;
        let known = self.last_known.filter(|_| !self.is_unstated());
        known.map(|known| if is_lost { unknown(&known) } else { known })
    }

    fn is_unstated(&self) -> bool {
        matches!(self.filter.follower().unstated(), Some(Unstated::ManyRejected { .. }))
    }

    pub(super) fn warnings(&self) -> Vec<Warning> {
        let follower = self.filter.follower();
        let mut warnings = Vec::new();
        let ambiguity = self.filter.ambiguity();
        let ambiguous = ambiguity.as_ref().map_or(&[][..], |ambiguity| &ambiguity.parameters);
        if let Some(estimate) = self.estimate() {
            let unknown = estimate.parameters().filter(|p| p.value.is_none()).map(|p| p.name);
            let normal = estimate.normal().is_none().then_some("normal");
            let parameters: Vec<_> = unknown.chain(normal).filter(|name| !ambiguous.contains(name)).collect();
            match self.filter.unknown() {
                _ if parameters.is_empty() => {}
                Some(PlaneUnknown::HardlyMoves) => warnings.push(Warning::PlaneHardlyMoves { parameters }),
                _ => warnings.push(Warning::NotKnown { parameters }),
            }
        }
        warnings.extend(ambiguity.map(|ambiguity| Warning::TwoPlanes(Box::new(ambiguity))));
        let misfit = self.filter.misfit();
        if misfit > DOES_NOT_FIT {
            warnings.push(Warning::PlaneMisfit { excess: misfit });
        }
        warnings.extend(of_following(follower, self.last_used));
        warnings.sort_by_key(Warning::order);
        warnings
    }
}

/// An estimate of which nothing is known any more.
fn unknown(estimate: &PlaneEstimate) -> PlaneEstimate {
    PlaneEstimate::new(*estimate.motion(), *estimate.covariance(), [false; PlaneMotion::PARAMETERS])
}
