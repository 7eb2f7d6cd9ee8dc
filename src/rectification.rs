//! A known plane: from outlines as a perspective camera sees them to outlines in the plane that the objects move in.
use freeform_curve_fit::{Outline, OutlineError};
use freeform_riccati::map_point;
use nalgebra::{Matrix3, Point2, Projective2};

use crate::regular_map::is_regular;

/// Smallest ratio of the depths of two points of an outline: nearer to the horizon of the plane, noise decides where a point is.
const NEAREST_HORIZON: f64 = 0.02;

/// Why a map cannot rectify, or an outline cannot be rectified.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RectifyError {
    /// The map is not finite or takes the picture to a line.
    #[error("the map from the picture to the plane is singular (determinant {determinant:e})")]
    Singular {
        /// Its determinant.
        determinant: f64,
    },
    /// A part of the outline is at or beyond the horizon of the plane.
    #[error("the outline reaches the horizon of the plane")]
    Horizon,
    /// The points in the plane are no outline.
    #[error("not an outline in the plane: {0}")]
    Outline(#[from] OutlineError),
}

/// The homography from a picture to a plane in space, such as a table that a camera looks at from aside.
///
/// A rigid motion in that plane keeps its three parameters there, in the unit of the plane. In the picture its generator is
/// `G A G^-1`, G the map from the plane to the picture, which is rigid for no tilted plane. [`homography`](freeform_riccati::homography)
/// finds the map from four points or more.
///
/// ```
/// use freeform_curve_fit::Outline;
/// use freeform_motion::Rectification;
/// use freeform_riccati::homography;
/// use nalgebra::Point2;
///
/// let point = |(x, y): (f64, f64)| Point2::new(x, y);
/// let seen = [(102.0, 391.0), (418.0, 402.0), (371.0, 120.0), (160.0, 117.0)].map(point);
/// let sheet = [(0.0, 0.0), (21.0, 0.0), (21.0, 29.7), (0.0, 29.7)].map(point);
/// let pairs: Vec<_> = seen.into_iter().zip(sheet).collect();
/// let rectification = Rectification::new(&homography(&pairs)?)?;
/// let rectified = rectification.outline(&Outline::closed(seen.to_vec())?)?;
/// assert!((rectified.signed_area() - 21.0 * 29.7).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rectification {
    plane_from_picture: Matrix3<f64>,
    picture_from_plane: Matrix3<f64>,
}

impl Rectification {
    /// By the map from the picture to the plane, on homogeneous coordinates; a factor does not matter.
    ///
    /// # Errors
    /// A map that is singular or not finite.
    pub fn new(plane_from_picture: &Projective2<f64>) -> Result<Self, RectifyError> {
        let map = *plane_from_picture.matrix();
        let inverse = map.try_inverse().filter(|inverse| inverse.iter().all(|entry| entry.is_finite()));
        match inverse {
            Some(picture_from_plane) if is_regular(&map) => Ok(Self { plane_from_picture: map, picture_from_plane }),
            _ => Err(RectifyError::Singular { determinant: map.determinant() }),
        }
    }

    /// The map from the picture to the plane, as it was given.
    #[cfg(feature = "serde")]
    pub(crate) fn plane_from_picture(&self) -> &Matrix3<f64> {
        &self.plane_from_picture
    }

    /// An outline of the picture in the plane.
    ///
    /// # Errors
    /// An outline that reaches the horizon of the plane.
    pub fn outline(&self, picture: &Outline) -> Result<Outline, RectifyError> {
        let depths = picture.points().map(|p| (self.plane_from_picture * p.to_homogeneous()).z);
        let (least, most) = depths.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), w| (a.min(w), b.max(w)));
        // The sign of the map is free.
        let (near, far) = if most > 0.0 { (least, most) } else { (-most, -least) };
        if near.is_nan() || far.is_nan() || near <= NEAREST_HORIZON * far {
            return Err(RectifyError::Horizon);
        }
        let point = |p: &Point2<f64>| {
            let there = self.plane_from_picture * p.to_homogeneous();
            Point2::from(there.xy() / there.z)
        };
        Ok(picture.mapped(point)?)
    }

    /// The generator in the picture of a motion in the plane: `G A G^-1`, G the map from the plane to the picture.
    #[must_use]
    pub fn generator_in_picture(&self, plane: &Matrix3<f64>) -> Matrix3<f64> {
        self.picture_from_plane * plane * self.plane_from_picture
    }

    /// A point of the plane where it is seen in the picture. Not finite on the line that the picture shows at infinity.
    #[must_use]
    pub fn point_in_picture(&self, plane: &Point2<f64>) -> Point2<f64> {
        map_point(&self.picture_from_plane, plane)
    }
}
