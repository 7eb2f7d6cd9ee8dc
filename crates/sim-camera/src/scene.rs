use freeform_riccati::{PinholeCamera, PlaneMotion, ProjectiveMotion};
use nalgebra::{Affine2, Matrix3, Point2, Projective2, Rotation3, Vector3};

use crate::{camera::Camera, motion::Motion, shape::Shape};

/// A flat object, its motion and the camera that looks at it.
///
/// **Units.** The motion is given in the object's plane, in space lengths; the camera scales it by `f/Z0`. The shape and
/// the initial pose are given *in the image*: a unit-size shape has diameter 1 there, which makes the object itself
/// `Z0/f` across. So with a scale of 0.1 and `b = (-3, 4)` in space, the image of a unit-size object moves with
/// `b = (-0.3, 0.4)`. Noise and all other corruption are lengths in the image too.
///
/// At time 0 the shape stands as its initial pose says, by default as drawn: a built-in one centred at the image origin.
#[derive(Debug, Clone)]
pub struct Scene {
    shape: Shape,
    motion: Motion,
    camera: Camera,
    initial_pose: Projective2<f64>,
}

impl Scene {
    /// A scene whose object starts as its shape is drawn.
    #[must_use]
    pub fn new(shape: impl Into<Shape>, motion: impl Into<Motion>, camera: Camera) -> Self {
        Self { shape: shape.into(), motion: motion.into(), camera, initial_pose: Projective2::identity() }
    }

    /// This scene with another initial pose: `pose` maps the shape to its place in the first image.
    #[must_use]
    pub fn with_initial_pose(mut self, pose: Affine2<f64>) -> Self {
        self.initial_pose = nalgebra::convert(pose);
        self
    }

    /// A scene whose object moves in space before a perspective camera. At time 0 the origin of the shape is on the optical axis, where the
    /// plane is at distance 1, tilted as its normal says; a shape of diameter 1 that faced the camera there would be `size` across in
    /// the picture. All lengths are those of the picture.
    #[must_use]
    pub fn in_space(shape: impl Into<Shape>, motion: PlaneMotion, camera: PinholeCamera, size: f64) -> Self {
        let scale = size / camera.focal();
        let tilt = Rotation3::rotation_between(&Vector3::z(), &motion.normal).unwrap_or_default();
        let [across, along] = [Vector3::x(), Vector3::y()].map(|axis| scale * (tilt * axis));
        let start = camera.to_picture() * Matrix3::from_columns(&[across, along, Vector3::z()]);
        Self {
            shape: shape.into(),
            motion: Motion::of_plane(motion, camera),
            camera: Camera::default(),
            initial_pose: Projective2::from_matrix_unchecked(start),
        }
    }

    /// The shape in the body frame, image lengths.
    #[must_use]
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// The motion in the object's plane, space lengths.
    #[must_use]
    pub fn motion(&self) -> &Motion {
        &self.motion
    }

    /// The camera.
    #[must_use]
    pub fn camera(&self) -> Camera {
        self.camera
    }

    /// The motion in the image at a time in seconds: what identification without the camera's scale is to find.
    #[must_use]
    pub fn image_motion(&self, time: f64) -> ProjectiveMotion {
        self.camera.image_motion(&self.motion.at(time))
    }

    /// The map from the body frame to the image at a time in seconds, not negative.
    #[must_use]
    pub fn true_pose(&self, time: f64) -> Projective2<f64> {
        self.image_flow(0.0, time) * self.initial_pose
    }

    /// The map of the image plane between two times in seconds, the second not before the first.
    #[must_use]
    pub fn image_flow(&self, from: f64, to: f64) -> Projective2<f64> {
        self.camera.image_map(&self.motion.flow(from, to))
    }

    /// `count` exact points of the outline at a time in seconds, equally spaced in the body frame, counter-clockwise
    /// unless the pose is a reflection.
    #[must_use]
    pub fn true_outline(&self, time: f64, count: usize) -> Vec<Point2<f64>> {
        let pose = self.true_pose(time);
        self.shape.sample(count, 0.0).iter().map(|p| pose * p).collect()
    }
}
