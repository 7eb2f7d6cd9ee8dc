//! Turns of an object in the plane.
use std::f64::consts::{PI, TAU};

use freeform_riccati::{MAX_PARAMETERS, map_point, turn_rate};
use nalgebra::{Matrix2, Matrix3, Rotation2, SVector, Vector2};

use super::{Track, of_pose};
use crate::{map::map_between, tuning::supervisor::LARGEST_TURN_DEVIATION};

/// A turn between half a circle clockwise and half a circle anticlockwise.
pub(crate) fn wrapped(turn: f64) -> f64 {
    (turn + PI).rem_euclid(TAU) - PI
}

/// The turn by an angle, rad, anticlockwise where y points up, that takes one point to another.
pub(crate) fn turn_between(angle: f64, from: &Vector2<f64>, to: &Vector2<f64>) -> Matrix3<f64> {
    map_between(Rotation2::new(angle).matrix(), from, to)
}

impl Track {
    /// The turn that the motion makes in a time, in the filter's unit; rad, anticlockwise where y points up.
    pub(crate) fn turn_in(&self, time: f64) -> f64 {
        let (model, pose) = (self.model(), self.body_pose());
        let generator = model.generator(&self.belief().motion[..model.parameter_count()]);
        // Of the outline as one that is as long as wide, where it may be stretched: as turns of a symmetry are.
        let stretched = self.map.stretched(|| Some(pose.try_inverse()? * generator * pose));
        -time * turn_rate(&stretched.map_or(generator, |linear| linear.to_homogeneous()))
    }

    /// The turn from the present pose to another, rad, anticlockwise where y points up; where the outline may be stretched that of the outline as one
    /// that is as long as wide, since only such turns can bring it onto itself.
    pub(crate) fn turn_to(&self, pose: &Matrix3<f64>) -> f64 {
        let in_body = self.map.stretched(|| Some(self.body_pose().try_inverse()? * pose));
        let step = in_body.unwrap_or_else(|| self.linear_step_to(pose));
        (step.m21 - step.m12).atan2(step.m11 + step.m22)
    }

    /// Size of the change from the present pose to another, shifts left out: that of the turn; where the outline may be stretched the norm of what the
    /// linear part changes.
    pub(crate) fn change_to(&self, pose: &Matrix3<f64>) -> f64 {
        if self.map.may_be_stretched() {
            (self.linear_step_to(pose) - Matrix2::identity()).norm()
        } else {
            self.turn_to(pose).abs()
        }
    }

    /// The linear part of the change of the image from the present pose to another.
    fn linear_step_to(&self, pose: &Matrix3<f64>) -> Matrix2<f64> {
        let step = self.body_pose().try_inverse().map_or_else(Matrix3::identity, |inverse| pose * inverse);
        step.fixed_view::<2, 2>(0, 0).into_owned()
    }

    /// Mean angular velocity (a2 - a3) / 2 of the outline in its present pose where it turns by 1 rad in a unit of time, as
    /// [`turn_to`](Self::turn_to) has it.
    pub(crate) fn mean_rate_of_turn(&self) -> f64 {
        let pose = self.body_pose();
        let turned = self.map.stretched_turn_generator().and_then(|turn| Some(pose * turn * pose.try_inverse()?));
        turned.map_or(1.0, |turned| turn_rate(&turned))
    }

    /// Whether it is known how far the object has turned, well enough that linearisations lead to where it is, or the outline shows no turn. A frame in which
    /// it has turned further may be explained by another number of whole turns.
    pub(crate) fn knows_turn(&self) -> bool {
        if self.turn_is_unseen() {
            return true;
        }
        let Some(summary) = self.summary_in_body_frame() else { return false };
        let basis = self.model().basis();
        let turn = SVector::<f64, MAX_PARAMETERS>::from_fn(|j, _| basis.get(j).map_or(0.0, turn_rate));
        turn.dot(&(of_pose(&summary.covariance) * turn)).sqrt() < LARGEST_TURN_DEVIATION
    }

    /// A pose turned by an angle, rad, anticlockwise where y points up, about the object's centroid. Where the model may stretch the outline, it is
    /// turned as one that is as long as wide.
    pub(crate) fn turned(&self, pose: &Matrix3<f64>, angle: f64) -> Matrix3<f64> {
        if let Some(turn) = self.map.stretched_turn(angle) {
            return pose * turn;
        }
        let centre = map_point(pose, &self.map.centroid()).coords;
        turn_between(angle, &centre, &centre) * pose
    }
}
