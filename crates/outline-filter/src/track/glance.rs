//! Frames that are known to show something else.
use super::{Outcome, Track};
use crate::{
    belief::StateMatrix,
    measurement::Frame,
    tuning::update::{BEYOND_DOUBT, PARTLY_THERE},
    update::{Gate, PoseInnovation, Proposal, hold, with_hold},
};

impl Track {
    /// What the loaded outline is off by in the present pose, as one linearisation tells it, where that is so much that more of them would not
    /// bring it through the gate. The frame is not taken.
    pub(crate) fn glance(&self, frame: &mut Frame, gate: &Gate) -> Option<Outcome> {
        let view = self.view();
        let null = self.null_directions();
        let hold = hold(&self.belief, &self.map, &null);
        let proposal = view.solve(frame, &null, hold.as_ref(), 1).ok()?;
        let variance = view.comparable_noise().powi(2) * self.noise.correlation();
        let innovation = self.innovation_of(&proposal, hold.as_ref(), variance).squared;
        let measurement = view.judge(frame, &proposal, innovation, self.reference.radius);
        let wide = Gate {
            smallest_agreement: PARTLY_THERE * gate.smallest_agreement,
            largest_innovation: None,
            largest_noise: gate.largest_noise.map(|largest| BEYOND_DOUBT * largest),
        };
        self.verdict(&wide, &measurement).is_err().then(|| Outcome::unsolved(measurement, gate))
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
