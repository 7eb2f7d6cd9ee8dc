//! A frame linearised and solved for pose, motion and offsets until the pose settles.
use std::f64::consts::PI;

use freeform_riccati::{MAX_PARAMETERS, ParameterMatrix, turn_rate};
use nalgebra::Matrix3;

use super::{
    hold::with_hold,
    normal_equations::{Added, reduce},
};
use crate::{
    belief::{Arrowhead, OffsetInformation, StateMatrix, StateVector, scaled_solution},
    map::NullDirection,
    measurement::{Frame, Jacobians, NO_CELL, Pass, View},
    tuning::update as tuning,
    vectors::{LANES, vectorised},
};

/// What a frame asks for: a step of pose and motion, and the information with the frame. That of the offsets is
/// [`Frame::cells_with_frame`], their corrections [`Frame::shifts`], until it is committed.
#[derive(Debug, Clone)]
pub(crate) struct Proposal {
    /// Step of pose and motion from what was predicted.
    pub(crate) state: StateVector,
    pub(crate) pose: Matrix3<f64>,
    /// Information on the pose that the frame has added, the outline given.
    pub(super) added: ParameterMatrix,
    /// Information on pose and motion with the frame, the offsets eliminated.
    pub(crate) marginal: StateMatrix,
    /// Right-hand side of pose and motion that the frame has added, the offsets not eliminated.
    pub(super) right: StateVector,
    /// Linearisations taken.
    pub(crate) iterations: usize,
    /// How far the last of them has moved points at most, normalised.
    pub(crate) last_step: f64,
}

/// How often a frame is linearised.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Linearisations {
    Once,
    /// Until the pose settles, or there have been [too many](tuning::MOST_ITERATIONS).
    UntilSettled,
}

impl View<'_> {
    /// Whether one more is taken. An object that lies far from where it was expected takes more of them to come there.
    fn goes_on(&self, linearisations: Linearisations, taken: usize, last_step: f64) -> bool {
        match linearisations {
            Linearisations::Once => taken < 1,
            Linearisations::UntilSettled if taken < tuning::MOST_ITERATIONS => true,
            Linearisations::UntilSettled => taken < tuning::MOST_FROM_FAR && last_step > self.moved_by(tuning::FAR),
        }
    }

    /// The step of a pose from which on its points are moved by so many cells, and beyond the noise. Infinite where few points tell the turn: the others
    /// stay where they are, however far it goes.
    pub(crate) fn moved_by(&self, cells: f64) -> f64 {
        if self.map.is_all_but_round() {
            return f64::INFINITY;
        }
        (cells * self.map.spacing()).max(tuning::BEYOND_NOISE * self.noise.sigma)
    }

    /// Linearises and solves until the pose settles; the number of linearisations where there is no solution. `null` are the null directions
    /// of the predicted pose, `hold` is information that is added for the solution only.
    pub(crate) fn solve(
        &self,
        frame: &mut Frame,
        null: &[NullDirection],
        hold: Option<&StateMatrix>,
        linearisations: Linearisations,
    ) -> Result<Proposal, usize> {
        let belief = self.belief;
        let (model, k) = (belief.model, belief.parameter_count());
        frame.clear_shifts(self.map.cells().len());
        let mut proposal = Proposal {
            state: StateVector::zeros(),
            pose: belief.pose,
            added: [[0.0; MAX_PARAMETERS]; MAX_PARAMETERS],
            marginal: belief.marginal,
            right: StateVector::zeros(),
            iterations: 0,
            last_step: 0.0,
        };
        // Those of the pose of the step before.
        let mut null_of_step = None;
        let mut work = Arrowhead::new(k);
        let mut settled = false;
        while !settled && self.goes_on(linearisations, proposal.iterations, proposal.last_step) {
            // A turn that is not seen is one about the centroid as the frame has it.
            if proposal.iterations > 0 && !null.is_empty() {
                null_of_step = Some(self.map.null_directions(model, &proposal.pose));
            }
            let null = null_of_step.as_deref().unwrap_or(null);
            let pass = if proposal.iterations == 0 { Pass::First } else { Pass::Again };
            self.measure_by_columns(frame, &proposal.pose, null, pass);
            self.leave_out_untold(frame, &proposal.pose, null);
            // The room that the frame has for them is used while its equations are set up.
            work.cells = std::mem::take(&mut frame.cells_with_frame);
            let Added { information: added, right } =
                frame.accumulate_onto(&belief.information, &mut work, &proposal.state);
            let marginal = work.marginal();
            let reduced = reduce(&work, &frame.right, right);
            let solution = scaled_solution(&with_hold(&marginal, hold), &reduced, k);
            let next = solution.filter(|next| next.iter().all(|e| e.is_finite()));
            if let Some(next) = next {
                frame.apply_step(&work.cells, &(next - proposal.state), &next, k);
            }
            frame.cells_with_frame = std::mem::take(&mut work.cells);
            let next = next.ok_or(proposal.iterations)?;
            let step = (0..k).map(|i| (next[i] - proposal.state[i]).abs()).fold(0.0, f64::max);
            let pose = model.flow(&next.as_slice()[..k], 1.0).into_inner() * belief.pose;
            // A turn by more than half a circle is a smaller one the other way, and no motion has made it: few of the points lie on cells that
            // anything is known of.
            let is_beyond_half_circle = turn_rate(&model.generator(&next.as_slice()[..k])).abs() > PI;
            if is_beyond_half_circle || pose.determinant().abs() < tuning::COLLAPSED || !self.map.is_shown_in(&pose) {
                return Err(proposal.iterations);
            }
            let iterations = proposal.iterations + 1;
            proposal = Proposal { state: next, pose, added, marginal, right, iterations, last_step: step };
            settled = step < tuning::SETTLED * self.noise.sigma;
        }
        Ok(proposal)
    }
}

impl Frame {
    /// Offsets that go with a solution for pose and motion, and what it leaves of the residuals.
    fn apply_step(&mut self, cells: &OffsetInformation, step: &StateVector, state: &StateVector, k: usize) {
        match k {
            3 => self.apply_step_sized::<3, 6>(cells, step, state),
            4 => self.apply_step_sized::<4, 8>(cells, step, state),
            6 => self.apply_step_sized::<6, 12>(cells, step, state),
            _ => self.apply_step_sized::<8, 16>(cells, step, state),
        }
    }

    fn apply_step_sized<const K: usize, const S: usize>(
        &mut self,
        cells: &OffsetInformation,
        step: &StateVector,
        state: &StateVector,
    ) {
        let step: [f64; K] = std::array::from_fn(|i| step[i]);
        let state: [f64; S] = std::array::from_fn(|i| state[i]);
        let mut by_cell = std::mem::take(&mut self.values);
        by_cell.resize(self.shifts.len(), 0.0);
        let (shifts, right, values) = (self.shifts.as_mut_slice(), self.right.as_slice(), by_cell.as_mut_slice());
        vectorised(
            #[inline(always)]
            || {
                let of_cells = cells.own().iter().zip(cells.rows::<S>()).zip(right);
                for ((shift, value), ((own, coupling), right)) in shifts.iter_mut().zip(values.iter_mut()).zip(of_cells)
                {
                    let mut along = [0.0; LANES];
                    for i in 0..S {
                        along[i % LANES] += coupling[i] * state[i];
                    }
                    let along = (along[0] + along[1]) + (along[2] + along[3]);
                    let moved = if *own > 0.0 { (right - along) / own } else { *shift };
                    *value = moved - *shift;
                    *shift = moved;
                }
            },
        );
        match self.columns.jacobians {
            Jacobians::OfPoints => self.move_residuals_of_points(&step, &by_cell),
            Jacobians::OfCells => self.move_residuals_of_cells(&step, &by_cell),
        }
        self.values = by_cell;
    }

    /// Moves the residuals by a step of the pose and one of the offset of each cell.
    pub(super) fn move_residuals_of_points<const K: usize>(&mut self, step: &[f64; K], by_cell: &[f64]) {
        let Self { measurements, columns, .. } = self;
        vectorised(
            #[inline(always)]
            || {
                for (measurement, residual) in measurements.iter_mut().zip(&mut columns.residuals) {
                    if measurement.cell != NO_CELL {
                        let mut along = measurement.by_offset * by_cell[measurement.cell];
                        for (slope, step) in measurement.jacobian.iter().zip(step) {
                            along += slope * step;
                        }
                        measurement.residual -= along;
                        *residual = measurement.residual;
                    }
                }
            },
        );
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::{
        dense_filter::{AGREES, DenseFilter, Problem, random_measurements},
        measurement::NoiseModel,
        prediction::ShapeNoise,
        update::{accumulate, commit},
    };

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn a_linear_update_is_that_of_the_dense_filter(mut problem in Problem::any()) {
            let (k, cells) = (problem.belief.parameter_count(), problem.belief.offsets.len());
            let belief = &mut problem.belief;
            let mut dense = DenseFilter::of(&belief.information);
            let measurements = random_measurements(&mut problem.rng, k, 0..cells, 3 * cells);
            measurements.iter().for_each(|m| dense.measure(m));

            let mut frame = Frame::of_measurements(measurements, cells);
            let mut work = belief.information.clone();
            let Added { information: added, right } = accumulate(&mut frame, &mut work, &StateVector::zeros());
            let reduced = reduce(&work, &frame.right, right);
            let state = scaled_solution(&work.marginal(), &reduced, k).expect("a solution");
            frame.apply_step(&work.cells, &state, &state, k);
            frame.cells_with_frame.copy_from(&work.cells);
            let marginal = work.marginal();
            let proposal = Proposal {
                state,
                pose: belief.pose,
                added,
                marginal,
                right,
                iterations: 1,
                last_step: 0.0,
            };
            let (motion, offsets) = (belief.motion, belief.offsets.clone());
            let (mut noise, mut shape) = (NoiseModel::new(1.0), ShapeNoise::default());
            noise.resize(cells);
            shape.resize(cells);
            commit(&proposal, &mut frame, (belief, &mut noise, &mut shape));

            let difference = dense.difference(&belief.information, |_, _| true);
            prop_assert!(difference < AGREES, "{difference}");
            let difference = dense.difference_of_marginal(&belief.marginal);
            prop_assert!(difference < AGREES, "marginal {difference}");
            let size = dense.mean.amax();
            let pose = (0..k).map(|i| state[i]);
            let moved = pose.chain((0..k).map(|i| belief.motion[i] - motion[i]));
            let moved = moved.chain(belief.offsets.iter().zip(&offsets).map(|(after, before)| after - before));
            for (found, expected) in moved.zip(dense.mean.iter()) {
                prop_assert!((found - expected).abs() < AGREES * size, "{found} {expected}");
            }
        }

        /// Measurements are the same whichever step their residuals were taken after.
        #[test]
        fn a_second_linearisation_at_the_same_place_changes_nothing(mut problem in Problem::any()) {
            let (k, cells) = (problem.belief.parameter_count(), problem.belief.offsets.len());
            let measurements = random_measurements(&mut problem.rng, k, 0..cells, 3 * cells);
            let mut frame = Frame::of_measurements(measurements, cells);
            let mut state = StateVector::zeros();
            let mut steps = Vec::new();
            for _ in 0..2 {
                let mut work = problem.belief.information.clone();
                let Added { right, .. } = accumulate(&mut frame, &mut work, &state);
                let reduced = reduce(&work, &frame.right, right);
                let next = scaled_solution(&work.marginal(), &reduced, k).expect("a solution");
                frame.apply_step(&work.cells, &(next - state), &next, k);
                steps.push((next - state).amax());
                state = next;
            }
            prop_assert!(steps[1] < AGREES * steps[0], "{steps:?}");
        }
    }
}
