//! Turns of an object in the plane.
use std::f64::consts::{PI, TAU};

use freeform_riccati::{map_point, turn_rate};
use nalgebra::{Matrix3, Rotation2, Vector2};

use super::Track;

/// A turn between half a circle clockwise and half a circle anticlockwise.
pub(crate) fn wrapped(turn: f64) -> f64 {
    (turn + PI).rem_euclid(TAU) - PI
}

/// The turn by an angle, rad, anticlockwise where y points up, that takes one point to another.
pub(crate) fn turn_between(angle: f64, from: &Vector2<f64>, to: &Vector2<f64>) -> Matrix3<f64> {
    let rotation = Rotation2::new(angle);
    let shift = to - rotation * from;
    let mut map = rotation.to_homogeneous();
    (map[(0, 2)], map[(1, 2)]) = (shift.x, shift.y);
    map
}

impl Track {
    /// The turn that the motion makes in a time, in the filter's unit; rad, anticlockwise where y points up.
    pub(crate) fn turn_in(&self, time: f64) -> f64 {
        let model = self.model();
        -time * turn_rate(&model.generator(&self.belief().motion[..model.parameter_count()]))
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
