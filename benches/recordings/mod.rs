//! Recordings whose steps are timed or counted.
use freeform_motion::{
    curve_fit::Outline,
    riccati::RigidMotion,
    sim_camera::{BuiltInShape, Camera, Motion, Scene, SequenceLength, Settings, Simulator},
};
use nalgebra::Point2;

pub(crate) const POINTS: usize = 400;
pub(crate) const FRAMES: usize = 400;
const FRAMES_PER_SECOND: f64 = 30.0;
/// Frames from which on the motions go on.
const CHANGES: [u32; 3] = [0, 40, 150];
/// Frames that show another object in place of the one followed, which is lost by that and looked for afterwards.
const LOST: std::ops::Range<usize> = 250..270;

/// A recording of one shape, whose motion changes twice, with noise of its own.
pub(crate) fn recording(number: usize) -> Vec<(f64, Outline)> {
    let shape = BuiltInShape::ALL[number % BuiltInShape::ALL.len()];
    let other = BuiltInShape::ALL[(number + 3) % BuiltInShape::ALL.len()];
    let rate = |i: usize| 0.4 + 0.3 * ((number + i) % 7) as f64;
    let motions = [
        RigidMotion { omega: rate(0), b1: 0.3, b2: -0.2 },
        RigidMotion { omega: -rate(1), b1: -0.1, b2: 0.4 },
        RigidMotion { omega: rate(2), b1: 0.0, b2: 0.1 },
    ];
    let phases: Vec<_> = CHANGES.iter().map(|frame| f64::from(*frame) / FRAMES_PER_SECOND).zip(motions).collect();
    let outlines = |shape: BuiltInShape| {
        let motion = Motion::piecewise(phases.clone()).expect("motions");
        let scene = Scene::new(shape, motion, Camera::new(0.1).expect("a scale"));
        let settings = Settings {
            points: POINTS,
            length: SequenceLength::Frames(FRAMES),
            fps: FRAMES_PER_SECOND,
            seed: number as u64,
            ..Settings::default()
        };
        let simulator = Simulator::new(scene, settings).expect("settings");
        simulator.frames().map(|frame| (frame.time, frame.outline)).collect::<Vec<_>>()
    };
    let (mut frames, others) = (outlines(shape), outlines(other));
    frames[LOST].clone_from_slice(&others[LOST]);
    frames
}

/// The frames of a recording of a body that is thrown, whose way bends by two to ten hundredths of its size from step to step.
#[allow(dead_code, reason = "only steps that are counted are of such bodies")]
pub(crate) fn thrown(number: usize) -> Vec<(f64, Outline)> {
    let bend = 0.02 + 0.01 * (number % 9) as f64;
    // The shapes are about one unit long.
    let fall = -bend * FRAMES_PER_SECOND * FRAMES_PER_SECOND;
    let mut frames = recording(number);
    frames.truncate(CHANGES[1] as usize);
    for (time, outline) in &mut frames {
        let moved = outline.mapped(|p| Point2::new(p.x, p.y + 0.5 * fall * *time * *time));
        *outline = moved.expect("an outline");
    }
    frames
}
