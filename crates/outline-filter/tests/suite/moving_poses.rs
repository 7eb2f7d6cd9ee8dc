//! Poses of objects whose motion is no constant generator, and of those that show their turn in one place only.
use crate::filter_support::{filter, frames_of, settings};
use freeform_curve_fit::{OpenArc, OpenOutline, Outline};
use freeform_riccati::{MotionModel, RigidMotion};
use freeform_sim_camera::{BuiltInShape, Dynamics, Motion, Settings, Shape, Trajectory};
use nalgebra::{Affine2, Point2, Vector2};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

/// Share of the 95 % intervals of angle and position that hold the truth, after a second and after two.
fn held(dynamics: Dynamics, velocity: Vector2<f64>, omega: f64) -> f64 {
    let path = Trajectory::new(Point2::origin(), omega, velocity, dynamics).expect("finite numbers");
    let motion = Motion::varying(move |t| path.motion(t));
    let (mut inside, mut all) = (0, 0);
    for shape in [BuiltInShape::Bird, BuiltInShape::Phone, BuiltInShape::Van, BuiltInShape::Hat] {
        for seed in 0..3 {
            let frames = frames_of(shape, motion.clone(), Settings { noise: 0.004, ..settings(60, seed) });
            let centre = frames[0].outline.centroid();
            let mut run = filter(MotionModel::Rigid);
            for frame in &frames {
                run.step(frame.time, &frame.outline).expect("increasing times");
                if frame.index != 29 && frame.index != 59 {
                    continue;
                }
                let there: Affine2<f64> =
                    nalgebra::try_convert(motion.flow(0.0, frame.time)).expect("a rigid motion is affine");
                let place = there * centre;
                let pose = run.state().expect("a state").pose_parameters();
                let turned = pose[0].value - path.turn(frame.time);
                let errors = [turned.sin().atan2(turned.cos()), pose[1].value - place.x, pose[2].value - place.y];
                let is_inside = |(error, stated): (f64, f64)| error.abs() < 1.96 * stated;
                inside +=
                    errors.into_iter().zip(pose.iter().map(|p| p.standard_deviation)).filter(|e| is_inside(*e)).count();
                all += 3;
            }
        }
    }
    inside as f64 / f64::from(all)
}

/// Of 72 values of 24 poses; of intervals that hold 76 % of them, as they once did, this passes once in a hundred.
#[test]
fn poses_of_objects_that_spin_and_travel_or_speed_up_are_within_their_deviations() {
    let velocity = Vector2::new(0.3, -0.2);
    let accelerating = |spin, middle| Dynamics::Accelerating { spin, middle };
    for (dynamics, omega) in [
        (Dynamics::Velocity, 1.3),
        (accelerating(0.5, Vector2::zeros()), -0.8),
        (accelerating(0.0, Vector2::new(0.6, -1.5)), 1.1),
    ] {
        let held = held(dynamics, velocity, omega);
        assert!(held > 0.87, "{dynamics:?}: {held}");
    }
}

/// A disc of radius 1 with the points of a tab on it: half an angle, and how far out, may be negative.
fn disc_with(half_angle: f64, out: f64) -> Shape {
    let polar = |radius: f64, angle: f64| Point2::new(radius * angle.cos(), radius * angle.sin());
    let rim = (0..=240).map(|k| half_angle + f64::from(k) / 240.0 * (std::f64::consts::TAU - 2.0 * half_angle));
    let tab = [polar(1.0 + out, -half_angle), polar(1.0 + out, half_angle)];
    let points: Vec<_> = rim.map(|angle| polar(1.0, angle)).chain(tab).collect();
    Shape::from_polygon(&points).expect("a polygon").normalised()
}

#[test]
fn the_turn_of_a_disc_with_a_pin_or_a_notch_is_found_wherever_it_is() {
    for (shape, name) in
        [(disc_with(0.08, 0.2), "pin"), (disc_with(0.1, -0.2), "notch"), (disc_with(0.25, -0.6), "gap")]
    {
        for omega in [1.7, -2.8, 4.0] {
            let path =
                Trajectory::new(Point2::origin(), omega, Vector2::new(0.2, 0.1), Dynamics::Velocity).expect("finite");
            let motion = Motion::varying(move |t| path.motion(t));
            let frames = frames_of(shape.clone(), motion, Settings { noise: 0.001, ..settings(30, 7) });
            let mut run = filter(MotionModel::Rigid);
            for frame in &frames {
                run.step(frame.time, &frame.outline).expect("increasing times");
            }
            let found = run.estimate().expect("an estimate").parameters().next().expect("omega");
            assert!((found.value.expect("known") - omega).abs() < 0.03, "{name}, {omega}: {found:?}");
            assert_eq!(run.frames_rejected(), 0, "{name}, {omega}");
        }
    }
}

#[test]
fn the_angle_of_a_circle_is_not_stated_and_its_place_as_far_as_an_unseen_turn_leaves_it() {
    let path = Trajectory::new(Point2::origin(), 2.0, Vector2::new(0.4, 0.0), Dynamics::Velocity).expect("finite");
    let motion = Motion::varying(move |t| path.motion(t));
    let mut run = filter(MotionModel::Rigid);
    for frame in &frames_of(BuiltInShape::Circle, motion, settings(30, 1)) {
        run.step(frame.time, &frame.outline).expect("increasing times");
    }
    let [angle, x, y] = run.state().expect("a state").pose_parameters()[..] else { panic!("three numbers") };
    assert!(angle.value.is_nan() && angle.standard_deviation.is_infinite(), "{angle:?}");
    // The mean of the points of the first outline is beside the middle by chance, and turns about it.
    for (at, expected) in [(x, 0.4 * 29.0 / 30.0), (y, 0.0)] {
        let (error, stated) = ((at.value - expected).abs(), at.standard_deviation);
        assert!(error < 2.5 * stated && stated < 0.05, "{at:?}");
    }
}

/// Rates of the turn that are stated far from the true one, with small deviations: errors of more than half a radian per second and eight deviations.
fn grossly_wrong(amplitude: f64, frequency: f64, seed: u64) -> Option<String> {
    let turn = move |t: f64| amplitude * (frequency * t).sin();
    let rate = move |t: f64| amplitude * frequency * (frequency * t).cos();
    let motion = Motion::varying(move |t| RigidMotion { omega: rate(t), b1: 0.0, b2: 0.0 });
    let frames = frames_of(disc_with(0.12, -0.44), motion, Settings { noise: 0.002, ..settings(60, seed) });
    let mut run = filter(MotionModel::Rigid);
    for frame in &frames {
        run.step(frame.time, &frame.outline).expect("increasing times");
    }
    let omega = run.estimate()?.parameters().next()?;
    let (value, deviation) = (omega.value?, omega.standard_deviation?);
    let error = (value - rate(frames[59].time)).abs();
    let is_wrong = error > 0.5 && error > 8.0 * deviation && run.wrong_family().is_none();
    is_wrong
        .then(|| format!("{value} +- {deviation} for {}, turned by {}", rate(frames[59].time), turn(frames[59].time)))
}

/// Four of the twelve were followed past the notch before, one of them to 86 rad/s.
#[test]
fn a_disc_with_a_notch_that_swings_is_not_followed_past_its_notch() {
    let mut wrong = Vec::new();
    for (number, frequency) in [6.4, 7.0, 7.6].into_iter().enumerate() {
        for amplitude in [0.6, 0.75, 0.85, 0.95] {
            wrong.extend(grossly_wrong(amplitude, frequency, number as u64));
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}

/// The first frames show the round side of a drop alone, so that nothing says how far it turns meanwhile.
#[test]
fn a_turn_that_the_first_frames_did_not_show_stays_unknown_when_the_map_is_cut_anew() {
    let motion = RigidMotion { omega: 0.8, b1: 0.1, b2: -0.05 };
    let drop = |angle: f64| {
        let radius = if angle.cos() > 0.5 { 0.5 / (std::f64::consts::FRAC_PI_3 - angle.abs()).cos() } else { 0.5 };
        Point2::from(radius * Vector2::new(angle.cos(), angle.sin()))
    };
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let mut run = filter(MotionModel::Rigid);
    let mut stated = 0;
    for frame in 0..60_u32 {
        let time = f64::from(frame) / 30.0;
        let moved = MotionModel::Rigid.flow(&[motion.omega, motion.b1, motion.b2], time);
        let (from, count) = if frame < 8 { (1.3, 70_u32) } else { (-3.1, 100) };
        let spacing = if frame < 8 { (std::f64::consts::TAU - 2.6) / 70.0 } else { std::f64::consts::TAU / 100.0 };
        let mut point = |i: u32| {
            let angle = from + spacing * (f64::from(i) + random.random_range(0.0..1.0));
            let wrapped = (angle + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
            let mut error = || 0.003 * random.sample::<f64, _>(StandardNormal);
            moved * drop(wrapped) + Vector2::new(error(), error())
        };
        let points: Vec<_> = (0..count).map(&mut point).collect();
        let outline = if frame < 8 {
            Outline::Open(OpenOutline::new(vec![OpenArc::new(points).expect("an arc")]).expect("an outline"))
        } else {
            Outline::closed(points).expect("an outline")
        };
        run.step(time, &outline).expect("increasing times");
        let angle = run.state().map(|state| state.pose_parameters()[0].standard_deviation);
        if let Some(deviation) = angle.filter(|deviation| deviation.is_finite()) {
            assert!(frame < 8 || deviation > 1.5, "frame {frame}: {deviation} rad");
            stated += 1;
        }
    }
    let omega = run.estimate().expect("an estimate").parameters().next().expect("omega comes first");
    let (value, deviation) = (omega.value.expect("a drop"), omega.standard_deviation.expect("a drop"));
    assert!((value - motion.omega).abs() < 4.0 * deviation && deviation < 0.02, "{value} +- {deviation}");
    // Cut anew from 16 frames, and followed on.
    assert!(stated > 20, "{stated}");
}

/// What cameras do now and then, such as pixels that are not square, displaces the object in the picture, and where it is seen there is its place: a
/// deviation of half a hundredth of its way was stated.
#[test]
fn the_place_in_the_picture_of_a_body_that_has_gone_far_is_known_as_well_as_its_outline() {
    for seed in 0..3 {
        let motion = RigidMotion { omega: 0.0, b1: 12.0, b2: -9.0 };
        let frames = frames_of(BuiltInShape::Bird, motion, Settings { points: 100, noise: 0.02, ..settings(20, seed) });
        let first = frames[0].outline.centroid();
        let mut run = filter(MotionModel::Rigid);
        for frame in &frames {
            run.step(frame.time, &frame.outline).expect("increasing times");
        }
        let [_, x, y] = run.state().expect("a state").pose_parameters()[..] else { panic!("three numbers") };
        let gone = Vector2::new(12.0, -9.0) * frames[19].time;
        for (at, expected) in [(x, first.x + gone.x), (y, first.y + gone.y)] {
            let (error, stated) = ((at.value - expected).abs(), at.standard_deviation);
            assert!(error < 4.0 * stated && stated < 0.02, "seed {seed}: {at:?} {expected}");
        }
    }
}
