//! Objects that are lost, and come back.
use freeform_curve_fit::Outline;
use freeform_outline_filter::Phase;
use freeform_riccati::{MotionModel, RigidMotion};
use freeform_sim_camera::{BuiltInShape, Camera, Frame, Scene, Settings, Simulator};
use nalgebra::{Affine2, Rotation2, Vector2};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use crate::{
    filter_support::{filter, settings},
    gaps::{gear_with_a_missing_tooth, points_on},
};

const BEFORE: usize = 30;
const LOST: usize = 10;

/// Frames of a shape at rest that has been turned by an angle, rad.
fn at_rest(shape: BuiltInShape, angle: f64, settings: Settings) -> Vec<Frame> {
    let turned = Affine2::from_matrix_unchecked(Rotation2::new(angle).to_homogeneous());
    let scene = Scene::new(shape, RigidMotion::default(), Camera::default()).with_initial_pose(turned);
    Simulator::new(scene, settings).expect("good settings").frames().collect()
}

#[test]
fn a_lost_object_is_found_within_eight_frames_at_whatever_turn_it_comes_back() {
    let mut frames_needed = Vec::new();
    for (number, shape) in
        (0_u32..24).zip([BuiltInShape::Bird, BuiltInShape::Glider, BuiltInShape::Van].into_iter().cycle())
    {
        let angle = 0.13 + std::f64::consts::TAU * f64::from(number) / 24.0;
        let of = |count: usize| Settings { points: 400, ..settings(count, u64::from(number)) };
        let before = at_rest(shape, 0.0, of(BEFORE));
        let another = at_rest(BuiltInShape::Phone, 0.4, of(LOST));
        let again = at_rest(shape, angle, of(8));
        let mut run = filter(MotionModel::Rigid);
        let mut needed = None;
        for (frame, outline) in before.iter().chain(&another).chain(&again).map(|frame| &frame.outline).enumerate() {
            let step = run.step(frame as f64 / 30.0, outline).expect("increasing times");
            if frame < BEFORE {
                assert!(step.is_accepted(), "{shape}, {angle}, frame {frame}");
            } else if frame < BEFORE + LOST {
                assert!(!step.is_accepted(), "{shape}, {angle}, frame {frame}");
            } else if step.is_accepted() && needed.is_none() {
                needed = Some(frame - BEFORE - LOST);
                let turned = run.pose().expect("a pose").matrix().fixed_view::<2, 2>(0, 0).into_owned();
                let found = (turned.m21 - turned.m12).atan2(turned.m11 + turned.m22);
                let error = (found - angle).sin().abs() + (1.0 - (found - angle).cos());
                assert!(error < 0.02, "{shape}, {angle}: {found}");
            }
            if frame + 1 == BEFORE + LOST {
                assert_eq!(run.phase(), Phase::Lost, "{shape}, {angle}");
            }
        }
        frames_needed.push(needed.unwrap_or_else(|| panic!("{shape}, {angle}: not found")));
    }
    // Most turns lie near one of those that are searched first.
    let at_once = frames_needed.iter().filter(|needed| **needed == 0).count();
    assert!(2 * at_once > frames_needed.len(), "{frames_needed:?}");
}

/// The outline lies where the first frame has shown it, and no later frame says more of that. Once the object had been lost the deviations of its
/// positions were two or three times too small: 35 of these were more than three deviations off.
#[test]
fn positions_of_an_object_that_was_lost_are_still_known_no_better_than_its_first_frame() {
    let (mut all, mut off) = (0, 0);
    for seed in 0..24 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let (turns, teeth) = (random.random_range(1.0..2.5), random.random_range(8..16));
        let gear = gear_with_a_missing_tooth(teeth);
        let mut run = filter(MotionModel::Rigid);
        let (mut middle, mut was_lost) = (None, false);
        for frame in 0..60 {
            let time = f64::from(frame) / 15.0;
            // It goes for a second and rests for another.
            let gone = (0.5 * time).floor() + (0.5 * time).fract().min(0.5) * 2.0;
            let (turn, shift) = (turns * gone, Vector2::new(0.9, -0.6) * gone);
            let points = points_on(&gear, 80, (turn, shift), &mut random);
            let outline = Outline::closed(points).expect("an outline");
            let middle = *middle.get_or_insert_with(|| outline.centroid());
            run.step(time, &outline).expect("increasing times");
            was_lost |= run.phase() == Phase::Acquiring && frame > 3;
            let is_found = was_lost && run.phase() == Phase::Tracking && run.segment() == 0;
            let Some(state) = run.state().filter(|_| is_found) else { continue };
            let place = Rotation2::new(turn) * middle + shift;
            for (stated, truth) in state.pose_parameters()[1..].iter().zip([place.x, place.y]) {
                all += 1;
                off += u32::from((stated.value - truth).abs() > 3.0 * stated.standard_deviation);
            }
        }
    }
    assert!(all > 200 && all < 400, "{all} positions");
    assert!(f64::from(off) < 0.03 * f64::from(all), "{off} of {all} positions");
}
