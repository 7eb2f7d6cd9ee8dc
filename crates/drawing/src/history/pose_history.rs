//! Where an object was over time, kept for figures.
use std::f64::consts::TAU;

use freeform_motion::estimate::{MotionEstimate, MotionState};
use freeform_motion::riccati::ParameterKind;
use freeform_motion::tracker::Observation;

use super::thinned::{Kept, Thinned};

/// Most poses kept of an object: about two for each pixel of a figure.
const MOST_KEPT: usize = 1000;

/// Where an object was over time.
#[derive(Debug, Default)]
pub(crate) struct PoseHistory {
    samples: Thinned<PoseSample>,
    segment: usize,
    last_angle: f64,
}

/// Where an object was at one time.
#[derive(Debug)]
pub(crate) struct PoseSample {
    /// In seconds.
    pub(crate) time: f64,
    /// Value and standard deviation of every parameter of the pose, where it is stated; angles are continuous over time.
    pub(crate) parameters: Vec<Option<[f64; 2]>>,
}

impl PoseHistory {
    /// The poses kept, in order.
    pub(crate) fn samples(&self) -> &[Kept<PoseSample>] {
        self.samples.kept()
    }

    /// Adds what a frame says.
    pub(crate) fn take(&mut self, observation: &Observation) {
        // Poses of different segments are relative to different outlines.
        if observation.segment != self.segment {
            self.segment = observation.segment;
            self.last_angle = 0.0;
            self.samples.break_off();
        }
        let Some(state) = present_state(observation) else { return self.samples.skip() };
        let shows_turn = observation.estimate.as_ref().is_some_and(shows_turn);
        let mut parameters = Vec::new();
        for parameter in state.pose_parameters() {
            let mut value = parameter.value;
            if parameter.name == "angle" && value.is_finite() {
                value += TAU * ((self.last_angle - value) / TAU).round();
                self.last_angle = value;
            }
            let is_stated = shows_turn && value.is_finite() || matches!(parameter.name, "x" | "y");
            parameters.push(is_stated.then_some([value, parameter.standard_deviation]));
        }
        self.samples.push(PoseSample { time: state.time(), parameters });
        if self.samples.kept().len() > MOST_KEPT {
            self.samples.halve();
        }
    }
}

/// The state at the time of the frame; none where it is only that at which a lost object was seen last.
pub(crate) fn present_state(observation: &Observation) -> Option<&MotionState> {
    observation.state.as_ref().filter(|state| observation.time == Some(state.time()))
}

/// Whether all but the velocity of the origin is stated, without which the turn of the object is not known either.
fn shows_turn(estimate: &MotionEstimate) -> bool {
    let kinds = estimate.model().parameter_kinds().iter();
    kinds.zip(estimate.parameters()).all(|(kind, p)| *kind == ParameterKind::Velocity || p.value.is_some())
}
