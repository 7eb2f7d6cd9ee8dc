//! A pipeline saved and restored goes on as before, to the last bit.
use freeform_motion::{
    Pipeline, PipelineSettings,
    curve_fit::{Degree, Outline},
    estimate::{StateError, StateFormat},
    riccati::{AffineMotion, MotionModel, RigidMotion},
    sim_camera::{BuiltInShape, Camera, Motion, Occlusion, Scene, SequenceLength, Settings, Simulator},
};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

/// Bytes before the state proper.
const HEADER: usize = 16;

const FORMAT: StateFormat = StateFormat { version: 1, kind: *b"pipe", name: "pipeline" };

fn frames(motion: impl Into<Motion>, hidden: f64) -> Vec<(f64, Outline)> {
    let occlusion = Occlusion { fraction: hidden, ..Occlusion::default() };
    let settings =
        Settings { length: SequenceLength::Frames(14), points: 120, noise: 0.002, occlusion, ..Settings::default() };
    let scene = Scene::new(BuiltInShape::Bird, motion, Camera::default());
    let simulator = Simulator::new(scene, settings).expect("a simulation");
    simulator.frames().map(|seen| (seen.time, seen.outline)).collect()
}

/// Sequences with what is followed in each of them: far from where it began, with hidden arcs, with more lines.
fn sequences() -> Vec<(PipelineSettings, Vec<(f64, Outline)>)> {
    let rigid = RigidMotion { omega: 1.5, b1: 0.4, b2: -0.2 };
    let far = RigidMotion { omega: 0.2, b1: 30.0, b2: 4.0 };
    let affine = AffineMotion { a1: 0.1, a2: 0.9, a3: -1.2, a4: -0.05, b1: 0.3, b2: 0.2 };
    let mut octic = PipelineSettings::for_model(MotionModel::Rigid);
    octic.fit.degree = Degree::Octic;
    let mut started = PipelineSettings::for_model(MotionModel::Rigid);
    started.identify.initial_values = vec![1.0, 0.5, 0.0];
    vec![
        (PipelineSettings::default(), frames(rigid, 0.0)),
        (octic, frames(rigid, 0.0)),
        (started, frames(far, 0.0)),
        (PipelineSettings::for_model(MotionModel::Affine), frames(affine, 0.15)),
        (PipelineSettings::for_model(MotionModel::Projective), frames(affine, 0.0)),
    ]
}

#[test]
fn a_restored_pipeline_goes_on_to_the_last_bit() {
    for (settings, frames) in sequences() {
        let model = settings.identify.model;
        let mut straight = Pipeline::new(settings).expect("settings");
        let mut interrupted = straight.clone();
        for (time, outline) in &frames {
            let bytes = interrupted.to_bytes().expect("memory");
            interrupted = Pipeline::from_bytes(&bytes).expect("a saved state");
            assert_eq!(interrupted.to_bytes().expect("memory"), bytes);
            assert_eq!(interrupted.push(*time, outline), straight.push(*time, outline), "{model} at {time}");
        }
        // A frame that is refused leaves a state too.
        assert!(straight.push(0.0, &frames[0].1).is_err() && interrupted.push(0.0, &frames[0].1).is_err());
        let restored = Pipeline::from_bytes(&interrupted.to_bytes().expect("memory")).expect("a saved state");
        assert_eq!((restored.estimate(), restored.warnings()), (straight.estimate(), straight.warnings()));
        assert_eq!((restored.frames(), restored.frames_rejected()), (15, 1));
        assert!(straight.estimate().is_some(), "{model}");
    }
}

#[test]
fn what_is_no_state_of_a_pipeline_is_refused() {
    let bytes = Pipeline::new(PipelineSettings::default()).expect("settings").to_bytes().expect("memory");
    let error = |bytes: &[u8]| Pipeline::from_bytes(bytes).err();
    assert_eq!(error(&bytes[..7]), Some(StateError::TooShort { found: 7, needed: HEADER }));
    assert_eq!(error(&bytes[..bytes.len() - 1]), Some(StateError::Damaged));
    let mut later = bytes.clone();
    later[0] += 1;
    assert_eq!(error(&later), Some(StateError::Version { found: 2, supported: 1 }));
    let longer = FORMAT.with_header(&[&bytes[HEADER..], &[0]].concat());
    assert_eq!(error(&longer), Some(StateError::Inconsistent { part: "bytes left over" }));
}

#[test]
fn forged_states_of_pipelines_are_refused_or_can_be_worked_with() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let (mut accepted, mut refused) = (0, 0);
    for (settings, frames) in sequences() {
        let mut pipeline = Pipeline::new(settings).expect("settings");
        for (time, outline) in &frames[..8] {
            pipeline.push(*time, outline).expect("a frame");
        }
        let state = pipeline.to_bytes().expect("memory").split_off(HEADER);
        for _ in 0..60 {
            let mut forged = state.clone();
            for _ in 0..rng.random_range(1..4) {
                let place = rng.random_range(0..forged.len());
                match rng.random_range(0..3) {
                    0 => forged[place] = rng.random(),
                    1 => forged[place] ^= 1 << rng.random_range(0..8),
                    _ => forged[place..(place + 8).min(state.len())].fill([0, 255][rng.random_range(0..2)]),
                }
            }
            let Ok(mut pipeline) = Pipeline::from_bytes(&FORMAT.with_header(&forged)) else {
                refused += 1;
                continue;
            };
            accepted += 1;
            for (time, outline) in &frames[8..] {
                // Any answer will do.
                let _ = (pipeline.push(*time, outline), pipeline.estimate(), pipeline.warnings());
            }
        }
    }
    assert!(accepted > 50 && refused > 50, "{accepted} {refused}");
}
