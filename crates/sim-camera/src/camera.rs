use freeform_riccati::AffineMotion;
use nalgebra::{Affine2, Point2};

use crate::error::SimulationError;

/// The scaled orthographic camera `x = (f/Z0) X`, `y = (f/Z0) Y` (equation 23).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    scale: f64,
}

impl Camera {
    /// A camera with the scale `f/Z0`, image lengths per space length.
    ///
    /// # Errors
    /// The scale is not a positive finite number.
    pub fn new(scale: f64) -> Result<Self, SimulationError> {
        if scale.is_finite() && scale > 0.0 {
            return Ok(Self { scale });
        }
        Err(SimulationError::OutOfRange { setting: "camera scale", value: scale, range: "finite and above 0" })
    }

    /// The scale `f/Z0`.
    #[must_use]
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// The image of a point of the object's plane.
    #[must_use]
    pub fn project(&self, space: &Point2<f64>) -> Point2<f64> {
        space * self.scale
    }

    /// The motion seen in the image: the same linear part, `b` times `f/Z0` (equation 24).
    #[must_use]
    pub fn image_motion(&self, space: &AffineMotion) -> AffineMotion {
        AffineMotion { b1: self.scale * space.b1, b2: self.scale * space.b2, ..*space }
    }

    /// The map of the image plane that a map of the object's plane shows as.
    #[must_use]
    pub fn image_map(&self, space: &Affine2<f64>) -> Affine2<f64> {
        let mut matrix = *space.matrix();
        matrix[(0, 2)] *= self.scale;
        matrix[(1, 2)] *= self.scale;
        Affine2::from_matrix_unchecked(matrix)
    }
}

impl Default for Camera {
    /// Scale 1: space and image coordinates are the same.
    fn default() -> Self {
        Self { scale: 1.0 }
    }
}
