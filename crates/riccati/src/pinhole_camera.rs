use nalgebra::{Matrix3, Point2};

use crate::error::DynamicsError;

/// A perspective camera without distortion: a point X of space, z along its optical axis, is seen at `principal + focal (X, Y) / Z`.
///
/// ```
/// use freeform_riccati::PinholeCamera;
/// use nalgebra::Point2;
///
/// let camera = PinholeCamera::new(800.0, Point2::new(320.0, 240.0))?;
/// assert_eq!(camera.to_picture() * nalgebra::Vector3::new(0.1, 0.0, 1.0), nalgebra::Vector3::new(400.0, 240.0, 1.0));
/// # Ok::<(), freeform_riccati::DynamicsError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "WrittenCamera", into = "WrittenCamera"))]
pub struct PinholeCamera {
    focal: f64,
    principal: Point2<f64>,
}

/// A camera as it is written: what is read is checked.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(rename = "PinholeCamera")]
struct WrittenCamera {
    focal: f64,
    principal: Point2<f64>,
}

#[cfg(feature = "serde")]
impl From<PinholeCamera> for WrittenCamera {
    fn from(PinholeCamera { focal, principal }: PinholeCamera) -> Self {
        Self { focal, principal }
    }
}

#[cfg(feature = "serde")]
impl TryFrom<WrittenCamera> for PinholeCamera {
    type Error = DynamicsError;

    fn try_from(WrittenCamera { focal, principal }: WrittenCamera) -> Result<Self, DynamicsError> {
        Self::new(focal, principal)
    }
}

impl PinholeCamera {
    /// With a focal length and the point where the optical axis meets the picture, both in the unit of the picture, such as pixels.
    ///
    /// # Errors
    /// A focal length that is not a normal positive number, a point that is not finite.
    pub fn new(focal: f64, principal: Point2<f64>) -> Result<Self, DynamicsError> {
        if !(focal.is_normal() && focal > 0.0) {
            return Err(DynamicsError::FocalLength { focal });
        }
        if !principal.iter().all(|coordinate| coordinate.is_finite()) {
            return Err(DynamicsError::PrincipalPoint { x: principal.x, y: principal.y });
        }
        Ok(Self { focal, principal })
    }

    /// Focal length in the unit of the picture.
    #[must_use]
    pub const fn focal(&self) -> f64 {
        self.focal
    }

    /// Where the optical axis meets the picture.
    #[must_use]
    pub const fn principal(&self) -> Point2<f64> {
        self.principal
    }

    /// The matrix that takes normalised image points, `X / Z` of focal length 1, to the picture.
    #[must_use]
    pub fn to_picture(&self) -> Matrix3<f64> {
        let (f, p) = (self.focal, self.principal);
        Matrix3::new(f, 0.0, p.x, 0.0, f, p.y, 0.0, 0.0, 1.0)
    }

    /// The inverse of [`to_picture`](Self::to_picture).
    #[must_use]
    pub fn from_picture(&self) -> Matrix3<f64> {
        let (s, p) = (1.0 / self.focal, self.principal);
        Matrix3::new(s, 0.0, -s * p.x, 0.0, s, -s * p.y, 0.0, 0.0, 1.0)
    }

    /// A map or a generator of normalised image points as one of the picture.
    #[must_use]
    pub fn in_picture(&self, normalised: &Matrix3<f64>) -> Matrix3<f64> {
        self.to_picture() * normalised * self.from_picture()
    }
}
