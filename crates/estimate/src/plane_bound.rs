use freeform_riccati::{MotionModel, PinholeCamera, PlaneMotion, map_point};
use nalgebra::{DMatrix, DVector};

use crate::bound::{BoundCovariance, BoundError, BoundaryPoint, check_frame};

/// Parameters of a pose of the picture.
const POSE: usize = MotionModel::Projective.parameter_count();

/// The Cramer-Rao bound of the motion of a plane in space from the outlines that a perspective camera sees of it: no unbiased estimator of
/// a constant angular velocity and velocity has a smaller covariance, the shape being known and the initial pose in the picture not.
///
/// As the [`CramerRaoBound`](crate::CramerRaoBound), over wx, wy, wz, vx, vy, vz, and x and y of the normal at the first frame (equation 7 of
/// `docs/plane-in-space.md`).
///
/// ```
/// use freeform_estimate::{BoundaryPoint, PlaneBound};
/// use freeform_riccati::{PinholeCamera, PlaneMotion};
/// use nalgebra::{Point2, Vector2, Vector3};
///
/// let camera = PinholeCamera::new(800.0, Point2::new(320.0, 240.0))?;
/// let plane = PlaneMotion {
///     angular_velocity: Vector3::new(0.3, 0.0, 0.8),
///     velocity: Vector3::new(0.2, 0.0, 0.1),
///     normal: Vector3::new(0.5, 0.0, 1.0),
/// };
/// let mut bound = PlaneBound::new(plane, camera)?;
/// for frame in 0..30 {
///     let time = f64::from(frame) / 30.0;
///     let flow = camera.in_picture(plane.flow(time).matrix());
///     let at = |t: f64| freeform_riccati::map_point(&flow, &Point2::new(320.0 + 150.0 * t.cos(), 240.0 + 90.0 * t.sin()));
///     let points = (0..400).map(|i| {
///         let t = std::f64::consts::TAU * f64::from(i) / 400.0;
///         let tangent = at(t + 1e-6) - at(t - 1e-6);
///         BoundaryPoint { point: at(t), normal: Vector2::new(tangent.y, -tangent.x).normalize() }
///     });
///     bound.add_frame(time, points, 0.3, 1.0)?;
/// }
/// // An ellipse leaves three of the eight directions of every pose unseen.
/// assert!(bound.covariance()?.rank < 16);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct PlaneBound {
    motion: PlaneMotion,
    camera: PinholeCamera,
    /// Over the initial pose, then the motion.
    information: DMatrix<f64>,
}

impl PlaneBound {
    /// A bound without any frame yet, at the true motion, z of whose normal is 1.
    ///
    /// # Errors
    /// A parameter that is not finite.
    pub fn new(motion: PlaneMotion, camera: PinholeCamera) -> Result<Self, BoundError> {
        let parameters = motion.parameters();
        if let Some(index) = parameters.iter().position(|value| !value.is_finite()) {
            return Err(BoundError::ParameterNotFinite { index, value: parameters[index] });
        }
        let size = POSE + PlaneMotion::PARAMETERS;
        Ok(Self { motion, camera, information: DMatrix::zeros(size, size) })
    }

    /// Adds the boundary points seen in the picture at a time in seconds since the first frame, each with noise of standard deviation `noise`
    /// in every direction. `weight` is how many observations each stands for.
    ///
    /// # Errors
    /// Noise that is not positive, a time or weight that is not finite.
    pub fn add_frame(
        &mut self,
        time: f64,
        points: impl IntoIterator<Item = BoundaryPoint>,
        noise: f64,
        weight: f64,
    ) -> Result<(), BoundError> {
        check_frame(time, noise, weight)?;
        let model = MotionModel::Projective;
        // In normalised image points, whose lengths are those of the camera: normal displacements are shorter by the focal length.
        let from_picture = self.camera.from_picture();
        let flow = self.motion.flow(time).into_inner();
        let back = flow.try_inverse().ok_or(BoundError::Frame { time, weight })?;
        let by_pose = model.adjoint(&flow, &back);
        let by_motion =
            self.motion.flow_sensitivities(time).map(|derivative| model.parameters_of(&(derivative * back)));
        let mut g = DVector::zeros(POSE + PlaneMotion::PARAMETERS);
        let scale = weight * (self.camera.focal() / noise).powi(2);
        for BoundaryPoint { point, normal } in points {
            let velocities = model.normal_velocities(&map_point(&from_picture, &point), &normal);
            for j in 0..POSE {
                g[j] = (0..POSE).map(|i| velocities[i] * by_pose[i][j]).sum();
            }
            for (j, column) in by_motion.iter().enumerate() {
                g[POSE + j] = velocities.iter().zip(column).map(|(velocity, by)| velocity * by).sum();
            }
            self.information.ger(scale, &g, &g, 1.0);
        }
        Ok(())
    }

    /// The bound from the frames so far, over wx, wy, wz, vx, vy, vz, and x and y of the normal at the first frame.
    ///
    /// # Errors
    /// The information is not finite.
    pub fn covariance(&self) -> Result<BoundCovariance, BoundError> {
        BoundCovariance::of_motion(&self.information, POSE)
    }
}
