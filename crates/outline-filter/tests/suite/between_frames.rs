//! Work that waits for the next frame, done before it or by it.
use freeform_outline_filter::{FilterSettings, MotionFilter};
use freeform_riccati::{MotionModel, RigidMotion};
use freeform_sim_camera::{BuiltInShape, Frame, Motion, Occlusion, Settings};
use nalgebra::Vector2;
use proptest::prelude::*;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;

use crate::filter_support::{frames_of, settings, stated, told};

const FRAMES: usize = 40;

/// A recording that has some of what makes the motion filter cut its map, and cut it again: symmetric outlines, changes of the motion, falls, wrong and
/// repeated frames, another object.
fn recording(seed: u64) -> Vec<Frame> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let [shape, other] = [0, 1].map(|_| BuiltInShape::ALL[random.random_range(0..BuiltInShape::ALL.len())]);
    let [before, after] = [0, 1].map(|_| RigidMotion {
        omega: random.random_range(-8.0..8.0),
        b1: random.random_range(-1.0..1.0),
        b2: random.random_range(-1.0..1.0),
    });
    let phases = vec![(0.0, before), (random.random_range(0.1..1.3), after)];
    let settings = Settings {
        points: [40, 100, 400][random.random_range(0..3)],
        wrong_frames: if random.random_bool(0.3) { 0.1 } else { 0.0 },
        dropped_frames: if random.random_bool(0.3) { 0.2 } else { 0.0 },
        occlusion: Occlusion { fraction: if random.random_bool(0.2) { 0.2 } else { 0.0 }, ..Occlusion::default() },
        ..settings(FRAMES, seed)
    };
    let mut frames = frames_of(shape, Motion::piecewise(phases).expect("two phases"), settings.clone());
    if random.random_bool(0.3) {
        // It is thrown, by up to a tenth of its size in a frame.
        let fall = Vector2::new(0.0, -random.random_range(5.0..60.0));
        for frame in &mut frames {
            let shift = 0.5 * frame.time * frame.time * fall;
            frame.outline = frame.outline.mapped(|p| p + shift).expect("an outline");
        }
    }
    if random.random_bool(0.3) {
        let others = frames_of(other, RigidMotion { omega: 1.0, b1: 0.0, b2: 0.0 }, settings);
        let from = random.random_range(2..12);
        for index in from..from + random.random_range(1..6) {
            frames[index].outline = others[index].outline.clone();
        }
    }
    if random.random_bool(0.4) {
        for index in 1..frames.len() {
            if random.random_bool(0.15) {
                frames[index].outline = frames[index - 1].outline.clone();
            }
        }
    }
    frames
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    #[test]
    fn results_are_the_same_to_the_last_bit_whenever_what_waits_is_done(
        seed in 0_u64..1_000_000,
        model in proptest::sample::select(vec![MotionModel::Rigid, MotionModel::Rigid, MotionModel::Affine]),
        calls in proptest::collection::vec(prop_oneof![2 => Just(0), 2 => 1_usize..4, 3 => Just(100)], FRAMES),
    ) {
        let settings = FilterSettings { model, ..FilterSettings::default() };
        let filter = || MotionFilter::new(settings).expect("good settings");
        let (mut straight, mut prepared) = (filter(), filter());
        for (index, (frame, calls)) in recording(seed).iter().zip(calls).enumerate() {
            let expected = told(&mut straight, frame);
            prop_assert_eq!(told(&mut prepared, frame), expected, "frame {}", index);
            let after_frame = stated(&straight);
            for call in 0..=calls {
                // What waits is saved, or done before.
                #[cfg(feature = "serde")]
                if (seed as usize + index + call).is_multiple_of(7) {
                    let bytes = prepared.to_bytes().expect("memory takes it");
                    prepared = MotionFilter::from_bytes(&bytes).expect("its own state");
                }
                let is_more_waiting = call < calls && prepared.prepare();
                prop_assert_eq!(&stated(&prepared), &after_frame, "frame {}, call {}", index, call);
                if !is_more_waiting {
                    break;
                }
            }
        }
    }
}
