//! A proposal taken.
use super::{gate::without_leverage, solve::Proposal};
use crate::{
    belief::Belief,
    measurement::{Frame, NoiseModel},
    prediction::ShapeNoise,
    vectors::vectorised,
};

/// Takes a proposal and the information of its frame, and what the frame says of the noise and of the shape.
pub(crate) fn commit(
    proposal: &Proposal,
    frame: &mut Frame,
    (belief, noise, shape): (&mut Belief, &mut NoiseModel, &mut ShapeNoise),
) {
    let k = belief.parameter_count();
    std::mem::swap(&mut belief.information.cells, &mut frame.cells);
    belief.information.dense = proposal.dense;
    belief.marginal = proposal.marginal;
    belief.pose = proposal.pose;
    (0..k).for_each(|i| belief.motion[i] += proposal.state[k + i]);
    belief.offsets.iter_mut().zip(&frame.shifts).for_each(|(offset, shift)| *offset += shift);
    // The buffer holds the cells as they were.
    shape.compare_innovations(belief, &frame.shifts, &frame.cells, noise);
    let units = 1.0 / (noise.sigma * noise.sigma);
    let (ratios, own) = (frame.deviations.ratios(), belief.information.cells.own());
    vectorised(
        #[inline(always)]
        || {
            for (i, m) in frame.measurements.iter().enumerate() {
                if m.weight > 0.0
                    && let Some(factor) = without_leverage(m, own[m.cell])
                {
                    let share = ratios.map_or(1.0, |ratios| (ratios[i] * ratios[i]).recip());
                    noise.take_residual(m.cell, m.residual * m.residual * units * factor * share, share);
                }
            }
        },
    );
}
