//! A proposal committed.
use super::{gate::without_leverage, solve::Proposal};
use crate::{
    belief::Belief,
    measurement::{Frame, NoiseModel, PointOnCell},
    prediction::ShapeNoise,
    vectors::vectorised,
};

/// Replaces what is believed by a proposal with the information of its frame, and updates noise and shape by what the frame says of them.
pub(crate) fn commit(
    proposal: &Proposal,
    frame: &mut Frame,
    (belief, noise, shape): (&mut Belief, &mut NoiseModel, &mut ShapeNoise),
) {
    let k = belief.parameter_count();
    let cells_before = std::mem::replace(&mut belief.information.cells, std::mem::take(&mut frame.cells_with_frame));
    for (row, added) in belief.information.dense.iter_mut().zip(&proposal.added).take(k) {
        row.iter_mut().zip(added).for_each(|(entry, added)| *entry += added);
    }
    belief.marginal = proposal.marginal;
    belief.pose = proposal.pose;
    (0..k).for_each(|i| belief.motion[i] += proposal.state[k + i]);
    belief.offsets.iter_mut().zip(&frame.shifts).for_each(|(offset, shift)| *offset += shift);
    shape.compare_innovations(belief, &frame.shifts, &cells_before, noise, &mut frame.values);
    // Room for the next frame.
    frame.cells_with_frame = cells_before;
    let units = 1.0 / (noise.sigma * noise.sigma);
    let own = belief.information.cells.own();
    let points = frame.columns.points();
    match frame.deviations.ratios() {
        None => vectorised(
            #[inline(always)]
            || {
                for point in points.clone() {
                    add_residual(&point, own, (units, 1.0), noise);
                }
            },
        ),
        Some(ratios) => {
            for (point, ratio) in points.zip(ratios) {
                add_residual(&point, own, (units, (ratio * ratio).recip()), noise);
            }
        }
    }
}

/// Adds what a point says of the noise of its cell, in units of the variance of good points; it counts for a share of one.
#[inline(always)]
fn add_residual(m: &PointOnCell, own: &[f64], (units, share): (f64, f64), noise: &mut NoiseModel) {
    if m.weight > 0.0
        && let Some(factor) = without_leverage(m, own[m.cell])
    {
        noise.add_residual(m.cell, m.residual * m.residual * units * factor * share, share);
    }
}
