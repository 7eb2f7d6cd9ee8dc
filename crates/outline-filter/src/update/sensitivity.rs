//! Motions that the model leaves out, carried along with the filter: how far a unit of each moves its estimates, and what a frame says of
//! them (A. S. Willsky and H. L. Jones, A generalized likelihood ratio approach to the detection and estimation of jumps in linear
//! systems, 1976).
//!
//! Pose and outline are learnt from frames that show the same errors of the model, and take them in. What is left in the residuals of a
//! frame is the displacement by a unit of the motion, less what pose and outline have taken in before. It is taken to be the same over a
//! cell: how residuals vary within one is a matter of how the outline bends.
use nalgebra::{Matrix3, SMatrix};

use super::{
    pose_measurement::PoseMeasurement,
    unmodelled_displacement::{Instant, UNMODELLED, UnmodelledVector},
    unmodelled_score::{OfCell, Sums, UnmodelledScore},
};
use crate::{
    belief::{Belief, OffsetInformation, STATE, StateMatrix, scaled_solution},
    map::{Cell, OutlineMap},
    measurement::Frame,
    prediction::ErrorTransition,
    tuning::family as tuning,
    vectors::vectorised,
};

/// How far a unit of each motion that is left out has moved the estimates.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Sensitivity {
    /// Of pose and motion.
    pub(crate) state: SMatrix<f64, STATE, UNMODELLED>,
    /// Of the offset of each cell.
    offsets: Vec<UnmodelledVector>,
    /// Time since the first frame.
    elapsed: f64,
}

impl Sensitivity {
    pub(crate) fn new() -> Self {
        Self { state: SMatrix::zeros(), offsets: Vec::new(), elapsed: 0.0 }
    }

    /// Moves on by one step.
    pub(crate) fn predict(&mut self, transition: &ErrorTransition, k: usize, seconds: f64) {
        let ErrorTransition { of_pose, by_motion } = transition;
        self.elapsed += seconds;
        for mut column in self.state.column_iter_mut() {
            let before = column.clone_owned();
            for i in 0..k {
                column[i] = (0..k).map(|j| of_pose[i][j] * before[j] + by_motion[i][j] * before[k + j]).sum();
            }
        }
    }

    /// Pose and motion are forgotten, and learnt anew from what is seen some time later; the outline is kept.
    pub(crate) fn relocate(&mut self, seconds: f64, k: usize) {
        self.elapsed += seconds;
        self.state.rows_mut(0, 2 * k).fill(0.0);
    }

    /// Cells are new from those that it has on, and are measured by a frame in the pose that is believed: their offsets take in all of it.
    pub(crate) fn begin_cells(&mut self, belief: &Belief, map: &OutlineMap) {
        let Some(at) = Instant::new(belief, &belief.pose, map, self.elapsed) else {
            self.offsets.resize(map.cells().len(), UnmodelledVector::zeros());
            return;
        };
        let k = belief.parameter_count();
        for cell in map.cells().iter().skip(self.offsets.len()) {
            let (displacement, p, n) = at.displacement(cell);
            let mut displacement = UnmodelledVector::from(displacement);
            let by_pose = belief.model.normal_velocities(&p, &n);
            (0..k).for_each(|i| displacement -= self.state.row(i).transpose() * by_pose[i]);
            self.offsets.push(displacement);
        }
    }

    /// Updates by a solved frame that has not been committed yet, which stands for `repeats` frames: `frame.cells_with_frame` have the information with
    /// it, those of the belief without. `pose` and `marginal`, the information on
    /// pose and motion, are those with the frame; `measured` is what it tells of the pose by itself.
    pub(crate) fn update(
        &mut self,
        (belief, map): (&Belief, &OutlineMap),
        frame: &mut Frame,
        (pose, marginal): (&Matrix3<f64>, &StateMatrix),
        measured: &PoseMeasurement,
        repeats: f64,
    ) -> Option<UnmodelledScore> {
        match belief.parameter_count() {
            3 => self.update_sized::<3, 6>((belief, map), frame, (pose, marginal), measured, repeats),
            4 => self.update_sized::<4, 8>((belief, map), frame, (pose, marginal), measured, repeats),
            6 => self.update_sized::<6, 12>((belief, map), frame, (pose, marginal), measured, repeats),
            _ => self.update_sized::<8, 16>((belief, map), frame, (pose, marginal), measured, repeats),
        }
    }

    fn update_sized<const K: usize, const S: usize>(
        &mut self,
        (belief, map): (&Belief, &OutlineMap),
        frame: &mut Frame,
        (pose, marginal): (&Matrix3<f64>, &StateMatrix),
        measured: &PoseMeasurement,
        repeats: f64,
    ) -> Option<UnmodelledScore> {
        let at = Instant::new(belief, pose, map, self.elapsed)?;
        let [with, before] = [&frame.cells_with_frame, &belief.information.cells];
        let mut left = std::mem::take(&mut frame.values);
        left.resize(with.len() * UNMODELLED, 0.0);
        let sums = self.sums::<K, S>(&at, map.cells(), ([with, before], &frame.right), &mut left, repeats);
        // The estimates move as such residuals would move them.
        let right =
            SMatrix::<f64, STATE, UNMODELLED>::from_fn(|i, l| if i < S { repeats * sums.right[i][l] } else { 0.0 });
        // Weighted as so many frames, to first order in what they know beside what is known: with the gain of one frame they would overshoot.
        let mut with_all = *marginal;
        for (i, j) in (0..K).flat_map(|i| (0..K).map(move |j| (i, j))) {
            with_all[(i, j)] += (repeats - 1.0) * measured.information[(i, j)];
        }
        if let Some(steps) = scaled_solution(&with_all, &right, K) {
            self.move_offsets::<S>(with, &steps, &left);
            for l in 0..UNMODELLED {
                (0..S).for_each(|i| self.state[(i, l)] += steps[(i, l)]);
            }
        }
        frame.values = left;
        let by_normals = tuning::LEFT_PER_NOISE * map.variance_of_normals();
        sums.score(measured, by_normals.clamp(tuning::LEFT, tuning::MOST_LEFT))
    }

    /// Sums over the cells of a frame, and what is left of each of their displacements as far as the frame corrects it. The information on the
    /// cells is that with the frame and that before.
    fn sums<const K: usize, const S: usize>(
        &self,
        at: &Instant,
        cells: &[Cell],
        ([with, before], right): ([&OffsetInformation; 2], &[f64]),
        left: &mut [f64],
        repeats: f64,
    ) -> Sums<K, S> {
        let of_pose: [[f64; UNMODELLED]; K] = std::array::from_fn(|i| std::array::from_fn(|l| self.state[(i, l)]));
        let mut sums = Sums::<K, S>::NOTHING;
        let (coupling, coupling_before) = (with.rows::<S>(), before.rows::<S>());
        let (with, before) = (with.own(), before.own());
        vectorised(
            #[inline(always)]
            || {
                let of_cells = cells.iter().zip(&self.offsets);
                let known = with.iter().zip(before).zip(coupling.iter().zip(coupling_before)).zip(right);
                let left = left.as_chunks_mut::<UNMODELLED>().0;
                for (((cell, taken_in), left), (((with, before), (coupling, coupling_before)), right)) in
                    of_cells.zip(left).zip(known)
                {
                    let own = with - before;
                    *left = [0.0; UNMODELLED];
                    if own > 0.0 {
                        let whole = at.displacement(cell).0;
                        let mut added = [0.0; K];
                        for i in 0..K {
                            added[i] = coupling[i] - coupling_before[i];
                        }
                        let of_cell =
                            OfCell { with: *with, before: *before, own, right: *right, coupling, added: &added };
                        *left = sums
                            .add(&whole, taken_in.as_slice(), &of_pose, &of_cell)
                            .map(|l| l * (repeats * own / (before + repeats * own)));
                    }
                }
            },
        );
        sums
    }

    /// Moves the offsets by what is left of the displacements, and by the steps of pose and motion.
    fn move_offsets<const S: usize>(
        &mut self,
        cells: &OffsetInformation,
        steps: &SMatrix<f64, STATE, UNMODELLED>,
        left: &[f64],
    ) {
        let (with, coupling) = (cells.own(), cells.rows::<S>());
        let by_entry: [[f64; UNMODELLED]; S] = std::array::from_fn(|i| std::array::from_fn(|l| steps[(i, l)]));
        vectorised(
            #[inline(always)]
            || {
                let of_cells = self.offsets.iter_mut().zip(left.as_chunks::<UNMODELLED>().0);
                for ((offset, left), (with, coupling)) in of_cells.zip(with.iter().zip(coupling)) {
                    if *with > 0.0 {
                        let mut along = [0.0; UNMODELLED];
                        for (i, row) in by_entry.iter().enumerate() {
                            for l in 0..UNMODELLED {
                                along[l] += coupling[i] * row[l];
                            }
                        }
                        let inverse = 1.0 / with;
                        let offset = offset.as_mut_slice();
                        for l in 0..UNMODELLED {
                            offset[l] += left[l] - along[l] * inverse;
                        }
                    }
                }
            },
        );
    }
}

#[cfg(feature = "serde")]
impl Sensitivity {
    /// Whether it is that of a map with so many cells, and all its numbers can be worked with.
    pub(crate) fn is_valid(&self, cells: usize) -> bool {
        let numbers = self.state.iter().chain(self.offsets.iter().flatten()).chain([&self.elapsed]);
        self.offsets.len() == cells && numbers.into_iter().all(|number| number.is_finite())
    }
}
