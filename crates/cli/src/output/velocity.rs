use freeform_motion::estimate::PointVelocity;
use freeform_motion::significant;
use serde::ser::{Serialize, SerializeStruct, Serializer};

/// Names of its components in a table.
pub(super) const VELOCITY_NAMES: [&str; 2] = ["v1", "v2"];

/// What v is in a table, on one line.
pub(super) fn meaning_of_v(velocity: &PointVelocity) -> String {
    let [x, y] = [0, 1].map(|i| significant(velocity.point[i], 4));
    format!("v: velocity of the object's middle, at ({x}, {y}), in the unit of b")
}

/// A velocity as JSON; the unit is that of b.
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
