use freeform_riccati::{CameraScale, map_point};
use nalgebra::{DMatrix, Matrix2, Matrix2xX, Matrix3, Point2, Vector2, Vector3};

use crate::motion_state::MotionState;

/// Velocity of a point of the object at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PointVelocity {
    /// Position of the point at that time, image coordinates.
    pub point: Point2<f64>,
    /// Its velocity, image lengths per second.
    pub velocity: Vector2<f64>,
    /// Covariance of the velocity, squares of image lengths per second.
    pub covariance: Matrix2<f64>,
}

impl PointVelocity {
    /// Standard deviations of both components.
    #[must_use]
    pub fn standard_deviations(&self) -> Vector2<f64> {
        self.covariance.diagonal().map(|variance| variance.max(0.0).sqrt())
    }

    /// Point and velocity in space, for a scaled orthographic camera: both divided by f/Z0.
    #[must_use]
    pub fn in_space(self, camera: CameraScale) -> Self {
        let per_length = 1.0 / camera.value();
        Self {
            point: self.point * per_length,
            velocity: self.velocity * per_length,
            covariance: self.covariance * (per_length * per_length),
        }
    }

    /// Whether every number is finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.point.iter().chain(&self.velocity).chain(&self.covariance).copied().all(f64::is_finite)
    }
}

impl MotionState {
    /// Velocity of the middle of the object, the centroid of its outline, in image lengths per second. It is where the outline is, so that its covariance
    /// leaves out what is not known of how the outline lies in the body.
    #[must_use]
    pub fn velocity_of_middle(&self) -> PointVelocity {
        self.velocity_by(&self.centroid, &self.covariance)
    }

    /// Velocity of the point of the object that was at `first` in the first frame, in image coordinates. Its covariance includes the
    /// errors of motion and pose. Unobservable parameters enter with their present values.
    #[must_use]
    pub fn velocity_of(&self, first: &Point2<f64>) -> PointVelocity {
        self.velocity_by(&Point2::from((first - self.origin) / self.radius), &self.with_body_frame())
    }

    /// Velocity of a point of the body frame, normalised, by a covariance of pose and motion.
    fn velocity_by(&self, first: &Point2<f64>, covariance: &DMatrix<f64>) -> PointVelocity {
        let k = self.model.parameter_count();
        let point = map_point(&self.pose, first);
        let generator = self.model.generator(&self.motion[..k]);
        let velocity = velocity_at(&generator, &point);
        let basis = self.model.basis();
        let derivatives: Vec<Vector2<f64>> = basis
            .iter()
            .map(|e| {
                // The generator takes an error of the pose along.
                let shift = velocity_at(e, &point);
                let carried = generator * Vector3::new(shift.x, shift.y, 0.0);
                let along = generator.row(2).transpose().dot(&point.to_homogeneous());
                carried.xy() - carried.z * point.coords - along * shift
            })
            .chain(basis.iter().map(|e| velocity_at(e, &point)))
            .collect();
        let derivatives = Matrix2xX::from_columns(&derivatives);
        let covariance = &derivatives * covariance * derivatives.transpose();
        PointVelocity {
            point: self.origin + self.radius * point.coords,
            velocity: self.radius * velocity,
            covariance: self.radius * self.radius * covariance,
        }
    }
}

/// Velocity of a point under the motion with this generator.
#[must_use]
pub fn velocity_at(generator: &Matrix3<f64>, point: &Point2<f64>) -> Vector2<f64> {
    let velocity = generator * point.to_homogeneous();
    velocity.xy() - velocity.z * point.coords
}
