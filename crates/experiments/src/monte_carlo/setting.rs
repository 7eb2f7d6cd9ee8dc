use freeform_estimate::{BoundaryPoint, CramerRaoBound, PlaneBound};
use freeform_motion::tracker::MotionFamily;
use freeform_riccati::{MotionModel, PinholeCamera, PlaneMotion, ProjectiveMotion, pull_back};
use freeform_sim_camera::{Camera, Occlusion, Sampling, Scene, SequenceLength, Settings, Shape, Simulator};
use nalgebra::Projective2;

use crate::ExperimentError;

/// Places of the outline that the bound is summed over.
const BOUND_PLACES: usize = 1000;

/// A radian, or a length of the size of a unit object, over the whole sequence: as a standard deviation it means that nothing is
/// known. (A circle drawn by cubic pieces is not quite round.)
const NOTHING_KNOWN: f64 = 1.0;

/// Parameters of a plane in space that are evaluated.
const OF_PLANE: [&str; PlaneMotion::PARAMETERS] = ["wx", "wy", "wz", "vx", "vy", "vz", "nx", "ny"];

/// A plane that moves in space before a camera; lengths in the picture are pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PlaneScene {
    /// Its motion, with the normal at the first frame.
    pub motion: PlaneMotion,
    /// The camera.
    pub camera: PinholeCamera,
    /// How large the object would be in the picture if it faced the camera.
    pub size: f64,
}

/// One way to simulate sequences, and what is identified in them.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Setting {
    /// What reports call it.
    pub name: String,
    /// Family of motions that is identified; it must hold `motion`.
    pub model: MotionModel,
    /// The true motion in the image: image lengths per second and 1/s.
    pub motion: ProjectiveMotion,
    /// A plane in space, which is then identified, in place of model and motion.
    pub plane: Option<PlaneScene>,
    /// Length of each sequence, at least 2.
    pub frames: usize,
    /// Frames per second.
    pub fps: f64,
    /// Points on the whole outline.
    pub points: usize,
    /// Standard deviation of the noise on each coordinate, image lengths.
    pub noise: f64,
    /// Share of the outline that is missing at a random place in every frame, in `[0, 1)`.
    pub occlusion: f64,
    /// Share of the points that are wrong, in `[0, 1)`.
    pub outliers: f64,
    /// Share of the frames that show another object, in `[0, 1)`.
    pub wrong_frames: f64,
    /// How the points are spread along the outline.
    pub sampling: Sampling,
}

impl Setting {
    /// The family of motions that is identified.
    #[must_use]
    pub fn family(&self) -> MotionFamily {
        match self.plane {
            Some(_) => MotionFamily::Plane,
            None => self.model.into(),
        }
    }

    /// Names of the parameters that are evaluated; of a plane, x and y of its normal are among them.
    #[must_use]
    pub fn parameter_names(&self) -> &'static [&'static str] {
        match self.plane {
            Some(_) => &OF_PLANE,
            None => self.model.parameter_names(),
        }
    }

    /// The map of the picture that the true motion makes from the first frame on.
    pub(super) fn flow(&self, seconds: f64) -> Projective2<f64> {
        match &self.plane {
            Some(PlaneScene { motion, camera, .. }) => {
                Projective2::from_matrix_unchecked(camera.in_picture(motion.flow(seconds).matrix()))
            }
            None => self.motion.flow(seconds),
        }
    }

    /// What is simulated of a shape.
    pub(super) fn scene(&self, shape: &Shape) -> Scene {
        match self.plane {
            Some(PlaneScene { motion, camera, size }) => Scene::in_space(shape.clone(), motion, camera, size),
            None => Scene::new(shape.clone(), self.motion, Camera::default()),
        }
    }

    /// The true parameters in the order of their names; none where the model does not hold the motion.
    #[must_use]
    pub fn truth(&self) -> Vec<f64> {
        if let Some(plane) = &self.plane {
            return plane.motion.parameters().to_vec();
        }
        self.model.parameters_of_motion(&self.motion).unwrap_or_default()
    }

    /// Time from the first frame to the last, seconds.
    pub(super) fn duration(&self) -> f64 {
        (self.frames - 1) as f64 / self.fps
    }

    /// What makes the sequences of a shape; all that is random follows from `seed`.
    ///
    /// # Errors
    /// What the simulator refuses.
    pub fn simulator(&self, shape: &Shape, seed: u64) -> Result<Simulator, ExperimentError> {
        let settings = Settings {
            fps: self.fps,
            length: SequenceLength::Frames(self.frames),
            points: self.points,
            sampling: self.sampling,
            noise: self.noise,
            occlusion: Occlusion { fraction: self.occlusion, ..Occlusion::default() },
            outliers: self.outliers,
            wrong_frames: self.wrong_frames,
            seed,
            ..Settings::default()
        };
        Ok(Simulator::new(self.scene(shape), settings)?)
    }

    /// The Cramer-Rao bound: the smallest standard deviations of the parameters, 0 without noise. `None` where a parameter is not observable: the
    /// outlines tell nothing of it, or so little that the best estimator would be off by a radian, or a length of a
    /// unit object, over the whole sequence.
    ///
    /// From places spread evenly over the outline, each standing for its share of the points that inform: visible, no
    /// outliers, of the right object. Information is linear in the points, so that their expectation is enough.
    ///
    /// # Errors
    /// A motion that overflows.
    pub fn bound(&self, shape: &Shape) -> Result<Vec<Option<f64>>, ExperimentError> {
        if let Some(plane) = &self.plane {
            return self.bound_of_plane(plane, shape);
        }
        let mut bound = CramerRaoBound::new(self.model, &self.truth())?;
        for frame in 0..self.frames {
            let time = frame as f64 / self.fps;
            // For noise 1: the bound grows in proportion to the noise, which may be 0.
            bound.add_frame(time, places(shape, &self.motion.flow(time)), 1.0, self.weight())?;
        }
        let covariance = bound.covariance()?;
        let known = |std: &f64| std * self.duration() <= NOTHING_KNOWN;
        Ok(covariance.standard_deviations().map(|std| std.map(|std| self.noise * std).filter(known)).collect())
    }
    /// The same of a plane in space: an error of a radian, or of the distance of the plane, over the whole sequence means that nothing
    /// is known, and one of 1 in the normal.
    fn bound_of_plane(&self, plane: &PlaneScene, shape: &Shape) -> Result<Vec<Option<f64>>, ExperimentError> {
        let mut bound = PlaneBound::new(plane.motion, plane.camera)?;
        let scene = self.scene(shape);
        for frame in 0..self.frames {
            let time = frame as f64 / self.fps;
            bound.add_frame(time, places(shape, &scene.true_pose(time)), 1.0, self.weight())?;
        }
        let covariance = bound.covariance()?;
        let deviations = covariance.standard_deviations().enumerate().map(|(index, std)| {
            let seconds = if index < PlaneMotion::NAMES.len() { self.duration() } else { 1.0 };
            std.map(|std| self.noise * std).filter(|std| std * seconds <= NOTHING_KNOWN)
        });
        Ok(deviations.collect())
    }

    /// Points that each place stands for: its share of those that are visible, no outliers, and of the right object.
    fn weight(&self) -> f64 {
        let share = (1.0 - self.occlusion) * (1.0 - self.outliers) * (1.0 - self.wrong_frames);
        share * self.points as f64 / BOUND_PLACES as f64
    }
}

/// Places spread evenly over the outline in a pose.
fn places<'a>(shape: &'a Shape, pose: &Projective2<f64>) -> impl Iterator<Item = BoundaryPoint> + 'a {
    let (pose, back) = (*pose, pose.inverse());
    (0..BOUND_PLACES).map(move |i| {
        let s = (i as f64 + 0.5) / BOUND_PLACES as f64;
        let body = shape.point_at(s);
        let point = pose * body;
        // Distances from the tangent pull back to the body as distances from the tangent there.
        let normal = pull_back(back.matrix(), &point, &body, &shape.normal_at(s)).normalize();
        BoundaryPoint { point, normal }
    })
}
