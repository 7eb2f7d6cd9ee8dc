use freeform_riccati::{CameraScale, ProjectiveMotion};
use nalgebra::{Point2, Projective2};

use crate::error::SimulationError;

/// The scaled orthographic camera `x = (f/Z0) X`, `y = (f/Z0) Y` (equation 23).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    scale: CameraScale,
}

impl Camera {
    /// A camera with the scale `f/Z0`, image lengths per space length.
    ///
    /// # Errors
    /// The scale is not a positive finite number.
    pub fn new(scale: f64) -> Result<Self, SimulationError> {
        let out_of_range =
            |_| SimulationError::OutOfRange { setting: "camera scale", value: scale, range: "finite and above 0" };
        CameraScale::new(scale).map(|scale| Self { scale }).map_err(out_of_range)
    }

    /// The scale `f/Z0`.
    #[must_use]
    pub fn scale(&self) -> CameraScale {
        self.scale
    }

    /// The image of a point of the object's plane.
    #[must_use]
    pub fn project(&self, space: &Point2<f64>) -> Point2<f64> {
        space * self.scale.value()
    }

    /// The motion seen in the image: the same linear part, `b` times `f/Z0` (equation 24), `c` over it.
    #[must_use]
    pub fn image_motion(&self, space: &ProjectiveMotion) -> ProjectiveMotion {
        space.in_image(self.scale)
    }

    /// The map of the image plane that a map of the object's plane shows as.
    #[must_use]
    pub fn image_map(&self, space: &Projective2<f64>) -> Projective2<f64> {
        Projective2::from_matrix_unchecked(self.scale.generator_in_image(space.matrix()))
    }
}

impl Default for Camera {
    /// Scale 1: space and image coordinates are the same.
    fn default() -> Self {
        Self { scale: CameraScale::default() }
    }
}
