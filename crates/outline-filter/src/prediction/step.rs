use freeform_riccati::{MAX_PARAMETERS, ParameterMatrix};
use nalgebra::Matrix3;

use crate::{
    belief::{Belief, EarlierPoses, moved_marginal},
    tuning::update::MOTION_PRIOR,
};

/// Transition `[[Ad, V], [0, I]]` of the errors of pose and motion over a step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ErrorTransition {
    /// Ad: an error of the pose before the step as one after it.
    pub(crate) of_pose: ParameterMatrix,
    /// V: what an error of the motion makes of the pose.
    pub(crate) by_motion: ParameterMatrix,
}

impl Belief {
    /// Moves on by `seconds` of the estimated motion: `g <- exp(A(theta) dt) g`, information `<- F^-T . F^-1` with the error transition
    /// `F = [[Ad, V], [0, I]]`. `None`, and nothing changes, where the numbers
    /// do not allow it, or `is_shown` says of the pose that it does not show the outline.
    pub(crate) fn predict(
        &mut self,
        seconds: f64,
        is_shown: impl FnOnce(&Matrix3<f64>) -> bool,
    ) -> Option<ErrorTransition> {
        let (model, k) = (self.model, self.information.k);
        let flow = model.flow(&self.motion[..k], seconds).into_inner();
        let inverse = flow.try_inverse().filter(|m| m.iter().all(|e| e.is_finite()))?;
        let pose = Some(flow * self.pose).filter(is_shown)?;
        let sensitivities = model.flow_sensitivities(&self.motion[..k], seconds);
        let by_motion = model.parameter_columns(sensitivities.into_iter());
        let ad_inverse = model.adjoint(&inverse, &flow);
        let mut product: ParameterMatrix = [[0.0; MAX_PARAMETERS]; MAX_PARAMETERS];
        for i in 0..k {
            for j in 0..k {
                product[i][j] = (0..k).map(|m| ad_inverse[i][m] * by_motion[m][j]).sum();
            }
        }
        self.pose = pose;
        self.information.predict(&ad_inverse, &product);
        self.marginal = moved_marginal(&self.marginal, k, &ad_inverse, &product);
        self.memory.advance(seconds);
        Some(ErrorTransition { of_pose: model.adjoint(&flow, &inverse), by_motion })
    }

    /// Puts the object into a new pose and forgets motion and pose, keeping the outline.
    pub(crate) fn relocate(&mut self, pose: Matrix3<f64>) {
        let k = self.information.k;
        self.pose = pose;
        self.information.clear_dense();
        for i in 0..k {
            self.information.dense[i][i] = MOTION_PRIOR;
            self.information.dense[k + i][k + i] = MOTION_PRIOR;
        }
        self.information.cells.clear_couplings();
        self.marginal = self.information.marginal();
        self.earlier_poses = EarlierPoses::Known;
        self.memory.clear();
    }
}
