//! A filter saved and restored goes on as before to the last bit, and no bytes make a filter that cannot be worked with.
use crate::filter_support::{filtered, frames_of, settings, told};
use freeform_curve_fit::Outline;
use freeform_outline_filter::{Dynamics, FilterSettings, MotionFilter, StateError, state_format};
use freeform_riccati::{AffineMotion, MotionModel, RigidMotion};
use freeform_sim_camera::{BuiltInShape, Frame, Motion, Occlusion, Settings};
use nalgebra::{Point2, Vector2};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

const MOTION: RigidMotion = RigidMotion { omega: 1.5, b1: -0.3, b2: 0.4 };

fn saved_and_restored(filter: &MotionFilter) -> MotionFilter {
    MotionFilter::from_bytes(&filter.to_bytes().expect("memory takes it")).expect("a saved state")
}

/// Saves and restores at some of the frames; everything must be as without.
fn assert_goes_on_alike(model: MotionModel, frames: &[Frame], every: usize) {
    assert_goes_on_alike_with(FilterSettings { model, ..FilterSettings::default() }, frames, every);
}

fn assert_goes_on_alike_with(settings: FilterSettings, frames: &[Frame], every: usize) {
    let filter = || MotionFilter::new(settings).expect("good settings");
    let (mut straight, mut interrupted) = (filter(), filter());
    for (index, frame) in frames.iter().enumerate() {
        if index % every == 0 {
            interrupted = saved_and_restored(&interrupted);
        }
        assert_eq!(told(&mut interrupted, frame), told(&mut straight, frame), "{settings:?}, frame {index}");
    }
    assert_eq!(interrupted.to_bytes(), straight.to_bytes());
}

#[test]
fn a_restored_filter_goes_on_to_the_last_bit_for_every_model_and_at_every_frame() {
    let frames = frames_of(BuiltInShape::Bird, MOTION, settings(20, 1));
    MotionModel::ALL.iter().for_each(|model| assert_goes_on_alike(*model, &frames, 1));
}

#[test]
fn a_restored_filter_goes_on_alike_through_hidden_arcs_outliers_wrong_frames_and_gaps() {
    let hard = Settings {
        occlusion: Occlusion { fraction: 0.3, ..Occlusion::default() },
        outliers: 0.05,
        wrong_frames: 0.2,
        dropped_frames: 0.2,
        ..settings(60, 2)
    };
    assert_goes_on_alike(MotionModel::Rigid, &frames_of(BuiltInShape::Van, MOTION, hard), 3);
}

#[test]
fn a_restored_filter_goes_on_alike_while_turns_are_in_doubt_and_where_none_is_seen() {
    for shape in [BuiltInShape::Ellipse, BuiltInShape::Square, BuiltInShape::Circle, BuiltInShape::CdBox] {
        assert_goes_on_alike(MotionModel::Rigid, &frames_of(shape, MOTION, settings(15, 3)), 1);
    }
}

#[test]
fn a_restored_filter_goes_on_alike_while_the_motion_changes_and_after_the_object_was_lost() {
    let turned = AffineMotion::from(RigidMotion { omega: -1.0, b1: 0.5, b2: 0.1 });
    let motion = Motion::piecewise(vec![(0.0, MOTION.into()), (0.7, turned)]).expect("two phases");
    let mut frames = frames_of(BuiltInShape::Bird, motion, settings(60, 4));
    let other = frames_of(BuiltInShape::Square, MOTION, settings(60, 5));
    for index in 30..45 {
        frames[index].outline = other[index].outline.clone();
    }
    assert_goes_on_alike(MotionModel::Rigid, &frames, 2);
}

#[test]
fn a_restored_filter_goes_on_alike_whatever_the_dynamics_and_whatever_the_outlines_do_beside_their_motion() {
    // Along a parabola, by a camera that comes nearer: what the model leaves out is told, and errors are widened by it.
    let mut frames = frames_of(BuiltInShape::Van, RigidMotion { omega: 2.0, b1: 0.0, b2: 0.0 }, settings(100, 9));
    for frame in &mut frames {
        let (t, points) = (frame.time, frame.outline.points().copied());
        let moved = points.map(|p| Point2::from((1.0 + 0.02 * t) * p.coords + Vector2::new(t, 0.8 * t * t)));
        frame.outline = Outline::closed(moved.collect()).expect("an outline");
    }
    for dynamics in Dynamics::ALL {
        let settings = FilterSettings { dynamics, edge_uncertainty: 0.01, ..FilterSettings::default() };
        assert_goes_on_alike_with(settings, &frames, 3);
    }
    assert!(filtered(MotionModel::Rigid, &frames).wrong_family().is_some());
    assert!(filtered(MotionModel::Rigid, &frames).dynamics().is_some_and(|weights| weights.generator < 0.5));
}

#[test]
fn a_restored_filter_goes_on_alike_whether_a_second_is_a_nanosecond_or_a_year() {
    for unit in [1e-9, 3e7] {
        let mut frames = frames_of(BuiltInShape::Bird, MOTION, settings(10, 10));
        frames.iter_mut().for_each(|frame| frame.time *= unit);
        assert_goes_on_alike(MotionModel::Rigid, &frames, 1);
    }
}

fn saved() -> Vec<u8> {
    let frames = frames_of(BuiltInShape::Square, MOTION, Settings { points: 60, ..settings(5, 6) });
    filtered(MotionModel::Rigid, &frames).to_bytes().expect("memory takes it")
}

#[test]
fn the_state_of_an_outline_of_400_points_takes_less_than_100_kilobytes() {
    let filter = filtered(MotionModel::Rigid, &frames_of(BuiltInShape::Bird, MOTION, settings(60, 7)));
    let size = filter.to_bytes().expect("memory takes it").len();
    assert!((10_000..100_000).contains(&size), "{size}");
}

#[test]
fn bytes_cut_off_added_or_changed_are_refused() {
    let bytes = saved();
    assert!(MotionFilter::from_bytes(&bytes).is_ok());
    for length in (0..200).chain((200..bytes.len()).step_by(997)).chain([bytes.len() - 1]) {
        let expected =
            if length < 16 { StateError::TooShort { found: length, needed: 16 } } else { StateError::Damaged };
        assert_eq!(MotionFilter::from_bytes(&bytes[..length]).err(), Some(expected), "{length} bytes");
    }
    assert_eq!(MotionFilter::from_bytes(&[&bytes[..], &[0]].concat()).err(), Some(StateError::Damaged));
    for place in (8..200).chain((200..bytes.len()).step_by(997)) {
        let mut changed = bytes.clone();
        changed[place] ^= 0x10;
        assert_eq!(MotionFilter::from_bytes(&changed).err(), Some(StateError::Damaged), "byte {place}");
    }
}

#[test]
fn states_of_another_version_or_kind_are_told() {
    let bytes = saved();
    let mut later = bytes.clone();
    later[0] += 1;
    assert_eq!(MotionFilter::from_bytes(&later).err(), Some(StateError::Version { found: 36, supported: 35 }));
    let other = state_format(*b"else", "filter").with_header(&bytes[16..]);
    assert_eq!(MotionFilter::from_bytes(&other).err(), Some(StateError::Kind { expected: "filter" }));
    let longer = state_format(*b"filt", "filter").with_header(&[&bytes[16..], &[0]].concat());
    assert_eq!(MotionFilter::from_bytes(&longer).err(), Some(StateError::Inconsistent { part: "bytes left over" }));
}

#[test]
fn forged_states_are_refused_or_can_be_worked_with() {
    let bytes = saved();
    let outlines: Vec<Outline> = frames_of(BuiltInShape::Square, MOTION, Settings { points: 60, ..settings(12, 8) })
        .into_iter()
        .map(|f| f.outline)
        .collect();
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut accepted = 0;
    for _ in 0..400 {
        let mut state = bytes[16..].to_vec();
        for _ in 0..rng.random_range(1..4) {
            // Lengths and counts stand all over the state; half of the changes fall on its beginning.
            let end = if rng.random() { 300 } else { state.len() };
            let place = rng.random_range(0..end);
            match rng.random_range(0..3) {
                0 => state[place] = rng.random(),
                1 => state[place] ^= 1 << rng.random_range(0..8),
                _ => state[place..(place + 8).min(bytes.len() - 16)].fill([0, 255][rng.random_range(0..2)]),
            }
        }
        let Ok(mut filter) = MotionFilter::from_bytes(&state_format(*b"filt", "filter").with_header(&state)) else {
            continue;
        };
        accepted += 1;
        for (index, outline) in outlines.iter().enumerate() {
            // Any answer will do.
            let _ = filter.step(0.2 + index as f64 / 30.0, outline);
            let _ = (filter.state(), filter.velocity(), filter.ambiguity(), filter.outline_points().count());
            let _ = (filter.aliases(), filter.dynamics(), filter.wrong_family(), filter.unstated());
        }
    }
    assert!(accepted > 15, "{accepted}");
}
