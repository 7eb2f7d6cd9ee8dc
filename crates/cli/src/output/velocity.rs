use freeform_motion::identify::PointVelocity;
use serde::ser::{Serialize, SerializeStruct, Serializer};

use super::number::{significant, with_deviation};
use crate::meaning_of_b::MeaningOfB;

/// Where the middle of an object is at the end and how fast it moves, on one line.
pub(super) fn velocity_text(velocity: &PointVelocity, b: &MeaningOfB) -> String {
    let deviations = velocity.standard_deviations();
    let [[x, x_std], [y, y_std]] = [0, 1].map(|i| with_deviation(velocity.velocity[i], deviations[i]));
    let [at_x, at_y] = [0, 1].map(|i| significant(velocity.point[i], 4));
    format!("middle: at ({at_x}, {at_y}), velocity ({x}, {y}) +- ({x_std}, {y_std}), in {}", b.of_velocity())
}

/// The same as JSON; the unit is that of b.
pub(super) struct VelocityJson<'a>(pub(super) &'a PointVelocity);

impl Serialize for VelocityJson<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let PointVelocity { point, velocity, .. } = self.0;
        let deviations = self.0.standard_deviations();
        let mut object = serializer.serialize_struct("Velocity", 3)?;
        object.serialize_field("value", &[velocity.x, velocity.y])?;
        object.serialize_field("std", &[deviations.x, deviations.y])?;
        object.serialize_field("point", &[point.x, point.y])?;
        object.end()
    }
}
