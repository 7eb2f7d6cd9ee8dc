//! Frames that are known to show something else.
use super::{Outcome, Track};
use crate::{
    belief::StateMatrix,
    measurement::Frame,
    tuning::update::{BEYOND_DOUBT, PARTLY_THERE},
    update::{Gate, Linearisations, PoseInnovation, Proposal, hold, with_hold},
};

impl Track {
    /// What the loaded outline is off by in the present pose, as one linearisation tells it, where that is so much that more of them would not
    /// bring it through the gate: a pose that has been searched for already they would change little, and an object that goes on as predicted is near
    /// it. The frame is not taken.
    pub(crate) fn rejected_at_a_glance(&self, frame: &mut Frame, gate: &Gate) -> Option<Outcome> {
        let view = self.view();
        let null = self.null_directions();
        let hold = hold(&self.belief, &self.map, &null);
        let proposal = view.solve(frame, &null, hold.as_ref(), Linearisations::Once).ok()?;
        let innovation = self.innovation_of(&proposal, hold.as_ref(), self.comparable_variance()).squared;
        let (measurement, _) = view.compare(frame, &proposal, innovation, self.reference.radius);
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

#[cfg(test)]
mod tests {
    use freeform_curve_fit::Outline;
    use freeform_riccati::MotionModel;
    use nalgebra::Point2;

    use super::*;
    use crate::{
        drawn_curves::{lobed, outline, polar},
        track::Comparison,
    };

    /// Points that wave about a curve with three lobes, shifted to the right.
    fn shown(lobe: f64, wave: f64, shift: f64) -> Outline {
        outline(400, |t| {
            let p = polar(lobed(t, &[(3.0, [lobe, 0.0]), (2.0, [0.0, 0.1]), (61.0, [0.0, wave])]), t);
            Point2::new(shift + p.x, 0.8 * p.y)
        })
    }

    #[test]
    fn a_glance_rejects_other_outlines_and_nothing_that_an_update_accepts() {
        let mut frame = Frame::default();
        let mut track = Track::begin(MotionModel::Rigid, &shown(0.25, 0.001, 0.0), 0.0, &mut frame).expect("a track");
        for _ in 0..10 {
            assert!(track.predict(0.1));
            frame.load(&shown(0.25, 0.001, 0.0), track.reference());
            let gate = Gate { smallest_agreement: 0.7, largest_innovation: None, largest_noise: None };
            assert!(track.update(&mut frame, &gate, Comparison::NotAsked).is_accepted());
        }
        let gate =
            Gate { smallest_agreement: 0.7, largest_innovation: None, largest_noise: Some(track.largest_noise()) };
        let (mut accepted, mut rejected_at_once) = (0, 0);
        for lobe in [0.25, 0.2499, 0.249, 0.24, 0.2, -0.1] {
            for wave in [0.001, 0.0015, 0.002, 0.1] {
                for shift in [0.0, 0.002, 0.1] {
                    frame.load(&shown(lobe, wave, shift), track.reference());
                    let glance = track.rejected_at_a_glance(&mut frame, &gate);
                    let update = track.clone().update(&mut frame, &gate, Comparison::NotAsked);
                    accepted += u32::from(update.is_accepted());
                    rejected_at_once += u32::from(glance.is_some());
                    let context = format!("{lobe} {wave} {shift}: {glance:?} {update:?}");
                    assert!(glance.is_none_or(|glance| !glance.is_accepted() && !update.is_accepted()), "{context}");
                }
            }
        }
        println!("{accepted} {rejected_at_once}");
        assert!(accepted >= 10 && rejected_at_once >= 40, "{accepted} {rejected_at_once}");
    }
}
