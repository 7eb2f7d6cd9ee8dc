use nalgebra::{DMatrix, Matrix3};

use crate::{
    error::DynamicsError,
    motion::{AffineMotion, ProjectiveMotion, RigidMotion, SimilarityMotion},
    motion_model::MotionModel,
};

/// Scale `f / Z0` of a scaled orthographic camera, `x = (f / Z0) X`, `y = (f / Z0) Y` (equation 23).
///
/// Rotation, shear and growth are the same in the image and in space; velocities scale by `f / Z0` (equation 24, which in
/// the paper has lost the vector that its matrix multiplies), projective terms c1, c2 by its inverse.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "f64", into = "f64"))]
pub struct CameraScale(f64);

impl Default for CameraScale {
    /// 1: space and image coordinates are the same.
    fn default() -> Self {
        Self(1.0)
    }
}

impl TryFrom<f64> for CameraScale {
    type Error = DynamicsError;

    fn try_from(focal_length_over_distance: f64) -> Result<Self, DynamicsError> {
        Self::new(focal_length_over_distance)
    }
}

impl From<CameraScale> for f64 {
    fn from(scale: CameraScale) -> Self {
        scale.0
    }
}

impl std::fmt::Display for CameraScale {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.fmt(f)
    }
}

impl CameraScale {
    /// From `f / Z0`, focal length over distance: any finite positive number.
    ///
    /// # Errors
    /// A value that is not a normal positive number.
    pub const fn new(focal_length_over_distance: f64) -> Result<Self, DynamicsError> {
        let scale = focal_length_over_distance;
        if scale.is_normal() && scale > 0.0 { Ok(Self(scale)) } else { Err(DynamicsError::CameraScale { scale }) }
    }

    /// The number `f / Z0`.
    #[must_use]
    pub const fn value(self) -> f64 {
        self.0
    }

    /// The generator seen in the image of an object that moves by `space` (equation 24): `S space S^-1` with `S = diag(s,
    /// s, 1)`. Maps of the plane change in the same way.
    #[must_use]
    pub fn generator_in_image(self, space: &Matrix3<f64>) -> Matrix3<f64> {
        let mut image = *space;
        image.fixed_view_mut::<2, 1>(0, 2).scale_mut(self.0);
        image.fixed_view_mut::<1, 2>(2, 0).unscale_mut(self.0);
        image
    }

    /// The generator in space of an object whose image moves by `image`: the inverse of `generator_in_image`.
    #[must_use]
    pub fn generator_in_space(self, image: &Matrix3<f64>) -> Matrix3<f64> {
        let mut space = *image;
        space.fixed_view_mut::<2, 1>(0, 2).unscale_mut(self.0);
        space.fixed_view_mut::<1, 2>(2, 0).scale_mut(self.0);
        space
    }

    /// Covariance in space of the parameters of a motion, k by k in the order of the model, from that in the image.
    #[must_use]
    pub fn covariance_in_space(self, model: MotionModel, image: &DMatrix<f64>) -> DMatrix<f64> {
        let ones = vec![1.0; model.parameter_count()];
        let factors = model.parameters_of(&self.generator_in_space(&model.generator(&ones)));
        DMatrix::from_fn(image.nrows(), image.ncols(), |i, j| factors[i] * image[(i, j)] * factors[j])
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
