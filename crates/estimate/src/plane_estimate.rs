use freeform_riccati::PlaneMotion;
use nalgebra::{Matrix3, SMatrix, Vector3};

use crate::motion_estimate::ParameterEstimate;

/// An identified motion of a plane in space, and how well it is known: angular velocity, velocity, and the normal at the first frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneEstimate {
    motion: PlaneMotion,
    covariance: SMatrix<f64, { PlaneMotion::PARAMETERS }, { PlaneMotion::PARAMETERS }>,
    known: [bool; PlaneMotion::PARAMETERS],
}

/// Normal of a plane at the first frame, over its distance along the optical axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NormalEstimate {
    /// The normal; its z is 1.
    pub value: Vector3<f64>,
    /// Its covariance; that of z is 0.
    pub covariance: Matrix3<f64>,
}

impl PlaneEstimate {
    /// An estimate with the covariance of wx, wy, wz, vx, vy, vz, and x and y of the normal, of which those marked are known.
    #[must_use]
    pub const fn new(
        motion: PlaneMotion,
        covariance: SMatrix<f64, { PlaneMotion::PARAMETERS }, { PlaneMotion::PARAMETERS }>,
        known: [bool; PlaneMotion::PARAMETERS],
    ) -> Self {
        Self { motion, covariance, known }
    }

    /// The motion, unknown parameters taken as they stand; z of its normal is 1.
    #[must_use]
    pub const fn motion(&self) -> &PlaneMotion {
        &self.motion
    }

    /// Covariance of wx, wy, wz, vx, vy, vz, and x and y of the normal.
    #[must_use]
    pub const fn covariance(&self) -> &SMatrix<f64, { PlaneMotion::PARAMETERS }, { PlaneMotion::PARAMETERS }> {
        &self.covariance
    }

    /// Which of wx, wy, wz, vx, vy, vz, and x and y of the normal are known.
    #[must_use]
    pub const fn known(&self) -> &[bool; PlaneMotion::PARAMETERS] {
        &self.known
    }

    /// wx, wy, wz in rad/s, and vx, vy, vz in distances of the plane along the optical axis at the first frame, per second.
    pub fn parameters(&self) -> impl Iterator<Item = ParameterEstimate> + '_ {
        let values = self.motion.parameters();
        let names = PlaneMotion::NAMES.into_iter().zip(PlaneMotion::UNITS);
        names.enumerate().map(move |(i, (name, unit))| {
            let deviation = self.known[i].then(|| self.covariance[(i, i)].max(0.0).sqrt());
            ParameterEstimate {
                name,
                unit,
                value: self.known[i].then_some(values[i]),
                standard_deviation: deviation,
                random_deviation: deviation,
                systematic_deviation: deviation.map(|_| 0.0),
            }
        })
    }

    /// The normal at the first frame, where it is known.
    #[must_use]
    pub fn normal(&self) -> Option<NormalEstimate> {
        let is_known = self.known[6] && self.known[7];
        is_known.then(|| {
            let mut covariance = Matrix3::zeros();
            covariance.fixed_view_mut::<2, 2>(0, 0).copy_from(&self.covariance.fixed_view::<2, 2>(6, 6));
            NormalEstimate { value: self.motion.normal, covariance }
        })
    }

    /// Whether every number is finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.motion.parameters().iter().chain(&self.covariance).all(|number| number.is_finite())
    }
}
