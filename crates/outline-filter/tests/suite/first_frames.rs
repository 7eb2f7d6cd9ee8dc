//! What is stated after few frames: of a motion that changes, and of one that does not.
use crate::filter_support::{filter, frames_of, omega_of, settings};
use freeform_outline_filter::{Dynamics, FilterSettings, MotionFilter};
use freeform_riccati::{MotionModel, RigidMotion};
use freeform_sim_camera::{self as sim_camera, BuiltInShape, Motion, Settings, Trajectory};
use nalgebra::{Point2, Vector2};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

const SHAPES: [BuiltInShape; 4] = [BuiltInShape::Bird, BuiltInShape::Phone, BuiltInShape::Van, BuiltInShape::Hat];

/// Errors of the angular velocity in its deviations, in all frames from the third to the last: of a body that moves along a path.
fn errors_along(path: Trajectory, shape: BuiltInShape, settings: Settings) -> Vec<f64> {
    let mut run = filter(MotionModel::Rigid);
    let mut errors = Vec::new();
    for frame in &frames_of(shape, Motion::varying(move |t| path.motion(t)), settings) {
        run.step(frame.time, &frame.outline).expect("increasing times");
        let stated = omega_of(&run).filter(|_| frame.index > 1);
        errors.extend(stated.map(|(value, deviation)| (value - path.omega(frame.time)).abs() / deviation));
    }
    errors
}

/// As these, of bodies whose spin grows from the first of fifteen frames on by so much in a second, while they run straight.
fn errors(spin: f64) -> Vec<f64> {
    let mut errors = Vec::new();
    for (number, shape) in SHAPES.into_iter().enumerate() {
        let dynamics = sim_camera::Dynamics::Accelerating { spin, middle: Vector2::zeros() };
        let path = Trajectory::new(Point2::origin(), 1.2, Vector2::new(0.3, -0.2), dynamics).expect("finite numbers");
        for seed in 0..3 {
            let settings = Settings { noise: 0.004, ..settings(15, seed + 10 * number as u64) };
            errors.extend(errors_along(path, shape, settings));
        }
    }
    errors
}

/// A quarter of them was more than four deviations off when only hypotheses of all accelerations together widened what a constant generator states.
#[test]
fn a_spin_that_grows_from_the_first_frame_on_is_within_its_deviations_in_most_of_the_next_ones() {
    for spin in [0.5, 1.0, 2.0] {
        let errors = errors(spin);
        let off = errors.iter().filter(|error| **error > 4.0).count();
        assert!(errors.len() > 140, "{spin}: {}", errors.len());
        assert!(10 * off < errors.len(), "{spin}: {off} of {}", errors.len());
    }
}

/// A body whose spin grows as it speeds up or is braked looks in its first frames like one of which a point aside runs straight. That does not say that the
/// spin stays: where it was taken to, omega was more than four deviations off in 49 of these 1152 frames; it is in 17.
#[test]
fn a_spin_that_grows_while_the_body_speeds_up_is_within_its_deviations_in_nearly_all_of_the_next_frames() {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let mut errors = Vec::new();
    for seed in 0..96 {
        let mut any = |most: f64| rng.random_range(-most..most);
        let (omega, velocity, middle) = (any(2.0), Vector2::new(any(3.0), any(3.0)), Vector2::new(any(2.0), any(2.0)));
        let dynamics = sim_camera::Dynamics::Accelerating { spin: any(3.0), middle };
        let path = Trajectory::new(Point2::origin(), omega, velocity, dynamics).expect("finite numbers");
        let settings = Settings { noise: 0.003, points: 240, fps: 30.0, ..settings(14, seed) };
        errors.extend(errors_along(path, SHAPES[seed as usize % SHAPES.len()], settings));
    }
    let off = errors.iter().filter(|error| **error > 4.0).count();
    assert!(errors.len() > 1100 && 30 * off < errors.len(), "{off} of {}", errors.len());
}

#[test]
fn deviations_of_a_constant_motion_are_hardly_wider_for_one_that_might_have_changed() {
    let motion = RigidMotion { omega: 1.2, b1: 0.3, b2: -0.2 };
    let mut ratios = Vec::new();
    for (number, shape) in SHAPES.into_iter().enumerate() {
        for seed in 0..3 {
            let settings = Settings { noise: 0.004, ..settings(30, seed + 10 * number as u64) };
            let frames = frames_of(shape, motion, settings);
            let mut runs = [Dynamics::Auto, Dynamics::Generator].map(|dynamics| {
                MotionFilter::new(FilterSettings { dynamics, ..FilterSettings::default() }).expect("good settings")
            });
            for frame in &frames {
                let [auto, generator] = runs.each_mut().map(|run| {
                    run.step(frame.time, &frame.outline).expect("increasing times");
                    run.estimate().and_then(|estimate| estimate.parameters().next()?.standard_deviation)
                });
                if [3, 7, 15, 29].contains(&frame.index) {
                    ratios.push(auto.expect("known") / generator.expect("known"));
                }
            }
        }
    }
    ratios.sort_by(f64::total_cmp);
    let median = ratios[ratios.len() / 2];
    assert!((1.0..1.35).contains(&median), "{ratios:?}");
}
