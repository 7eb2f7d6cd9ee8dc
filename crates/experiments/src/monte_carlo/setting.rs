use freeform_estimate::{BoundaryPoint, CramerRaoBound};
use freeform_riccati::{MotionModel, ProjectiveMotion, pull_back};
use freeform_sim_camera::{Camera, Occlusion, Sampling, Scene, SequenceLength, Settings, Shape, Simulator};

use crate::ExperimentError;

/// Places of the outline that the bound is summed over.
const BOUND_PLACES: usize = 1000;

/// A radian, or a length of the size of a unit object, over the whole sequence: as a standard deviation it means that nothing is
/// known. (A circle drawn by cubic pieces is not quite round.)
const NOTHING_KNOWN: f64 = 1.0;

/// One way to simulate sequences, and what is identified in them.
#[derive(Debug, Clone)]
pub struct Setting {
    /// What reports call it.
    pub name: String,
    /// Family of motions that is identified; it must hold `motion`.
    pub model: MotionModel,
    /// The true motion in the image: image lengths per second and 1/s.
    pub motion: ProjectiveMotion,
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
    /// The true parameters in the order of the model; none where the model does not hold the motion.
    #[must_use]
    pub fn truth(&self) -> Vec<f64> {
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
        let scene = Scene::new(shape.clone(), self.motion, Camera::default());
        Ok(Simulator::new(scene, settings)?)
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
        let mut bound = CramerRaoBound::new(self.model, &self.truth())?;
        let share = (1.0 - self.occlusion) * (1.0 - self.outliers) * (1.0 - self.wrong_frames);
        let weight = share * self.points as f64 / BOUND_PLACES as f64;
        for frame in 0..self.frames {
            let time = frame as f64 / self.fps;
            let pose = self.motion.flow(time);
            let back = pose.inverse();
            let places = (0..BOUND_PLACES).map(|i| {
                let s = (i as f64 + 0.5) / BOUND_PLACES as f64;
                let body = shape.point_at(s);
                let point = pose * body;
                // Distances from the tangent pull back to the body as distances from the tangent there.
                let normal = pull_back(back.matrix(), &point, &body, &shape.normal_at(s)).normalize();
                BoundaryPoint { point, normal }
            });
            // For noise 1: the bound grows in proportion to the noise, which may be 0.
            bound.add_frame(time, places, 1.0, weight)?;
        }
        let covariance = bound.covariance()?;
        let known = |std: &f64| std * self.duration() <= NOTHING_KNOWN;
        Ok(covariance.standard_deviations().map(|std| std.map(|std| self.noise * std).filter(known)).collect())
    }
}
