//! A proposal committed.
use super::{
    gate::{NONE, without_leverage},
    solve::Proposal,
};
use crate::{
    belief::Belief,
    measurement::{Counted, Frame, NoiseModel, PointOnCell},
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
    let of_noise = (noise.sigma, noise.counted == Counted::Alike);
    shape.compare_innovations(belief, &frame.shifts, &cells_before, of_noise, &mut frame.values);
    // Room for the next frame.
    frame.cells_with_frame = cells_before;
    let own = belief.information.cells.own();
    add_residuals(frame, own, noise);
}

/// Adds what the points say of the noise of their cells, of which `own` is known, in units of the variance of good points.
fn add_residuals(frame: &mut Frame, own: &[f64], noise: &mut NoiseModel) {
    let units = 1.0 / (noise.sigma * noise.sigma);
    let Frame { columns, values, deviations, .. } = frame;
    let points = columns.points();
    if let Some(ratios) = deviations.ratios() {
        for (point, ratio) in points.zip(ratios) {
            let share = (ratio * ratio).recip();
            let square = square_told(&point, own.get(point.cell).copied().unwrap_or(NONE), units);
            if square != NONE {
                noise.add_residual(point.cell, square * share, share);
            }
        }
        return;
    }
    values.resize(columns.len(), 0.0);
    let squares = values.as_mut_slice();
    vectorised(
        #[inline(always)]
        || {
            // What lies anywhere is looked up first: the quotients after that are taken in vectors.
            for (square, number) in squares.iter_mut().zip(&columns.numbers) {
                *square = own.get(*number as usize).copied().unwrap_or(NONE);
            }
            for (square, point) in squares.iter_mut().zip(points.clone()) {
                *square = square_told(&point, *square, units);
            }
            for (square, number) in squares.iter().zip(&columns.numbers) {
                if *square != NONE {
                    noise.add_residual(*number as usize, *square, 1.0);
                }
            }
        },
    );
}

/// The squared residual of a point, in some units and without its own share of the information `own` on its cell; [`NONE`] where it tells nothing.
#[inline(always)]
fn square_told(point: &PointOnCell, own: f64, units: f64) -> f64 {
    let (factor, is_told) = without_leverage(point.weight, point.by_offset, own);
    let square = point.residual * point.residual * units * factor;
    if is_told { square } else { NONE }
}
