//! The pose of the frame that a track was begun with, which its map is cut anew in.
use freeform_riccati::MAX_PARAMETERS;
use nalgebra::Matrix3;

use super::{Track, body_frame::BodyFrame};
use crate::{
    belief::StateMatrix,
    dynamics::{PoseMatrix, Summary},
};

/// Body to image, and what is not known of it: nothing where that frame is the body frame.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct FirstPose {
    pub(super) pose: Matrix3<f64>,
    /// Of what is not known of it beside the map, on the left; in normalised units.
    covariance: PoseMatrix,
    /// Of what a map that is cut anew in this pose has in error beside the first frame of all, in the body frame; in normalised units.
    of_body_frame: PoseMatrix,
}

impl Default for FirstPose {
    fn default() -> Self {
        Self { pose: Matrix3::identity(), covariance: PoseMatrix::zeros(), of_body_frame: PoseMatrix::zeros() }
    }
}

impl Track {
    /// Takes the pose that it is in as that which it was begun in. What is not known of it is where a map that is cut in it lies.
    pub(crate) fn begin_here(&mut self) {
        let Some(Summary { pose, covariance, .. }) = self.summary() else { return };
        let of_pose = covariance.fixed_view::<MAX_PARAMETERS, MAX_PARAMETERS>(0, 0).into_owned();
        let k = self.belief.parameter_count();
        let of_pose = PoseMatrix::from_fn(|i, j| if i < k && j < k { of_pose[(i, j)] } else { 0.0 });
        let of_body_frame = pose.try_inverse().and_then(|to_body| self.carried(&of_pose, &to_body));
        let of_body_frame = of_body_frame.unwrap_or_else(PoseMatrix::zeros);
        self.first_pose = FirstPose { pose, covariance: PoseMatrix::zeros(), of_body_frame };
    }

    /// Takes over what the body frame has in error that another track of it has.
    pub(super) fn keep_body_frame_of(&mut self, other: &Self) {
        self.body_frame = other.body_frame;
        self.first_pose.of_body_frame = other.body_frame.covariance();
    }

    /// Takes over the pose that another track was begun in, and what its map has in error since then.
    pub(super) fn begin_in_pose_of(&mut self, other: &Self) {
        self.first_pose = other.first_pose;
        self.body_frame = BodyFrame::of(other.first_pose.of_body_frame);
        self.doubt_first_pose();
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
        self.first_pose = FirstPose { pose: self.belief.pose, covariance, of_body_frame: PoseMatrix::zeros() };
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
        self.pose.iter().chain(&self.covariance).chain(&self.of_body_frame).all(|number| number.is_finite())
    }
}
