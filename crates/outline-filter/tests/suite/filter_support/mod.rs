//! Simulated frames, and filters that have taken them.
use freeform_outline_filter::{FilterSettings, MotionFilter};
use freeform_riccati::MotionModel;
use freeform_sim_camera::{Camera, Frame, Motion, Sampling, Scene, SequenceLength, Settings, Shape, Simulator};

pub(crate) fn frames_of(shape: impl Into<Shape>, motion: impl Into<Motion>, settings: Settings) -> Vec<Frame> {
    let scene = Scene::new(shape, motion, Camera::default());
    Simulator::new(scene, settings).expect("good settings").frames().collect()
}

pub(crate) fn settings(frames: usize, seed: u64) -> Settings {
    Settings { length: SequenceLength::Frames(frames), sampling: Sampling::Independent, seed, ..Settings::default() }
}

pub(crate) fn filter(model: MotionModel) -> MotionFilter {
    MotionFilter::new(FilterSettings { model, ..FilterSettings::default() }).expect("good settings")
}

pub(crate) fn filtered(model: MotionModel, frames: &[Frame]) -> MotionFilter {
    let mut filter = filter(model);
    for frame in frames {
        filter.step(frame.time, &frame.outline).expect("increasing times");
    }
    filter
}
