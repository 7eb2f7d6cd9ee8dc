//! Process noise: what is forgotten because it may have changed.
use freeform_estimate::ProcessNoise;

use super::{ByKind, TimeOfChange, centred_change, kind_index};
use crate::{
    belief::{Belief, EarlierPoses, StateMatrix, scaled_inverse},
    map::NullDirection,
};

impl Belief {
    /// Lets the motion have changed at random over `seconds`. Lengths of the noise are divided by `radius`, covariances by `variance`.
    pub(crate) fn add_process_noise(&mut self, noise: &ProcessNoise, seconds: f64, radius: f64, variance: f64) {
        if noise.is_none() {
            return;
        }
        let k = self.information.k;
        let mut added = StateMatrix::zeros();
        for (j, per_second) in noise.variances(self.model, radius).into_iter().enumerate().take(k) {
            added[(k + j, k + j)] = per_second * seconds / variance;
        }
        self.add_covariance(&added);
    }

    /// Lets the motion have changed at random during the last step predicted: its rates and its velocities about the object's `centroid`
    /// (body frame). The variances per second are those of a change at the beginning that moves the pose by as much.
    pub(crate) fn add_change(
        &mut self,
        (variances, time): (ByKind, TimeOfChange),
        centroid: &nalgebra::Point2<f64>,
        variance: f64,
    ) {
        let (k, seconds) = (self.information.k, self.memory.step);
        let Some(mut unit) = centred_change(self.model, &self.pose, centroid) else { return };
        for (mut column, kind) in unit.column_iter_mut().zip(self.model.parameter_kinds()) {
            column *= variances[kind_index(*kind)].sqrt();
        }
        let motion = unit * unit.transpose() * (seconds / variance);
        // The pose has moved by the change of motion times the step, or, of a motion that changes all the time, by the integral of a random walk: a
        // third of the variance, and half of the covariance.
        let (both, of_motion) = match time {
            TimeOfChange::Beginning => (1.0, 1.0),
            TimeOfChange::Any => (1.5, 3.0),
        };
        let added = StateMatrix::from_fn(|i, j| {
            if i >= 2 * k || j >= 2 * k {
                return 0.0;
            }
            let share = match (i < k, j < k) {
                (true, true) => seconds * seconds,
                (false, false) => of_motion,
                _ => both * seconds,
            };
            motion[(i % k, j % k)] * share
        });
        self.add_covariance(&added);
    }

    /// Forgets all that is known of pose and motion in null directions: another place of the centre of a turn makes something known of it
    /// that is not.
    pub(crate) fn forget(&mut self, null: &[NullDirection], variance: f64) {
        let k = self.information.k;
        for NullDirection { direction, .. } in null {
            let rate = if self.memory.step > 0.0 { 1.0 / self.memory.step } else { 0.0 };
            let unknown = StateMatrix::from_fn(|i, j| {
                let (block, row, column) = (i / k, i % k, j % k);
                if i >= 2 * k || j / k != block {
                    return 0.0;
                }
                let size = if block == 0 { 1.0 } else { rate };
                size * size * direction[row] * direction[column] / variance
            });
            self.add_covariance(&unknown);
        }
        self.earlier_poses = EarlierPoses::Forgotten;
    }

    /// Adds a covariance of pose and motion, in units of the noise. The offsets keep what they are known to be, and their regression on
    /// pose and motion; only what they would come to know of each other is dropped.
    pub(crate) fn add_covariance(&mut self, added: &StateMatrix) {
        let k = self.information.k;
        let Some(covariance) = scaled_inverse(&self.marginal, k) else { return };
        let Some(after) = scaled_inverse(&(covariance + added), k) else { return };
        for (j, span) in self.memory.effective.iter_mut().enumerate().take(k) {
            let (known, new) = (covariance[(k + j, k + j)], added[(k + j, k + j)]);
            // What a filter forgets at this rate in each step it remembers for steps over rate.
            *span *= known / (known + new);
        }
        self.information.add_covariance(&covariance, &after);
        self.marginal = after;
    }
}
