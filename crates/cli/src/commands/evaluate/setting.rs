use freeform_motion::estimate::{BoundaryPoint, CramerRaoBound};
use freeform_motion::riccati::{AffineMotion, MotionModel};
use freeform_motion::sim_camera::{Camera, Occlusion, Sampling, Scene, SequenceLength, Settings, Shape, Simulator};
use nalgebra::Vector2;

use crate::args::{DisturbanceArgs, EvaluateArgs, MotionChoice, SamplingChoice};
use crate::failure::Failure;
use crate::truth::parameters_in;

/// Places of the outline that the bound is summed over.
const BOUND_PLACES: usize = 1000;

/// A radian, or a length of the size of a unit object, over the whole sequence: as a standard deviation it means that nothing is
/// known. (A circle drawn by cubic pieces is not quite round.)
const NOTHING_KNOWN: f64 = 1.0;

/// One way to simulate sequences, and what is identified in them.
#[derive(Debug, Clone)]
pub(crate) struct Setting {
    pub(crate) name: String,
    pub(crate) model: MotionModel,
    /// In the image.
    pub(crate) motion: AffineMotion,
    pub(crate) frames: usize,
    pub(crate) fps: f64,
    pub(crate) points: usize,
    pub(crate) noise: f64,
    pub(crate) occlusion: f64,
    pub(crate) outliers: f64,
    /// Share of the frames that show another object.
    pub(crate) wrong_frames: f64,
    pub(crate) sampling: Sampling,
}

impl SamplingChoice {
    /// The same for the simulator.
    pub(super) fn sampling(self) -> Sampling {
        match self {
            Self::Independent => Sampling::Independent,
            Self::Stratified => Sampling::default(),
        }
    }
}

impl Setting {
    /// One setting for each length of sequence that was asked for.
    pub(super) fn all_from_args(args: &EvaluateArgs) -> Result<Vec<Self>, Failure> {
        let camera = args.motion_in_space.camera().map_err(Failure::unusable)?;
        let motion = camera.image_motion(&args.motion_in_space.motion());
        let default = if args.motion_in_space.is_affine() { MotionChoice::Affine } else { MotionChoice::Rigid };
        let model = args.motion.unwrap_or(default).model();
        if parameters_in(model, &motion).is_none() {
            return Err(Failure::unusable(format_args!("--motion {model} does not hold the motion of --affine")));
        }
        let of_seconds = |seconds: &f64| {
            let length = SequenceLength::Seconds(*seconds);
            Settings { fps: args.fps, length, ..Settings::default() }.frame_count().map_err(Failure::unusable)
        };
        let mut lengths = args.frames.clone();
        lengths.extend(args.seconds.iter().map(of_seconds).collect::<Result<Vec<_>, _>>()?);
        if lengths.is_empty() {
            lengths = vec![3, 8, 30, 120];
        }
        if let Some(short) = lengths.iter().find(|frames| **frames < 2) {
            return Err(Failure::unusable(format_args!("a sequence of {short} frame(s) shows no motion")));
        }
        let DisturbanceArgs { noise, occlusion, outliers } = args.disturbance;
        let setting = |frames| Self {
            name: format!("{frames} frames"),
            model,
            motion,
            frames,
            fps: args.fps,
            points: args.points,
            noise,
            occlusion,
            outliers,
            wrong_frames: args.wrong_frames,
            sampling: args.sampling.sampling(),
        };
        Ok(lengths.into_iter().map(setting).collect())
    }

    /// The true parameters in the order of the model.
    pub(crate) fn truth(&self) -> Vec<f64> {
        // Checked where settings are made.
        parameters_in(self.model, &self.motion).unwrap_or_default()
    }

    /// Time from the first frame to the last.
    pub(super) fn duration(&self) -> f64 {
        (self.frames - 1) as f64 / self.fps
    }

    /// Makes the sequences.
    pub(super) fn simulator(&self, shape: &Shape, seed: u64) -> Result<Simulator, Failure> {
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
        Simulator::new(scene, settings).map_err(Failure::unusable)
    }

    /// The smallest standard deviations of the parameters, 0 without noise. `None` where a parameter is not observable: the
    /// outlines tell nothing of it, or so little that the best estimator would be off by [`NOTHING_KNOWN`].
    ///
    /// From places spread evenly over the outline, each standing for its share of the points that inform: visible, no
    /// outliers, of the right object. Information is linear in the points, so that their expectation is enough.
    pub(super) fn bound(&self, shape: &Shape) -> Result<Vec<Option<f64>>, Failure> {
        let mut bound = CramerRaoBound::new(self.model, &self.truth()).map_err(Failure::unusable)?;
        let share = (1.0 - self.occlusion) * (1.0 - self.outliers) * (1.0 - self.wrong_frames);
        let weight = share * self.points as f64 / BOUND_PLACES as f64;
        for frame in 0..self.frames {
            let time = frame as f64 / self.fps;
            let pose = self.motion.flow(time);
            let linear = pose.matrix().fixed_view::<2, 2>(0, 0).into_owned();
            let cofactor = linear.try_inverse().unwrap_or_default().transpose();
            let places = (0..BOUND_PLACES).map(|i| {
                let s = (i as f64 + 0.5) / BOUND_PLACES as f64;
                let normal: Vector2<f64> = (cofactor * shape.normal_at(s).into_inner()).normalize();
                BoundaryPoint { point: pose * shape.point_at(s), normal }
            });
            // For noise 1: the bound grows in proportion to the noise, which may be 0.
            bound.add_frame(time, places, 1.0, weight).map_err(Failure::unusable)?;
        }
        let covariance = bound.covariance().map_err(Failure::unusable)?;
        let known = |std: &f64| std * self.duration() <= NOTHING_KNOWN;
        Ok(covariance.standard_deviations().map(|std| std.map(|std| self.noise * std).filter(known)).collect())
    }
}
