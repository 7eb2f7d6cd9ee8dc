//! The pose of the frame that a map was begun with, which it is cut anew in.
use freeform_riccati::MAX_PARAMETERS;
use nalgebra::{Matrix3, SMatrix};

use super::{arrow_information::StateMatrix, outline_map::OutlineMap};

type PoseMatrix = SMatrix<f64, MAX_PARAMETERS, MAX_PARAMETERS>;

/// Body to image, and its covariance, which is none where that frame is the body frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FirstPose {
    pub(crate) pose: Matrix3<f64>,
    /// In normalised units.
    covariance: PoseMatrix,
}

impl Default for FirstPose {
    fn default() -> Self {
        Self { pose: Matrix3::identity(), covariance: PoseMatrix::zeros() }
    }
}

impl OutlineMap {
    /// Takes the pose that it is in, and what is known of it, as that which it was begun in.
    pub(crate) fn begin_here(&mut self) {
        let k = self.information.k;
        let Some(covariance) = self.state_covariance(&self.marginal) else { return };
        let covariance = PoseMatrix::from_fn(|i, j| if i < k && j < k { covariance[(i, j)] } else { 0.0 });
        self.first_pose = FirstPose { pose: self.pose, covariance };
    }

    /// The same with nothing known of how the object has turned until then.
    pub(crate) fn begin_here_with_any_turn(&mut self) {
        let k = self.information.k;
        self.hide_turn();
        let mut covariance = PoseMatrix::zeros();
        for unseen in self.unseen_in_image(&self.pose) {
            let direction = unseen.direction;
            (0..k).for_each(|i| (0..k).for_each(|j| covariance[(i, j)] += direction[i] * direction[j]));
        }
        self.show_turn();
        self.first_pose = FirstPose { pose: self.pose, covariance };
        self.doubt_first_pose();
    }

    /// Adds what is not known of the first pose to the covariance of a map that has just been begun in it.
    pub(crate) fn doubt_first_pose(&mut self) {
        let FirstPose { covariance, .. } = self.first_pose;
        if covariance != PoseMatrix::zeros() {
            let mut added = StateMatrix::zeros();
            added
                .fixed_view_mut::<MAX_PARAMETERS, MAX_PARAMETERS>(0, 0)
                .copy_from(&(covariance / self.effective_variance()));
            self.add_covariance(&added);
        }
    }
}
