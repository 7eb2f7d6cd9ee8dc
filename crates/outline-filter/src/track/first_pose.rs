//! The pose of the frame that a track was begun with, which its map is cut anew in.
use freeform_riccati::MAX_PARAMETERS;
use nalgebra::{Matrix3, SMatrix};

use super::Track;
use crate::{belief::StateMatrix, dynamics::Summary};

type PoseMatrix = SMatrix<f64, MAX_PARAMETERS, MAX_PARAMETERS>;

/// Body to image, and its covariance, which is none where that frame is the body frame.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct FirstPose {
    pub(super) pose: Matrix3<f64>,
    /// In normalised units.
    covariance: PoseMatrix,
}

impl Default for FirstPose {
    fn default() -> Self {
        Self { pose: Matrix3::identity(), covariance: PoseMatrix::zeros() }
    }
}

impl Track {
    /// Takes the pose that it is in, and what is known of it, as that which it was begun in.
    pub(crate) fn begin_here(&mut self) {
        let k = self.belief.parameter_count();
        let Some(Summary { covariance, .. }) = self.summary() else { return };
        let covariance = PoseMatrix::from_fn(|i, j| if i < k && j < k { covariance[(i, j)] } else { 0.0 });
        self.first_pose = FirstPose { pose: self.belief.pose, covariance };
    }

    /// The pose that it is in as that which it was begun in, with nothing known of how the object has turned until then.
    pub(super) fn begin_here_with_any_turn(&mut self) {
        let k = self.belief.parameter_count();
        self.hide_turn();
        let mut covariance = PoseMatrix::zeros();
        for null in self.map.null_directions(self.belief.model, &self.belief.pose) {
            let direction = null.direction;
            (0..k).for_each(|i| (0..k).for_each(|j| covariance[(i, j)] += direction[i] * direction[j]));
        }
        self.show_turn();
        self.first_pose = FirstPose { pose: self.belief.pose, covariance };
        self.doubt_first_pose();
    }

    /// Adds what is not known of the first pose to the covariance of a track that has just been begun in it.
    pub(super) fn doubt_first_pose(&mut self) {
        let FirstPose { covariance, .. } = self.first_pose;
        if covariance != PoseMatrix::zeros() {
            let mut added = StateMatrix::zeros();
            added
                .fixed_view_mut::<MAX_PARAMETERS, MAX_PARAMETERS>(0, 0)
                .copy_from(&(covariance / self.noise.effective_variance()));
            self.belief.add_covariance(&added);
        }
    }
}

#[cfg(feature = "serde")]
impl FirstPose {
    /// Whether every number is finite.
    pub(super) fn is_finite(&self) -> bool {
        self.pose.iter().chain(&self.covariance).all(|number| number.is_finite())
    }
}
