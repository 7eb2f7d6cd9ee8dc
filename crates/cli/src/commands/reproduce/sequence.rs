//! Simulated outlines of one object, and how it really moves.
use freeform_motion::curve_fit::Outline;
use freeform_motion::riccati::CameraScale;
use freeform_motion::sim_camera::{Motion, PaperExperiment, Scene, SequenceLength, Settings, Simulator};

use crate::failure::Failure;

/// Frames per second where nothing else is said; the paper does not give it.
pub(crate) const FPS: f64 = 30.0;

/// Points on each outline; the paper does not give it.
pub(crate) const POINTS: usize = 400;

/// Outlines of one object over time, and how it really moves.
pub(crate) struct Sequence {
    pub(crate) frames: Vec<(f64, Outline)>,
    /// In space.
    pub(crate) truth: Motion,
    /// Camera scale f/Z0.
    pub(crate) scale: CameraScale,
}

impl Sequence {
    pub(crate) fn simulate(scene: Scene, settings: Settings) -> Result<Self, Failure> {
        let (truth, scale) = (scene.motion().clone(), scene.camera().scale());
        let simulator = Simulator::new(scene, settings).map_err(Failure::unusable)?;
        let frames = simulator.frames().map(|frame| (frame.time, frame.outline)).collect();
        Ok(Self { frames, truth, scale })
    }

    /// One of the paper's experiments.
    pub(crate) fn of_paper(experiment: &PaperExperiment, seconds: f64, seed: u64) -> Result<Self, Failure> {
        let scene = experiment.scene(PaperExperiment::SCALE).map_err(Failure::unusable)?;
        Self::simulate(scene, paper_settings(seconds, seed))
    }

    /// Time of the last frame in seconds.
    pub(crate) fn end(&self) -> f64 {
        self.frames.last().map_or(0.0, |(time, _)| *time)
    }
}

/// How outlines are taken where nothing else is said.
pub(crate) fn paper_settings(seconds: f64, seed: u64) -> Settings {
    Settings {
        fps: FPS,
        length: SequenceLength::Seconds(seconds),
        points: POINTS,
        noise: PaperExperiment::NOISE,
        seed,
        ..Settings::default()
    }
}
