//! The normal equations of a frame, added to the information, and the offsets eliminated from them.
use freeform_riccati::{MAX_PARAMETERS, ParameterMatrix};

use crate::{
    belief::{Arrowhead, STATE, StateVector},
    measurement::{Frame, Jacobians, Measurement},
    vectors::vectorised,
};

/// What a frame adds to pose and motion, the offsets not eliminated.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Added {
    /// Information on the pose.
    pub(super) information: ParameterMatrix,
    /// Right-hand side of pose and motion.
    pub(super) right: StateVector,
}

impl Frame {
    /// Sets the information to what was known of pose, motion and offsets, and adds the measured points to it; as [`accumulate`].
    pub(super) fn accumulate_onto(&mut self, known: &Arrowhead, work: &mut Arrowhead, state: &StateVector) -> Added {
        work.dense = known.dense;
        match self.columns.jacobians {
            Jacobians::OfPoints => {
                work.cells.copy_from(&known.cells);
                accumulate(self, work, state)
            }
            Jacobians::OfCells => self.accumulate_cells(&known.cells, work, state),
        }
    }
}

/// Adds the measurements to the information; returns what they add to pose and motion, and leaves the right-hand sides of the offsets in the
/// frame. `state` is the step that the residuals were taken after.
pub(crate) fn accumulate(frame: &mut Frame, work: &mut Arrowhead, state: &StateVector) -> Added {
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
) -> Added {
    let step: [f64; K] = std::array::from_fn(|i| state[i]);
    let (own, coupling) = work.cells.all_mut::<S>();
    let Frame { measurements, shifts, right, .. } = frame;
    let of_points = (measurements.as_slice(), shifts.as_slice());
    let (dense, of_state) = vectorised(
        #[inline(always)]
        || add_points::<K, S>(of_points, &step, (&mut *own, &mut *coupling), right),
    );
    Added::to(&mut work.dense, &dense, &of_state)
}

impl Added {
    /// Added to what is known of pose and motion.
    pub(super) fn to<const K: usize>(
        known: &mut [[f64; STATE]; STATE],
        information: &[[f64; K]; K],
        right: &[f64; K],
    ) -> Self {
        let mut added = Self { information: [[0.0; MAX_PARAMETERS]; MAX_PARAMETERS], right: StateVector::zeros() };
        for i in 0..K {
            added.information[i][..K].copy_from_slice(&information[i]);
            added.right[i] = right[i];
            known[i].iter_mut().zip(&information[i]).for_each(|(sum, entry)| *sum += entry);
        }
        added
    }
}

/// Adds points to the information on their cells and to its right-hand sides; returns what they add to pose and motion.
#[inline(always)]
fn add_points<const K: usize, const S: usize>(
    (measurements, shifts): (&[Measurement], &[f64]),
    step: &[f64; K],
    (own, coupling): (&mut [f64], &mut [[f64; S]]),
    right_of_cells: &mut [f64],
) -> ([[f64; K]; K], [f64; K]) {
    let mut right = [0.0; K];
    let mut dense = [[0.0; K]; K];
    // All of the same length, which a number is compared with once.
    let cells = own.len();
    let (coupling, shifts, right_of_cells) = (&mut coupling[..cells], &shifts[..cells], &mut right_of_cells[..cells]);
    // Short rows are summed from their diagonal on, long ones as whole vectors.
    let first = |i: usize| if K < 6 { i } else { 0 };
    for Measurement { cell, residual, by_offset, jacobian, weight } in measurements {
        if *weight == 0.0 {
            continue;
        }
        let mut target = residual + by_offset * shifts[*cell];
        for i in 0..K {
            target += jacobian[i] * step[i];
        }
        let row = &mut coupling[*cell];
        let weighted = weight * by_offset;
        for i in 0..K {
            let wi = weight * jacobian[i];
            for j in first(i)..K {
                dense[i][j] += wi * jacobian[j];
            }
            right[i] += wi * target;
            row[i] += weighted * jacobian[i];
        }
        own[*cell] += weighted * by_offset;
        right_of_cells[*cell] += weighted * target;
    }
    // What has not been summed is in the other half.
    let dense = std::array::from_fn(|i| std::array::from_fn(|j| if j < first(i) { dense[j][i] } else { dense[i][j] }));
    (dense, right)
}

/// Right-hand side with the offsets eliminated.
pub(super) fn reduce(work: &Arrowhead, right_of_cells: &[f64], right: StateVector) -> StateVector {
    match work.k {
        3 => reduce_sized::<6>(work, right_of_cells, right),
        4 => reduce_sized::<8>(work, right_of_cells, right),
        6 => reduce_sized::<12>(work, right_of_cells, right),
        _ => reduce_sized::<16>(work, right_of_cells, right),
    }
}

fn reduce_sized<const S: usize>(work: &Arrowhead, right_of_cells: &[f64], mut right: StateVector) -> StateVector {
    let taken = vectorised(
        #[inline(always)]
        || {
            let mut taken = [0.0; S];
            for ((coupling, own), r) in work.cells.rows::<S>().iter().zip(work.cells.own()).zip(right_of_cells) {
                // Nothing is told where nothing is known.
                let factor = if *own > 0.0 { r / own } else { 0.0 };
                for i in 0..S {
                    taken[i] += factor * coupling[i];
                }
            }
            taken
        },
    );
    right.iter_mut().zip(taken).for_each(|(right, taken)| *right -= taken);
    right
}
