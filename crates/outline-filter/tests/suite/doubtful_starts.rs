//! First frames that are wrong.
use crate::filter_support::{filtered, frames_of, settings};
use freeform_outline_filter::{Phase, Unstated};
use freeform_riccati::{MotionModel, RigidMotion};
use freeform_sim_camera::BuiltInShape;

const MOTION: RigidMotion = RigidMotion { omega: std::f64::consts::FRAC_PI_2, b1: -0.3, b2: 0.4 };

#[test]
fn after_a_wrong_first_frame_another_wrong_one_begins_no_map_where_two_agree() {
    for seed in 0..4 {
        let mut frames = frames_of(BuiltInShape::Shoe, MOTION, settings(40, seed));
        let [van, glider] =
            [BuiltInShape::Van, BuiltInShape::Glider].map(|shape| frames_of(shape, MOTION, settings(4, seed)));
        frames[0].outline = van[0].outline.clone();
        frames[3].outline = glider[3].outline.clone();
        let run = filtered(MotionModel::Rigid, &frames);
        // The second and the third frame have been rejected before the map was begun with the second.
        assert_eq!((run.restarts(), run.frames_rejected()), (1, 3), "seed {seed}");
        let omega = run.estimate().expect("an estimate").parameters().next().expect("omega comes first");
        let (value, std) = (omega.value.expect("stated"), omega.standard_deviation.expect("known"));
        assert!((value - MOTION.omega).abs() < 5.0 * std && std < 0.01, "seed {seed}: {value}, std {std}");
    }
}

#[test]
fn one_frame_that_agrees_with_the_first_against_two_states_no_motion_and_another_does() {
    let mut frames = frames_of(BuiltInShape::Bird, MOTION, settings(5, 5));
    let others = frames_of(BuiltInShape::Van, MOTION, settings(5, 5));
    (1..3).for_each(|index| frames[index].outline = others[index].outline.clone());
    let four = filtered(MotionModel::Rigid, &frames[..4]);
    assert_eq!(four.phase(), Phase::Tracking);
    assert_eq!(four.unstated(), Some(Unstated::ManyRejected { rejected: 2, frames: 4 }));
    assert!(four.estimate().expect("an estimate").parameters().all(|parameter| parameter.value.is_none()));
    let five = filtered(MotionModel::Rigid, &frames);
    assert_eq!(five.unstated(), None);
    assert!(five.estimate().expect("an estimate").parameters().all(|parameter| parameter.value.is_some()));
}
