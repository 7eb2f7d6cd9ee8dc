use crate::{
    error::DynamicsError,
    motion::{AffineMotion, ProjectiveMotion, RigidMotion, SimilarityMotion},
};

/// Scale `f / Z0` of a scaled orthographic camera, `x = (f / Z0) X`, `y = (f / Z0) Y` (equation 23).
///
/// Rotation, shear and growth are the same in the image and in space; velocities scale by `f / Z0` (equation 24, which in
/// the paper has lost the vector that its matrix multiplies), projective terms c1, c2 by its inverse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraScale(f64);

impl CameraScale {
    /// From `f / Z0`, focal length over distance: any finite positive number.
    ///
    /// # Errors
    /// A value that is not a normal positive number.
    pub fn new(focal_length_over_distance: f64) -> Result<Self, DynamicsError> {
        let scale = focal_length_over_distance;
        if scale.is_normal() && scale > 0.0 { Ok(Self(scale)) } else { Err(DynamicsError::CameraScale { scale }) }
    }

    /// The number `f / Z0`.
    #[must_use]
    pub const fn value(self) -> f64 {
        self.0
    }
}

macro_rules! scale_velocities {
    ($($motion:ident)*) => {$(
        impl $motion {
            /// The motion seen in the image of an object that moves like this in space (equation 24).
            #[must_use]
            pub fn in_image(self, scale: CameraScale) -> Self {
                Self { b1: self.b1 * scale.0, b2: self.b2 * scale.0, ..self }
            }

            /// The motion in space of an object whose image moves like this: the inverse of `in_image`.
            #[must_use]
            pub fn in_space(self, scale: CameraScale) -> Self {
                Self { b1: self.b1 / scale.0, b2: self.b2 / scale.0, ..self }
            }
        }
    )*};
}

scale_velocities!(RigidMotion SimilarityMotion AffineMotion);

impl ProjectiveMotion {
    /// The motion seen in the image of an object that moves like this in space (equation 24).
    #[must_use]
    pub fn in_image(self, scale: CameraScale) -> Self {
        let CameraScale(s) = scale;
        Self { b1: self.b1 * s, b2: self.b2 * s, c1: self.c1 / s, c2: self.c2 / s, ..self }
    }

    /// The motion in space of an object whose image moves like this: the inverse of `in_image`.
    #[must_use]
    pub fn in_space(self, scale: CameraScale) -> Self {
        let CameraScale(s) = scale;
        Self { b1: self.b1 / s, b2: self.b2 / s, c1: self.c1 * s, c2: self.c2 * s, ..self }
    }
}
