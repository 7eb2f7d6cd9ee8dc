//! The normal equations of a frame, added to the information, and the offsets eliminated from them.
use crate::{
    belief::{Arrowhead, StateVector},
    measurement::{Frame, Measurement},
};

/// Adds the measurements to the information; returns the right-hand side of pose and motion, and leaves those of the offsets in the frame.
/// `state` is the step that the residuals were taken after.
pub(crate) fn accumulate(frame: &mut Frame, work: &mut Arrowhead, state: &StateVector) -> StateVector {
    frame.right.clear();
    frame.right.resize(work.cells.len(), 0.0);
    match work.k {
        3 => accumulate_sized::<3, 6>(frame, work, state),
        4 => accumulate_sized::<4, 8>(frame, work, state),
        6 => accumulate_sized::<6, 12>(frame, work, state),
        _ => accumulate_sized::<8, 16>(frame, work, state),
    }
}

fn accumulate_sized<const K: usize, const S: usize>(
    frame: &mut Frame,
    work: &mut Arrowhead,
    state: &StateVector,
) -> StateVector {
    let (own, coupling) = work.cells.all_mut::<S>();
    let mut right = StateVector::zeros();
    let mut dense = [[0.0; K]; K];
    for Measurement { cell, residual, by_offset, jacobian, weight } in &frame.measurements {
        if *weight == 0.0 {
            continue;
        }
        let mut along = 0.0;
        (0..K).for_each(|i| along += jacobian[i] * state[i]);
        let target = residual + along + by_offset * frame.shifts[*cell];
        let row = &mut coupling[*cell];
        let weighted = weight * by_offset;
        for i in 0..K {
            let wi = weight * jacobian[i];
            for j in 0..K {
                dense[i][j] += wi * jacobian[j];
            }
            right[i] += wi * target;
            row[i] += weighted * jacobian[i];
        }
        own[*cell] += weighted * by_offset;
        frame.right[*cell] += weighted * target;
    }
    for (sum, row) in work.dense.iter_mut().zip(&dense) {
        sum.iter_mut().zip(row).for_each(|(s, d)| *s += d);
    }
    right
}

/// Right-hand side with the offsets eliminated.
pub(super) fn reduce(work: &Arrowhead, right_of_cells: &[f64], mut right: StateVector) -> StateVector {
    for ((coupling, own), r) in work.cells.couplings().zip(work.cells.own()).zip(right_of_cells) {
        if *own > 0.0 && *r != 0.0 {
            let factor = r / own;
            right.iter_mut().zip(coupling).for_each(|(right, coupling)| *right -= factor * coupling);
        }
    }
    right
}
