use freeform_riccati::ParameterKind;

/// The unit of velocities in results, by where the coordinates of the outlines come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum VelocityUnit {
    /// Pixels of a picture.
    Pixels,
    /// The same where pixels are not square: their heights.
    PixelHeights,
    /// Lengths that have no name here: of a table, of a plane, of pixels of a stated size, or after a division by a camera scale.
    #[default]
    Lengths,
}

impl VelocityUnit {
    /// That of outlines in pictures: `pixel_size` is the height of a pixel in the unit of the outlines, `pixel_aspect` its width over its height;
    /// `is_scaled` says that velocities are divided by a camera scale.
    ///
    /// ```
    /// use freeform_motion::VelocityUnit;
    ///
    /// assert_eq!(VelocityUnit::in_pictures(1.0, 1.0, false).in_data(), "px/s");
    /// assert_eq!(VelocityUnit::in_pictures(0.25, 1.0, false).in_data(), "1/s");
    /// ```
    #[must_use]
    pub fn in_pictures(pixel_size: f64, pixel_aspect: f64, is_scaled: bool) -> Self {
        match (pixel_size, pixel_aspect) {
            _ if is_scaled => Self::Lengths,
            (1.0, 1.0) => Self::Pixels,
            (1.0, _) => Self::PixelHeights,
            _ => Self::Lengths,
        }
    }

    /// As tables for people have it.
    #[must_use]
    pub const fn in_table(self) -> &'static str {
        match self {
            Self::Pixels => "px/s",
            Self::PixelHeights => "pixel heights/s",
            Self::Lengths => "lengths/s",
        }
    }

    /// As data have it, in JSON, CSV and Python: `1/s` where the unit of length has no name.
    #[must_use]
    pub const fn in_data(self) -> &'static str {
        match self {
            Self::Pixels | Self::PixelHeights => self.in_table(),
            Self::Lengths => "1/s",
        }
    }

    /// The unit of a number of a pose in data, by its name: that of length for places, `1` where it has no name.
    ///
    /// ```
    /// use freeform_motion::VelocityUnit;
    ///
    /// assert_eq!(["angle", "x", "scale"].map(|name| VelocityUnit::Pixels.of_pose(name)), ["rad", "px", "1"]);
    /// ```
    #[must_use]
    pub fn of_pose(self, name: &str) -> &'static str {
        match (name, self) {
            ("angle", _) => "rad",
            ("x" | "y", Self::Pixels) => "px",
            ("x" | "y", Self::PixelHeights) => "pixel heights",
            ("m31" | "m32", Self::Pixels) => "1/px",
            ("m31" | "m32", Self::PixelHeights) => "1/pixel heights",
            _ => "1",
        }
    }

    /// The unit of a parameter in data, by what it is and the unit that its family of motions gives it.
    #[must_use]
    pub fn of_parameter(self, kind: ParameterKind, unit: &'static str) -> &'static str {
        if kind == ParameterKind::Velocity && self != Self::Lengths { self.in_data() } else { unit }
    }
}
