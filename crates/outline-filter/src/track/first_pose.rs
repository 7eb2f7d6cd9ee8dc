//! The pose of the frame that a track was begun with, which its map is cut anew in.
use freeform_riccati::MAX_PARAMETERS;
use nalgebra::Matrix3;

use super::{
    Track,
    body_frame::{BodyFrame, of_pose},
};
use crate::{
    belief::StateMatrix,
    dynamics::Summary,
    prediction::{PoseMatrix, moved_covariance},
};

/// Body to image, and what is not known of it: nothing where that frame is the body frame.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct FirstPose {
    pub(super) pose: Matrix3<f64>,
    /// Of what is not known of it beside the map, on the left; in normalised units.
    covariance: PoseMatrix,
    /// Where the body frame of a map that is cut anew in this pose lies.
    body_frame: BodyFrame,
}

impl Default for FirstPose {
    fn default() -> Self {
        Self { pose: Matrix3::identity(), covariance: PoseMatrix::zeros(), body_frame: BodyFrame::default() }
    }
}

impl Track {
    /// Takes the pose that it is in as that which it was begun in. What is not known of it is where a map that is cut in it lies.
    pub(crate) fn begin_here(&mut self) {
        let Some(Summary { pose, covariance, .. }) = self.summary() else { return };
        let in_body =
            pose.try_inverse().and_then(|to_body| moved_covariance(self.model(), &of_pose(&covariance), &to_body));
        let body_frame = in_body.map_or_else(BodyFrame::default, |in_body| BodyFrame::of(&in_body));
        self.first_pose = FirstPose { pose, covariance: PoseMatrix::zeros(), body_frame };
    }

    /// Takes over what the body frame has in error that another track of it has.
    pub(super) fn keep_body_frame_of(&mut self, other: &Self) {
        self.body_frame = other.body_frame;
        self.first_pose.body_frame = other.body_frame;
    }

    /// Takes over the pose that another track was begun in, and what its map has in error since then.
    pub(super) fn begin_in_pose_of(&mut self, other: &Self) {
        self.first_pose = other.first_pose;
        self.body_frame = other.first_pose.body_frame;
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
        self.first_pose = FirstPose { pose: self.belief.pose, covariance, body_frame: BodyFrame::default() };
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
    /// Whether every number is finite, and the body frame may lie where it does.
    pub(super) fn is_valid(&self) -> bool {
        self.pose.iter().chain(&self.covariance).all(|number| number.is_finite()) && self.body_frame.is_valid()
    }
}
