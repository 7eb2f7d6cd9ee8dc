//! Frames that are known to show something else.
use super::{Outcome, Track};
use crate::{
    belief::StateMatrix,
    measurement::Frame,
    update::{FrameMeasurement, Gate, PoseInnovation, Proposal, hold, with_hold},
};

impl Track {
    /// What the loaded outline, which shows something else, is off by in the present pose, as one linearisation tells it. The frame is not
    /// taken, whatever the gate says.
    pub(crate) fn glance(&self, frame: &mut Frame, gate: &Gate) -> Outcome {
        let view = self.view();
        let null = self.null_directions();
        let hold = hold(&self.belief, &self.map, &null);
        let measurement = match view.solve(frame, &null, hold.as_ref(), 1) {
            Ok(proposal) => {
                let variance = view.comparable_noise().powi(2) * self.noise.correlation();
                let innovation = self.innovation_of(&proposal, hold.as_ref(), variance).squared;
                view.judge(frame, &proposal, innovation, self.reference.radius)
            }
            Err(iterations) => FrameMeasurement::unsolved(iterations),
        };
        Outcome::unsolved(measurement, gate)
    }

    /// What a proposal has moved the pose by, which was solved for with what is held; `variance` is that of the noise.
    pub(super) fn innovation_of(
        &self,
        proposal: &Proposal,
        hold: Option<&StateMatrix>,
        variance: f64,
    ) -> PoseInnovation {
        let [before, after] = [&self.belief.marginal, &proposal.marginal].map(|marginal| with_hold(marginal, hold));
        self.belief.pose_innovation([&*before, &*after], &proposal.state, &self.map.centroid(), variance)
    }
}
