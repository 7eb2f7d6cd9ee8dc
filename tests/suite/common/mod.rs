//! What the tests of pipeline and tracker share.
use freeform_motion::{
    Pipeline, PipelineSettings,
    outline_io::OutlineFrame,
    riccati::{CameraScale, RigidMotion},
    sim_camera::{BuiltInShape, Camera, Frame, Scene, SequenceLength, Settings, Simulator},
};

/// A run of so many seconds at 30 frames/s with the paper's noise.
pub(crate) fn seconds(seconds: f64) -> Settings {
    Settings { length: SequenceLength::Seconds(seconds), seed: 1, ..Settings::default() }
}

/// A run of so many frames.
pub(crate) fn frames(count: usize) -> Settings {
    Settings { length: SequenceLength::Frames(count), seed: 1, ..Settings::default() }
}

/// What a camera sees of a shape in motion, with so many points on it in so many frames, as frames of an object.
pub(crate) fn seen_as(
    object: &str,
    (shape, motion): (BuiltInShape, RigidMotion),
    points: usize,
    count: usize,
) -> Vec<OutlineFrame> {
    let settings = Settings { points, ..frames(count) };
    let simulator = Simulator::new(Scene::new(shape, motion, Camera::default()), settings).expect("a simulation");
    let frame = |(frame, seen): (u64, Frame)| OutlineFrame {
        frame,
        time: seen.time,
        object: object.to_owned(),
        outline: seen.outline,
    };
    (0..).zip(simulator.frames()).map(frame).collect()
}

/// The pipeline after a whole simulated run; frames that it rejects are left to its count.
pub(crate) fn identified(scene: Scene, settings: &Settings, pipeline: PipelineSettings) -> Pipeline {
    let mut pipeline = Pipeline::new(pipeline).expect("settings");
    for frame in &Simulator::new(scene, settings.clone()).expect("a simulation") {
        pipeline.push(frame.time, &frame.outline).ok();
    }
    pipeline
}

/// Relative errors of omega and of b in space.
pub(crate) fn rigid_errors(pipeline: &Pipeline, truth: &RigidMotion, scale: f64) -> (f64, f64) {
    let estimate = pipeline.estimate().expect("an estimate").in_space(CameraScale::new(scale).expect("a scale"));
    let v = estimate.values();
    let omega = (v[0] - truth.omega).abs() / truth.omega.abs();
    (omega, (v[1] - truth.b1).hypot(v[2] - truth.b2) / truth.b1.hypot(truth.b2))
}
