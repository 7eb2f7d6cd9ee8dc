//! A proposal taken.
use super::{gate::without_leverage, solve::Proposal};
use crate::{
    belief::Belief,
    measurement::{Frame, Measurement, NoiseModel},
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
    for (row, added) in belief.information.dense.iter_mut().zip(&proposal.added).take(k) {
        row.iter_mut().zip(added).for_each(|(entry, added)| *entry += added);
    }
    belief.marginal = proposal.marginal;
    belief.pose = proposal.pose;
    (0..k).for_each(|i| belief.motion[i] += proposal.state[k + i]);
    belief.offsets.iter_mut().zip(&frame.shifts).for_each(|(offset, shift)| *offset += shift);
    // The buffer holds the cells as they were.
    shape.compare_innovations(belief, &frame.shifts, &frame.cells, noise);
    let units = 1.0 / (noise.sigma * noise.sigma);
    let own = belief.information.cells.own();
    let measurements = &frame.measurements;
    match frame.deviations.ratios() {
        None => vectorised(
            #[inline(always)]
            || {
                for m in measurements {
                    take_residual(m, own, (units, 1.0), noise);
                }
            },
        ),
        Some(ratios) => {
            for (m, ratio) in measurements.iter().zip(ratios) {
                take_residual(m, own, (units, (ratio * ratio).recip()), noise);
            }
        }
    }
}

/// Takes what a point says of the noise of its cell, in units of the variance of good points; it counts for a share of one.
#[inline(always)]
fn take_residual(m: &Measurement, own: &[f64], (units, share): (f64, f64), noise: &mut NoiseModel) {
    if m.weight > 0.0
        && let Some(factor) = without_leverage(m, own[m.cell])
    {
        noise.take_residual(m.cell, m.residual * m.residual * units * factor * share, share);
    }
}
