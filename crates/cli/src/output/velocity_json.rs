use freeform_motion::estimate::PointVelocity;
use serde::ser::{Serialize, SerializeStruct, Serializer};

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
