//! Process noise: what is forgotten because it may have changed.
use freeform_estimate::ProcessNoise;

use super::{ByKind, TimeOfChange, centred_change, kind_index};
use crate::{
    belief::{Belief, EarlierPoses, StateMatrix, scaled_inverse},
    map::NullDirection,
    tuning::null_space::HOLDING,
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

    /// Takes the pose to be known along null directions, as in every solution, before these are forgotten: what was never known along them would have no
    /// bound.
    pub(crate) fn hold_pose(&mut self, null: &[NullDirection]) {
        let k = self.information.k;
        for NullDirection { dual, .. } in null {
            for (i, j) in (0..k).flat_map(|i| (0..k).map(move |j| (i, j))) {
                self.information.dense[i][j] += HOLDING * dual[i] * dual[j];
            }
        }
        self.marginal = self.information.marginal();
    }

    /// Adds a covariance of pose and motion, in units of the noise. The offsets keep what they are known to be, and their regression on
    /// pose and motion; only what they would come to know of each other is dropped.
    pub(crate) fn add_covariance(&mut self, added: &StateMatrix) {
        let k = self.information.k;
        let Some(covariance) = scaled_inverse(&self.marginal, k) else { return };
        let Some(after) = scaled_inverse(&(covariance + added), k) else { return };
        if self.information.add_covariance(added, [&self.marginal, &after]).is_none() {
            return;
        }
        for (j, span) in self.memory.effective.iter_mut().enumerate().take(k) {
            let (known, new) = (covariance[(k + j, k + j)], added[(k + j, k + j)]);
            // What a filter forgets at this rate in each step it remembers for steps over rate.
            *span *= known / (known + new);
        }
        self.marginal = after;
    }
}

#[cfg(test)]
mod tests {
    use freeform_riccati::{MAX_PARAMETERS, MotionModel};

    use super::*;
    use crate::dense_filter::Problem;

    /// As that of a bar along itself, a direction of which next to nothing is known is nearly, and not quite, one that is not shown.
    #[test]
    fn offsets_stay_known_where_a_direction_is_forgotten_that_has_told_nothing_of_them() {
        let mut belief = Problem::of(MotionModel::Rigid, 8, 5).belief;
        let k = belief.parameter_count();
        let (mut direction, mut untold) = ([0.0; MAX_PARAMETERS], [0.0; MAX_PARAMETERS]);
        direction[..k].copy_from_slice(&[-0.28, 0.768, -0.576]);
        untold[..k].copy_from_slice(&[-0.28, 0.784, -0.554]);
        for (_, coupling) in belief.information.cells.iter_mut() {
            for of_block in coupling.chunks_mut(k).take(2) {
                let along: f64 = of_block.iter().zip(&direction).map(|(c, d)| c * d).sum();
                of_block.iter_mut().zip(&direction).for_each(|(c, d)| *c -= along * d);
            }
        }
        // Pose and motion are known to a fiftieth, but to a hundred thousand along one direction.
        let told_by_offsets = belief.information.with_outline_given() - belief.information.marginal();
        let squared: f64 = untold.iter().map(|c| c * c).sum();
        for (i, row) in belief.information.dense.iter_mut().enumerate().take(2 * k) {
            for (j, entry) in row.iter_mut().enumerate().take(2 * k) {
                let along = if i / k == j / k { untold[i % k] * untold[j % k] / squared } else { 0.0 };
                *entry = told_by_offsets[(i, j)] + 2300.0 * (f64::from(u8::from(i == j)) - along) + 1e-10 * along;
            }
        }
        belief.marginal = belief.information.marginal();
        let before: Vec<f64> = belief.information.cells.own().to_vec();
        belief.forget(&[NullDirection { direction, dual: direction }], 2.5e-7);
        let kept = before.iter().zip(belief.information.cells.own()).map(|(before, after)| after / before);
        kept.for_each(|kept| assert!((kept - 1.0).abs() < 0.01, "{kept}"));
    }

    /// With what is told of a direction gone, that of an offset b lever arms from it is known by `1 / (1 / o + b^2 P)`, P what the direction was known
    /// to, however much larger what is added is.
    #[test]
    fn offsets_lose_what_they_owe_to_a_direction_that_is_forgotten_however_small_the_noise() {
        const KNOWN: f64 = 100.0;
        for variance in [1e-4, 1e-6, 1e-8] {
            let mut belief = Problem::of(MotionModel::Rigid, 8, 5).belief;
            let k = belief.parameter_count();
            let mut direction = [0.0; MAX_PARAMETERS];
            direction[..k].copy_from_slice(&[-0.28, 0.768, -0.576]);
            for (_, coupling) in belief.information.cells.iter_mut() {
                coupling.iter_mut().skip(k).for_each(|c| *c = 0.0);
            }
            let told_by_offsets = belief.information.with_outline_given() - belief.information.marginal();
            for (i, row) in belief.information.dense.iter_mut().enumerate().take(2 * k) {
                for (j, entry) in row.iter_mut().enumerate().take(2 * k) {
                    *entry = told_by_offsets[(i, j)] + if i == j { KNOWN } else { 0.0 };
                }
            }
            belief.marginal = belief.information.marginal();
            let lever = |coupling: &[f64], own: f64| {
                coupling.iter().zip(&direction).take(k).map(|(c, d)| c * d).sum::<f64>() / own
            };
            let cells = &belief.information.cells;
            let squared: f64 = direction.iter().map(|d| d * d).sum();
            let expected: Vec<f64> = (cells.own().iter().zip(cells.couplings()))
                .map(|(own, coupling)| 1.0 / (1.0 / own + lever(coupling, *own).powi(2) / (KNOWN * squared)))
                .collect();
            belief.forget(&[NullDirection { direction, dual: direction }], variance);
            for (found, expected) in belief.information.cells.own().iter().zip(expected) {
                assert!((found / expected - 1.0).abs() < 1e-3, "{variance}: {found} {expected}");
            }
        }
    }
}
