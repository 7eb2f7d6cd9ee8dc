//! A frame linearised and solved for pose, motion and offsets until the pose settles.
use nalgebra::Matrix3;

use super::{
    hold::with_hold,
    normal_equations::{accumulate, reduce},
};
use crate::{
    belief::{Arrowhead, CellInformation, STATE, StateMatrix, StateVector, scaled_solution},
    map::NullDirection,
    measurement::{Frame, NO_CELL, Pass, View},
    tuning::update as tuning,
};

/// What a frame asks for: a step of pose and motion, and the information with the frame. That of the offsets, and their corrections, are in
/// the buffers of the frame until it is committed.
#[derive(Debug, Clone)]
pub(crate) struct Proposal {
    /// Step of pose and motion from what was predicted.
    pub(crate) state: StateVector,
    pub(crate) pose: Matrix3<f64>,
    /// Information on pose and motion with the frame, the outline given.
    pub(crate) dense: [[f64; STATE]; STATE],
    /// Information on pose and motion with the frame, the offsets eliminated.
    pub(crate) marginal: StateMatrix,
    /// Linearisations taken.
    pub(crate) iterations: usize,
}

impl View<'_> {
    /// Linearises and solves until the pose settles; the number of linearisations where there is no solution. `null` are the null directions
    /// of the predicted pose, `hold` is information that is added for the solution only.
    pub(crate) fn solve(
        &self,
        frame: &mut Frame,
        null: &[NullDirection],
        hold: Option<&StateMatrix>,
    ) -> Result<Proposal, usize> {
        let belief = self.belief;
        let (model, k) = (belief.model, belief.parameter_count());
        frame.clear_shifts(self.map.cells().len());
        let mut proposal = Proposal {
            state: StateVector::zeros(),
            pose: belief.pose,
            dense: belief.information.dense,
            marginal: belief.marginal,
            iterations: 0,
        };
        let mut null = null.to_vec();
        let mut work = Arrowhead::new(k);
        let mut settled = false;
        while proposal.iterations < tuning::MOST_ITERATIONS && !settled {
            // A turn that is not seen is one about the middle as the frame has it.
            if proposal.iterations > 0 && !null.is_empty() {
                null = self.map.null_directions(model, &proposal.pose);
            }
            let pass = if proposal.iterations == 0 { Pass::First } else { Pass::Again };
            self.measure(frame, &proposal.pose, &null, pass);
            frame.cells.clone_from(&belief.information.cells);
            std::mem::swap(&mut work.cells, &mut frame.cells);
            work.dense = belief.information.dense;
            let right = accumulate(frame, &mut work, &proposal.state);
            let marginal = work.marginal();
            let reduced = reduce(&work, &frame.right, right);
            let solution = scaled_solution(&with_hold(&marginal, hold), &reduced, k);
            let next = solution.filter(|next| next.iter().all(|e| e.is_finite()));
            if let Some(next) = next {
                frame.take_step(&work.cells, &(next - proposal.state), &next, k);
            }
            std::mem::swap(&mut work.cells, &mut frame.cells);
            let next = next.ok_or(proposal.iterations)?;
            let step = (0..k).map(|i| (next[i] - proposal.state[i]).abs()).fold(0.0, f64::max);
            let pose = model.flow(&next.as_slice()[..k], 1.0).into_inner() * belief.pose;
            if !pose.iter().all(|e| e.is_finite()) || pose.determinant().abs() < tuning::COLLAPSED {
                return Err(proposal.iterations);
            }
            let iterations = proposal.iterations + 1;
            proposal = Proposal { state: next, pose, dense: work.dense, marginal, iterations };
            settled = step < tuning::SETTLED * self.noise.sigma;
        }
        Ok(proposal)
    }
}

impl Frame {
    /// Offsets that go with a solution for pose and motion, and what it leaves of the residuals.
    fn take_step(&mut self, cells: &[CellInformation], step: &StateVector, state: &StateVector, k: usize) {
        self.values.clear();
        for ((shift, cell), right) in self.shifts.iter_mut().zip(cells).zip(&self.right) {
            let before = *shift;
            if cell.own > 0.0 {
                let along: f64 = (0..2 * k).map(|i| cell.coupling[i] * state[i]).sum();
                *shift = (right - along) / cell.own;
            }
            self.values.push(*shift - before);
        }
        for measurement in self.measurements.iter_mut().filter(|m| m.cell != NO_CELL) {
            let along: f64 = (0..k).map(|i| measurement.jacobian[i] * step[i]).sum();
            measurement.residual -= along + measurement.by_offset * self.values[measurement.cell];
        }
    }
}
