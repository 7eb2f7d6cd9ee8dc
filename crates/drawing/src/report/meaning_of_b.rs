use std::fmt;

use freeform_motion::VelocityUnit;
use freeform_motion::riccati::{CameraScale, ParameterKind};

/// The meaning of b: the velocity of the moving frame at a point, in a unit.
///
/// ```
/// use freeform_drawing::MeaningOfB;
///
/// let b = MeaningOfB::in_pictures(false, 1.0, 1.0, None);
/// assert_eq!(b.to_string(), "velocity at the lower left corner, in pixels/s");
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct MeaningOfB {
    /// The point.
    pub point: &'static str,
    /// The unit, before it was divided by a camera scale.
    pub unit: String,
    /// The unit in tables and in data, after it was divided.
    pub short_unit: VelocityUnit,
    /// The camera scale by which b was divided.
    pub scale: Option<CameraScale>,
}

impl MeaningOfB {
    /// The unit of a parameter in a table, by what it is and the unit that its family of motions gives it.
    pub(crate) fn unit_of(&self, kind: ParameterKind, unit: &'static str) -> &'static str {
        if kind == ParameterKind::Velocity { self.short_unit.in_table() } else { unit }
    }

    /// The unit of a parameter as JSON has it: of a velocity `1/s` where the unit of length has no name, as in the coordinates of a file or after a
    /// division by a camera scale, else that of a table, as `px/s`.
    #[must_use]
    pub fn unit_in_data(&self, kind: ParameterKind, unit: &'static str) -> &'static str {
        self.short_unit.of_parameter(kind, unit)
    }

    /// In the coordinates of a file.
    #[must_use]
    pub fn in_coordinates(scale: Option<CameraScale>) -> Self {
        Self {
            point: "the origin of the coordinates",
            unit: VelocityUnit::Lengths.in_table().to_owned(),
            short_unit: VelocityUnit::Lengths,
            scale,
        }
    }

    /// In the plane that pictures are rectified to.
    #[must_use]
    pub fn in_plane() -> Self {
        Self {
            point: "the origin of the plane",
            unit: "lengths of the plane/s".to_owned(),
            short_unit: VelocityUnit::Lengths,
            scale: None,
        }
    }

    /// In pictures, whose y axis runs downwards from the upper edge if `y_down`, with pixels of some height in the unit of length and of some width
    /// over height.
    #[must_use]
    pub fn in_pictures(y_down: bool, pixel_size: f64, pixel_aspect: f64, scale: Option<CameraScale>) -> Self {
        let point = if y_down { "the upper left corner" } else { "the lower left corner" };
        let unit = match pixel_size {
            1.0 if pixel_aspect != 1.0 => "pixel heights/s".to_owned(),
            1.0 => "pixels/s".to_owned(),
            size => format!("lengths/s, a pixel {size} high"),
        };
        let short_unit = VelocityUnit::in_pictures(pixel_size, pixel_aspect, scale.is_some());
        Self { point, unit, short_unit, scale }
    }

    /// Unit of a position in the outlines.
    pub(crate) fn length_unit(&self) -> &str {
        self.unit.split_once("/s").map_or(self.unit.as_str(), |(length, _)| length)
    }

    /// Unit of the outlines as they came, before they are mapped to a plane.
    pub(crate) fn unit_of_outlines(&self) -> &str {
        if *self == Self::in_plane() { "image length" } else { self.length_unit() }
    }

    /// Unit of a position, and what it was divided by.
    #[must_use]
    pub fn of_length(&self) -> String {
        let unit = self.length_unit();
        let scale = self.scale.map_or_else(String::new, |scale| format!(", over f/Z0 = {scale}"));
        format!("{unit}{scale}")
    }

    /// Unit of a velocity, and what it was divided by.
    #[must_use]
    pub fn of_velocity(&self) -> String {
        let scale = self.scale.map_or_else(String::new, |scale| format!(", over f/Z0 = {scale}"));
        format!("{}{scale}", self.unit)
    }
}

impl Default for MeaningOfB {
    /// In the coordinates of a file, not divided by a camera scale.
    fn default() -> Self {
        Self::in_coordinates(None)
    }
}

impl fmt::Display for MeaningOfB {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "velocity at {}, in {}", self.point, self.of_velocity())
    }
}
