//! The map moved on in time, and what is forgotten on the way.
use freeform_estimate::ProcessNoise;
use freeform_riccati::{MAX_PARAMETERS, ParameterMatrix};
use nalgebra::Matrix3;

use super::{
    arrow_information::{ArrowInformation, CellInformation, StateMatrix, StateVector, moved_marginal, scaled_inverse},
    innovation::{ByKind, kind_index},
    outline_map::{MOTION_PRIOR, OutlineMap},
};

impl OutlineMap {
    /// Moves on by `seconds` of the estimated motion.
    pub fn predict(&mut self, seconds: f64) {
        let k = self.information.k;
        let flow = self.model.flow(&self.motion[..k], seconds).into_inner();
        let Some(inverse) = flow.try_inverse().filter(|m| m.iter().all(|e| e.is_finite())) else { return };
        let sensitivities = self.model.flow_sensitivities(&self.motion[..k], seconds);
        let by_motion = self.model.parameter_columns(sensitivities.into_iter());
        let ad_inverse = self.model.adjoint(&inverse, &flow);
        let mut product: ParameterMatrix = [[0.0; MAX_PARAMETERS]; MAX_PARAMETERS];
        for i in 0..k {
            for j in 0..k {
                product[i][j] = (0..k).map(|m| ad_inverse[i][m] * by_motion[m][j]).sum();
            }
        }
        self.pose = flow * self.pose;
        self.information.predict(&ad_inverse, &product);
        self.marginal = moved_marginal(&self.marginal, k, &ad_inverse, &product);
        self.let_outline_drift();
        self.span += seconds;
        self.spans.iter_mut().for_each(|span| *span += seconds);
        self.step_seconds = seconds;
    }

    /// Lets the motion have changed at random over `seconds`. The offsets keep what they are known to be, and their regression on
    /// pose and motion; only what they would come to know of each other is dropped.
    pub fn add_process_noise(&mut self, noise: &ProcessNoise, seconds: f64) {
        if noise.is_none() {
            return;
        }
        let k = self.information.k;
        let units = self.effective_variance();
        let mut added = StateMatrix::zeros();
        for (j, variance) in noise.variances(self.model, self.radius).into_iter().enumerate().take(k) {
            added[(k + j, k + j)] = variance * seconds / units;
        }
        self.add_covariance(&added);
    }

    /// Lets the motion have changed at random during the last step predicted: its rates and its velocities about the object's centre by
    /// variances per second, in normalised units.
    pub(crate) fn add_change(&mut self, variances: ByKind) {
        let (k, seconds) = (self.information.k, self.step_seconds);
        let Some(mut unit) = self.unit_change() else { return };
        for (mut column, kind) in unit.column_iter_mut().zip(self.model.parameter_kinds()) {
            column *= variances[kind_index(*kind)].sqrt();
        }
        let motion = unit * unit.transpose() * (seconds / self.effective_variance());
        // The pose has moved by the change of motion times the step.
        let added = StateMatrix::from_fn(|i, j| {
            if i >= 2 * k || j >= 2 * k {
                return 0.0;
            }
            let factor = |at: usize| if at < k { seconds } else { 1.0 };
            motion[(i % k, j % k)] * factor(i) * factor(j)
        });
        self.add_covariance(&added);
    }

    pub(crate) fn add_covariance(&mut self, added: &StateMatrix) {
        let k = self.information.k;
        let Some(covariance) = scaled_inverse(&self.marginal, k) else { return };
        // Before (x) given after (x'): x = K x' + rest.
        let Some(after) = scaled_inverse(&(covariance + added), k) else { return };
        for (j, span) in self.spans.iter_mut().enumerate().take(k) {
            let (known, new) = (covariance[(k + j, k + j)], added[(k + j, k + j)]);
            // What a filter forgets at this rate in each step it remembers for steps over rate.
            *span *= known / (known + new);
        }
        let gain = covariance * after;
        let rest = covariance - gain * covariance;
        let mut dense = after;
        for cell in &mut self.information.cells {
            if cell.own <= 0.0 {
                continue;
            }
            let slope = StateVector::from(cell.coupling) / cell.own;
            let own = 1.0 / (1.0 / cell.own + (slope.transpose() * rest * slope).x.max(0.0));
            let coupling = gain.transpose() * slope * own;
            dense += coupling * coupling.transpose() / own;
            cell.own = own;
            cell.coupling = coupling.into();
        }
        for (i, row) in self.information.dense.iter_mut().enumerate().take(2 * k) {
            (0..2 * k).for_each(|j| row[j] = dense[(i, j)]);
        }
        self.marginal = after;
    }

    /// Puts the object into a new pose and forgets motion and pose, keeping the outline.
    pub(crate) fn relocate(&mut self, pose: Matrix3<f64>) {
        let k = self.information.k;
        self.pose = pose;
        self.information.dense = ArrowInformation::new(k).dense;
        for i in 0..k {
            self.information.dense[i][i] = MOTION_PRIOR;
            self.information.dense[k + i][k + i] = MOTION_PRIOR;
        }
        for cell in &mut self.information.cells {
            *cell = CellInformation { own: cell.own, ..CellInformation::NOTHING };
        }
        self.marginal = self.information.marginal();
        self.is_forgotten = false;
        self.span = 0.0;
        self.spans = [0.0; MAX_PARAMETERS];
    }
}
