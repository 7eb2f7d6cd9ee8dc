use std::fmt;

use freeform_motion::riccati::CameraScale;

use crate::args::PictureOptions;

/// Which velocity b is: that of the moving frame at a point, in a unit.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct MeaningOfB {
    pub(crate) point: &'static str,
    pub(crate) unit: String,
    /// What it was divided by.
    pub(crate) scale: Option<CameraScale>,
}

impl MeaningOfB {
    /// In the coordinates of a file.
    pub(crate) fn in_coordinates(scale: Option<CameraScale>) -> Self {
        Self { point: "the origin of the coordinates", unit: "lengths/s".to_owned(), scale }
    }

    /// In pictures, with pixels of some width over height.
    pub(crate) fn in_pictures(options: &PictureOptions, pixel_aspect: f64, scale: Option<CameraScale>) -> Self {
        let point = if options.y_down { "the upper left corner" } else { "the lower left corner" };
        let unit = match options.pixel_size {
            1.0 if pixel_aspect != 1.0 => "pixel heights/s".to_owned(),
            1.0 => "pixels/s".to_owned(),
            size => format!("lengths/s, a pixel {size} high"),
        };
        Self { point, unit, scale }
    }
}

impl fmt::Display for MeaningOfB {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "velocity at {}, in {}", self.point, self.unit)?;
        self.scale.map_or(Ok(()), |scale| write!(f, ", over f/Z0 = {scale}"))
    }
}
