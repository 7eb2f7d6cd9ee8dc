//! The pose of the frame that a track was begun with, which its map is cut anew in.
use freeform_curve_fit::Outline;
use freeform_riccati::turn_rate;
use nalgebra::Matrix3;

use super::{
    Track,
    body_frame::{BodyFrame, of_pose},
};
use crate::tuning::null_space::{ANY_TURN, TAKES_PART};

/// What the outline of the frame shows that a track was begun with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) enum FirstOutline {
    #[default]
    Whole,
    Part,
}

impl FirstOutline {
    pub(super) fn of(outline: &Outline) -> Self {
        if matches!(outline, Outline::Open(_)) { Self::Part } else { Self::Whole }
    }
}

/// Body to image. The map was cut in it: what is not known of it is where the body frame lies.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct FirstPose {
    pub(super) pose: Matrix3<f64>,
    /// That of a map that is cut anew in this pose.
    body_frame: BodyFrame,
    pub(super) outline: FirstOutline,
}

impl Default for FirstPose {
    fn default() -> Self {
        Self { pose: Matrix3::identity(), body_frame: BodyFrame::default(), outline: FirstOutline::default() }
    }
}

impl Track {
    /// Takes the pose that it is in as that which it was begun in. What is not known of it is where a map that is cut in it lies. False, and nothing
    /// changes, where numbers do not allow to say that.
    #[must_use]
    pub(crate) fn begin_here(&mut self) -> bool {
        let Some(body_frame) = self.body_frame_of(self) else { return false };
        self.first_pose = FirstPose { pose: self.belief.pose, body_frame, ..self.first_pose };
        true
    }

    /// Whether the frame that it was begun with shows a part of the outline alone.
    pub(crate) fn was_begun_with_part(&self) -> bool {
        self.first_pose.outline == FirstOutline::Part
    }

    /// Takes over the pose that another track was begun in, and what its map has in error since then.
    pub(super) fn begin_in_pose_of(&mut self, other: &Self) {
        self.first_pose = other.first_pose;
        self.body_frame = other.first_pose.body_frame;
    }

    /// Takes the pose that it is in, that of another track which shows no turn, as that which it was begun in, with an outline. What is not known of it,
    /// any turn included, is where its body frame lies. False, and nothing changes, where numbers do not allow to say that.
    #[must_use]
    pub(super) fn begin_with_any_turn_of(&mut self, other: &Self, outline: &Outline) -> bool {
        // It may have been asked anew whether it shows its turn.
        let mut other = other.clone();
        other.hide_turn();
        let Some(body_frame) = self.body_frame_of(&other) else { return false };
        self.body_frame = body_frame;
        self.first_pose = FirstPose { pose: self.belief.pose, body_frame, outline: FirstOutline::of(outline) };
        true
    }

    /// Where the body frame lies by what is not known of the pose of a track, which this one is in: with what its outline does not show, and any turn
    /// where it does not show that.
    fn body_frame_of(&self, track: &Self) -> Option<BodyFrame> {
        let null = track.null_directions();
        let [known, _] = track.held_summaries(&null)?;
        let mut covariance = of_pose(&known.covariance) + track.kept_error(&known.pose)?;
        let model = self.model();
        for null in &*null {
            let turn = turn_rate(&model.generator(&null.direction[..model.parameter_count()])).abs();
            // The turn itself is what nobody knows, however far it takes the origin.
            let times = if turn > TAKES_PART { (ANY_TURN / turn).max(1.0) } else { 1.0 };
            covariance += null.square() * (times * times);
        }
        Some(BodyFrame::of(&self.in_body_frame(&covariance)?))
    }
}

#[cfg(feature = "serde")]
impl FirstPose {
    /// Whether every number is finite, and the body frame may lie where it does.
    pub(super) fn is_valid(&self) -> bool {
        self.pose.iter().all(|number| number.is_finite()) && self.body_frame.is_valid()
    }
}
