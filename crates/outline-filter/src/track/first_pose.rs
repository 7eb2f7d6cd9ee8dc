//! The pose of the frame that a track was begun with, which its map is cut anew in.
use freeform_riccati::turn_rate;
use nalgebra::Matrix3;

use super::{
    Track,
    body_frame::{BodyFrame, of_pose},
};
use crate::{
    prediction::PoseMatrix,
    tuning::null_space::{ANY_TURN, TAKES_PART},
};

/// Body to image. The map was cut in it: what is not known of it is where the body frame lies.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct FirstPose {
    pub(super) pose: Matrix3<f64>,
    /// That of a map that is cut anew in this pose.
    body_frame: BodyFrame,
}

impl Default for FirstPose {
    fn default() -> Self {
        Self { pose: Matrix3::identity(), body_frame: BodyFrame::default() }
    }
}

impl Track {
    /// Takes the pose that it is in as that which it was begun in. What is not known of it is where a map that is cut in it lies.
    pub(crate) fn begin_here(&mut self) {
        let Some(summary) = self.summary() else { return };
        let body_frame = self.body_frame_by(&of_pose(&summary.covariance));
        self.first_pose = FirstPose { pose: summary.pose, body_frame };
    }

    /// Takes over the pose that another track was begun in, and what its map has in error since then.
    pub(super) fn begin_in_pose_of(&mut self, other: &Self) {
        self.first_pose = other.first_pose;
        self.body_frame = other.first_pose.body_frame;
    }

    /// Takes the pose that it is in, that of another track which shows no turn, as that which it was begun in. What is not known of it, any turn
    /// included, is where its body frame lies.
    pub(super) fn begin_with_any_turn_of(&mut self, other: &Self) {
        // It may have been asked anew whether it shows its turn.
        let mut other = other.clone();
        other.hide_turn();
        let null = other.null_directions();
        let known = other.held_summaries(&null).map(|[mut known, _]| {
            other.add_kept_error(&mut known);
            of_pose(&known.covariance)
        });
        let mut covariance = known.unwrap_or_default();
        let model = self.model();
        for null in &*null {
            let turn = turn_rate(&model.generator(&null.direction[..model.parameter_count()])).abs();
            // The turn itself is what nobody knows, however far it takes the origin.
            let times = if turn > TAKES_PART { (ANY_TURN / turn).max(1.0) } else { 1.0 };
            covariance += null.square() * (times * times);
        }
        self.body_frame = self.body_frame_by(&covariance);
        self.first_pose = FirstPose { pose: self.belief.pose, body_frame: self.body_frame };
    }

    /// Where the body frame lies by what is not known of the pose that it is in, of errors on the left.
    fn body_frame_by(&self, covariance: &PoseMatrix) -> BodyFrame {
        self.in_body_frame(covariance).map_or_else(BodyFrame::default, |in_body| BodyFrame::of(&in_body))
    }
}

#[cfg(feature = "serde")]
impl FirstPose {
    /// Whether every number is finite, and the body frame may lie where it does.
    pub(super) fn is_valid(&self) -> bool {
        self.pose.iter().all(|number| number.is_finite()) && self.body_frame.is_valid()
    }
}
