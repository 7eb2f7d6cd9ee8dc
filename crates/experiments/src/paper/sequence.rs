//! Simulated outlines of one object, and how it really moves.
use freeform_curve_fit::Outline;
use freeform_riccati::CameraScale;
use freeform_sim_camera::{Motion, PaperExperiment, Scene, SequenceLength, Settings, Simulator};

use crate::ExperimentError;

/// Frames per second where nothing else is said; the paper does not give it.
pub(super) const FPS: f64 = 30.0;

/// Points on each outline; the paper does not give it.
pub(super) const POINTS: usize = 400;

/// Outlines of one object over time, and how it really moves.
pub(super) struct Sequence {
    pub(super) frames: Vec<(f64, Outline)>,
    /// In space.
    pub(super) truth: Motion,
    /// Camera scale f/Z0.
    pub(super) scale: CameraScale,
}

impl Sequence {
    pub(super) fn simulate(scene: Scene, settings: Settings) -> Result<Self, ExperimentError> {
        let (truth, scale) = (scene.motion().clone(), scene.camera().scale());
        let simulator = Simulator::new(scene, settings)?;
        let frames = simulator.frames().map(|frame| (frame.time, frame.outline)).collect();
        Ok(Self { frames, truth, scale })
    }

    /// One of the paper's experiments.
    pub(super) fn of_paper(experiment: &PaperExperiment, seconds: f64, seed: u64) -> Result<Self, ExperimentError> {
        let scene = experiment.scene(PaperExperiment::SCALE)?;
        Self::simulate(scene, paper_settings(seconds, seed))
    }

    /// Time of the last frame in seconds.
    pub(super) fn end(&self) -> f64 {
        self.frames.last().map_or(0.0, |(time, _)| *time)
    }
}

/// How outlines are taken where nothing else is said.
pub(super) fn paper_settings(seconds: f64, seed: u64) -> Settings {
    Settings {
        fps: FPS,
        length: SequenceLength::Seconds(seconds),
        points: POINTS,
        noise: PaperExperiment::NOISE,
        seed,
        ..Settings::default()
    }
}
