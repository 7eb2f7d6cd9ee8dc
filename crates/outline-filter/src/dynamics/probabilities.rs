//! What the probabilities of the hypotheses say of the motion.
use super::{course::Course, interacting::InteractingHypotheses, setting::DynamicsWeights};
use crate::tuning::dynamics as tuning;

impl<const N: usize> InteractingHypotheses<N> {
    /// Probabilities of the three kinds of dynamics.
    pub(crate) fn weights(&self) -> DynamicsWeights {
        let mut weights = DynamicsWeights { generator: 0.0, velocity: 0.0, accelerating: 0.0 };
        for (hypothesis, weight) in self.hypotheses.iter().zip(&self.weights) {
            match hypothesis.course {
                Course::ConstantGenerator | Course::Shaken { .. } => weights.generator += weight,
                Course::ConstantVelocity { .. } => weights.velocity += weight,
                Course::Accelerating { .. } | Course::ChangingGenerator { .. } | Course::SteadyChange { .. } => {
                    weights.accelerating += weight;
                }
            }
        }
        weights
    }

    /// Steps that the motion is known from: the fewest that a hypothesis remembers that is not ruled out, and no limit if all are constant.
    pub(crate) fn memory(&self) -> f64 {
        let possible =
            self.hypotheses.iter().zip(&self.weights).filter(|(_, weight)| **weight > tuning::OUTSIDE_INTERVAL);
        possible.map(|(hypothesis, _)| hypothesis.course.memory()).fold(f64::INFINITY, f64::min)
    }
}
