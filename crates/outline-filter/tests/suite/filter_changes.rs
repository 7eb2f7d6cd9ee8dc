//! The motion filter where the motion changes.
use crate::filter_support::{filter, filtered, frames_of, omega_of, settings};
use freeform_estimate::ProcessNoise;
use freeform_outline_filter::{FilterSettings, MotionFilter, Phase, Rejection};
use freeform_riccati::{AffineMotion, MotionModel, RigidMotion};
use freeform_sim_camera::{BuiltInShape, Frame, Motion, Settings};
use nalgebra::{Affine2, Vector2};

#[test]
fn a_change_of_motion_is_noticed_and_the_new_motion_found() {
    let before = AffineMotion::from(RigidMotion { omega: 1.5, b1: -0.3, b2: 0.4 });
    let after = AffineMotion::from(RigidMotion { omega: -1.0, b1: 0.5, b2: 0.1 });
    let motion = Motion::piecewise(vec![(0.0, before), (1.0, after)]).expect("two phases");
    let run = filtered(MotionModel::Rigid, &frames_of(BuiltInShape::Bird, motion, settings(75, 2)));
    assert_eq!((run.phase(), run.restarts()), (Phase::Tracking, 0));
    let estimate = run.estimate().expect("an estimate");
    for (parameter, truth) in estimate.parameters().zip([after.a2, after.b1, after.b2]) {
        let error = parameter.value.expect("observable") - truth;
        assert!(error.abs() < 0.01, "{}: {error}", parameter.name);
    }
}

/// With changes expected a hundred times as often, chance hides one motion in two for some frames.
#[test]
fn a_motion_that_stays_for_thousands_of_frames_is_known_in_each_of_them() {
    let motion = RigidMotion { omega: 1.2, b1: -0.3, b2: 0.4 };
    for (shape, seed) in [(BuiltInShape::Bird, 0), (BuiltInShape::Glider, 1), (BuiltInShape::Phone, 2)] {
        let simulated = Settings { fps: 100.0, points: 200, ..settings(2000, seed) };
        let mut run = filter(MotionModel::Rigid);
        for frame in frames_of(shape, AffineMotion::from(motion), simulated) {
            run.step(frame.time, &frame.outline).expect("increasing times");
            if frame.index < 100 {
                continue;
            }
            let estimate = run.estimate().expect("an estimate");
            let omega = estimate.parameters().next().expect("omega");
            let stated = omega.value.zip(omega.standard_deviation);
            let (value, deviation) = stated.unwrap_or_else(|| panic!("{shape}: unknown in frame {}", frame.index));
            assert!(deviation < 0.01, "{shape}, frame {}: {deviation}", frame.index);
            assert!((value - motion.omega).abs() < 5.0 * deviation, "{shape}, frame {}: {value}", frame.index);
        }
    }
}

/// A turn that has changed leaves a part of the points on other parts of the outline.
#[test]
fn a_last_frame_that_lies_only_in_part_where_it_was_expected_widens_what_is_stated() {
    let before = AffineMotion::from(RigidMotion { omega: -1.0, b1: 0.1, b2: 0.0 });
    let mut lies_in_part = 0;
    for (shape, omega) in [BuiltInShape::Phone, BuiltInShape::Van, BuiltInShape::Shoe, BuiltInShape::Hat]
        .into_iter()
        .flat_map(|shape| [1.0, 2.0, 3.0, 4.0].map(|omega| (shape, omega)))
    {
        let after = AffineMotion::from(RigidMotion { omega, b1: 0.1, b2: 0.0 });
        let motion = Motion::piecewise(vec![(0.0, before), (38.0 / 30.0, after)]).expect("two phases");
        let frames = frames_of(shape, motion, Settings { noise: 0.002, ..settings(40, 3) });
        let mut run = filter(MotionModel::Rigid);
        let (last, others) = frames.split_last().expect("frames");
        others.iter().for_each(|frame| _ = run.step(frame.time, &frame.outline).expect("increasing times"));
        let (_, deviation) = omega_of(&run).expect("a motion that is known before");
        assert!(deviation < 0.01, "{shape} {omega}: {deviation}");
        let step = run.step(last.time, &last.outline).expect("increasing times");
        if !matches!(step.rejection, Some(Rejection::AgreementTooSmall { .. } | Rejection::Elsewhere { .. })) {
            continue;
        }
        lies_in_part += 1;
        // It may be so wide that nothing is stated.
        if let Some((value, deviation)) = omega_of(&run) {
            assert!((value - omega).abs() < 4.0 * deviation, "{shape} {omega}: {value} {deviation}");
        }
    }
    assert!(lies_in_part >= 3, "{lies_in_part}");
}

#[test]
fn process_noise_lets_the_filter_follow_a_motion_that_drifts() {
    let drifting = |t: f64| AffineMotion::from(RigidMotion { omega: 1.0 + 0.5 * t, b1: 0.2, b2: -0.1 });
    let frames = frames_of(BuiltInShape::Bird, Motion::varying(drifting), settings(90, 4));
    let noise = ProcessNoise { rates: 0.5, velocities: 0.1 };
    let settings = FilterSettings { process_noise: noise, ..FilterSettings::default() };
    let mut filter = MotionFilter::new(settings).expect("good settings");
    for frame in &frames {
        assert!(
            filter.step(frame.time, &frame.outline).expect("increasing times").is_accepted(),
            "frame {}",
            frame.index
        );
    }
    let estimate = filter.estimate().expect("an estimate");
    let omega = estimate.parameters().next().expect("omega");
    let error = omega.value.expect("observable") - (1.0 + 0.5 * frames[89].time);
    assert!(error.abs() < 4.0 * omega.standard_deviation.expect("given"), "{error}");
    let pose: Affine2<f64> = nalgebra::try_convert(filter.pose().expect("a pose")).expect("affine");
    let truth = Motion::varying(drifting).flow(0.0, frames[89].time);
    assert!((pose.matrix() - truth.matrix()).norm() < 0.02);
}

#[test]
fn a_motion_that_changes_slowly_stays_known_without_being_announced() {
    let omega = |t: f64| 1.5 + 0.5 * (0.4 * t).sin();
    let changing = move |t: f64| AffineMotion::from(RigidMotion { omega: omega(t), b1: -0.3, b2: 0.4 });
    let frames = frames_of(BuiltInShape::Bird, Motion::varying(changing), settings(600, 5));
    let mut filter = filter(MotionModel::Rigid);
    let (mut unknown, mut square, mut counted) = (0, 0.0, 0);
    for frame in &frames {
        filter.step(frame.time, &frame.outline).expect("increasing times");
        if frame.time < 5.0 {
            continue;
        }
        let estimate = filter.estimate().expect("an estimate");
        unknown += estimate.parameters().filter(|p| p.value.is_none()).count();
        square += (estimate.values()[0] - omega(frame.time)).powi(2);
        counted += 1;
    }
    let error = (square / f64::from(counted)).sqrt();
    println!("{unknown} unknown, omega off by {error}, {} frames rejected", filter.frames_rejected());
    assert!(unknown == 0 && error < 0.1, "{unknown} unknown, omega off by {error}");
}

#[test]
fn a_motion_that_changes_is_followed_without_being_told_to() {
    let slow = |t: f64| AffineMotion::from(RigidMotion { omega: 1.0 + 0.5 * (1.5 * t).sin(), b1: 0.2, b2: -0.1 });
    let frames = frames_of(BuiltInShape::Bird, Motion::varying(slow), settings(120, 4));
    let mut filter = filter(MotionModel::Rigid);
    for frame in &frames {
        assert!(
            filter.step(frame.time, &frame.outline).expect("increasing times").is_accepted(),
            "frame {}",
            frame.index
        );
    }
    let omega = filter.estimate().expect("an estimate").parameters().next().expect("omega");
    let error = omega.value.expect("observable") - slow(frames[119].time).a2;
    assert!(error.abs() < 0.1, "{error}");
}

#[test]
fn an_object_that_spins_evenly_and_travels_straight_keeps_its_angular_velocity_to_a_thousandth() {
    for (omega, velocity) in [(1.28, [0.5, 0.0]), (-3.0, [0.3, -0.4]), (0.5, [-1.0, 0.2])] {
        let [v, w] = velocity;
        // The velocity belongs to the origin of the image, about which the middle does not turn.
        let thrown =
            move |t: f64| AffineMotion::from(RigidMotion { omega, b1: v - omega * w * t, b2: w + omega * v * t });
        for seed in 0..3 {
            let settings = Settings { noise: 0.003, ..settings(90, seed) };
            let run = filtered(MotionModel::Rigid, &frames_of(BuiltInShape::Van, Motion::varying(thrown), settings));
            let found = run.estimate().expect("an estimate").parameters().next().expect("omega comes first");
            let (value, std) = (found.value.expect("known"), found.standard_deviation.expect("known"));
            let context = format!("{omega} {velocity:?}, seed {seed}: {value} {std}");
            // Chance makes one of the motions that are left out doubtful in some runs, which widens deviations.
            assert!((value - omega).abs() < 1e-3 * (1.0 + omega.abs()), "{context}");
            assert!((value - omega).abs() < 5.0 * std && std < 1.5e-3 * (1.0 + omega.abs()), "{context}");
            assert!(run.motion_changed() && run.frames_rejected() == 0, "{context}: {}", run.frames_rejected());
        }
    }
}

/// A rigid motion with a constant angular velocity whose point that is at `from` first moves at a constant velocity: the motion at a time.
fn thrown(omega: f64, [v, w]: [f64; 2], [x, y]: [f64; 2]) -> impl Fn(f64) -> RigidMotion + Clone + Send + Sync {
    move |t| RigidMotion { omega, b1: v - omega * (y + w * t), b2: w + omega * (x + v * t) }
}

#[test]
fn a_body_that_spins_fast_about_a_point_aside_of_its_centroid_has_the_velocity_of_its_centroid() {
    for omega in [10.0, -24.0, 44.0] {
        for (seed, aside) in [(0, 0.02), (1, 0.06), (2, 0.1), (3, -0.04)] {
            let motion = thrown(omega, [0.4, 0.2], [aside, 0.0]);
            let settings = Settings { points: 300, noise: 0.003, ..settings(60, seed) };
            let frames = frames_of(BuiltInShape::Bird, Motion::varying(motion.clone()), settings);
            let run = filtered(MotionModel::Rigid, &frames);
            let truth = motion(frames[59].time);
            let estimate = run.estimate().expect("an estimate");
            for (parameter, truth) in estimate.parameters().zip([truth.omega, truth.b1, truth.b2]) {
                let (Some(value), Some(deviation)) = (parameter.value, parameter.standard_deviation) else { continue };
                let off = (value - truth) / deviation;
                assert!(off.abs() < 4.5, "{omega} {aside} {}: {value} +- {deviation} for {truth}", parameter.name);
            }
        }
    }
}

#[test]
fn a_slow_object_is_within_its_deviations_where_frames_do_not_tell_how_its_motion_goes_on() {
    let motion = thrown(0.02, [0.01, 0.0], [0.0, 0.0]);
    let mut squares = 0.0;
    for seed in 0..16 {
        let settings = Settings { points: 300, noise: 0.004, ..settings(75, seed) };
        let frames = frames_of(BuiltInShape::Van, Motion::varying(motion.clone()), settings);
        let found = filtered(MotionModel::Rigid, &frames).velocity().expect("a velocity");
        let RigidMotion { omega, b1, b2 } = motion(frames[74].time);
        let truth = Vector2::new(omega * found.point.y + b1, -omega * found.point.x + b2);
        let off = (found.velocity - truth).component_div(&found.standard_deviations());
        assert!(off.amax() < 4.0, "seed {seed}: {off}");
        squares += off.norm_squared();
    }
    assert!(squares > 0.3 * 32.0, "deviations are much wider than errors: {squares}");
}

#[test]
fn an_object_that_spins_and_travels_keeps_its_pose_where_its_map_is_cut_from_many_frames() {
    let [omega, v, w] = [1.0, 1.2, 0.0];
    let thrown = move |t: f64| AffineMotion::from(RigidMotion { omega, b1: v - omega * w * t, b2: w + omega * v * t });
    for points in [60, 100, 200] {
        for seed in 0..3 {
            let settings = Settings { points, noise: 0.006, ..settings(48, seed) };
            let frames = frames_of(BuiltInShape::Glider, Motion::varying(thrown), settings);
            let mut run = MotionFilter::new(FilterSettings::default()).expect("settings");
            let mut worst: f64 = 0.0;
            for frame in &frames {
                if run.step(frame.time, &frame.outline).expect("a later frame").is_accepted() {
                    let pose = run.pose().expect("a pose").into_inner();
                    let turn = (pose[(1, 0)] - pose[(0, 1)]).atan2(pose[(0, 0)] + pose[(1, 1)]);
                    worst = worst.max((turn + omega * frame.time).abs());
                }
            }
            let found = run.estimate().expect("an estimate").parameters().next().expect("omega comes first");
            let (value, std) = (found.value.expect("known"), found.standard_deviation.expect("known"));
            let context = format!("{points} points, seed {seed}: {value} {std}, worst {worst}");
            assert!((value - omega).abs() < 5.0 * std && std < 0.03 && worst < 0.05, "{context}");
        }
    }
}

#[test]
fn an_object_that_takes_the_place_of_one_whose_motion_changed_has_not_changed_its_own() {
    let swinging = |t: f64| AffineMotion::from(RigidMotion { omega: 3.0 * (4.0 * t).sin(), b1: 0.2, b2: -0.1 });
    // With so many points that no map is ever cut anew.
    let many = |seed| Settings { points: 1500, ..settings(60, seed) };
    let mut run = filter(MotionModel::Rigid);
    for frame in &frames_of(BuiltInShape::Bird, Motion::varying(swinging), many(0)) {
        run.step(frame.time, &frame.outline).expect("increasing times");
    }
    assert!(run.motion_changed());
    let steady = AffineMotion::from(RigidMotion { omega: 0.5, b1: 0.1, b2: 0.0 });
    for frame in &frames_of(BuiltInShape::Phone, steady, many(1)) {
        run.step(10.0 + frame.time, &frame.outline).expect("increasing times");
    }
    assert!(run.restarts() > 0 && !run.motion_changed(), "{} restarts", run.restarts());
    let alone = filtered(MotionModel::Rigid, &frames_of(BuiltInShape::Phone, steady, many(1)));
    let deviation = |run: &MotionFilter| {
        let omega = run.estimate().expect("an estimate").parameters().next().expect("omega");
        omega.standard_deviation.expect("known")
    };
    // It has half of the frames.
    assert!(deviation(&run) < 6.0 * deviation(&alone), "{} {}", deviation(&run), deviation(&alone));
}

/// What the turn of the pose is off, and its standard deviation, of every frame from the eighth on that shows the object, as far as the
/// filter says; whether it was used.
fn turns(frames: &[Frame], turned: impl Fn(f64) -> f64) -> Vec<(f64, f64, bool)> {
    let mut run = filter(MotionModel::Rigid);
    let mut found = Vec::new();
    for (number, frame) in frames.iter().enumerate() {
        let step = run.step(frame.time, &frame.outline).expect("a later frame");
        // Where the object was not found nothing says how far off the prediction is.
        let is_found = step
            .rejection
            .is_none_or(|why| matches!(why, Rejection::InnovationTooLarge { .. } | Rejection::Elsewhere { .. }));
        let Some(state) = run.state().filter(|_| number >= 8 && is_found) else { continue };
        let turn = state.pose_parameters().into_iter().next().expect("the turn comes first");
        let off = turn.value - turned(frame.time);
        found.push((off.sin().atan2(off.cos()), turn.standard_deviation, step.is_accepted()));
    }
    found
}

#[test]
fn the_pose_of_an_object_that_is_pushed_again_and_again_is_within_its_deviations_also_where_a_frame_is_not_used() {
    let pushes =
        [1.2, -0.4, 0.1, 1.8, 1.0, 0.0, 0.0, -1.1, 0.6, 1.9, 0.3, -0.7, 0.0, 1.4, 0.9, -1.6, 0.2, 0.0, 1.1, -0.2];
    let phase = |number: usize| 0.2 * number as f64;
    let motions = pushes.iter().enumerate().map(|(number, omega)| {
        (phase(number), AffineMotion::from(RigidMotion { omega: *omega, b1: 0.1 * omega, b2: -0.2 }))
    });
    let motion = Motion::piecewise(motions.collect()).expect("phases");
    let parts = |time: f64| {
        pushes.iter().enumerate().map(move |(number, omega)| omega * (time - phase(number)).clamp(0.0, 0.2))
    };
    let (mut rejected, mut wide) = (0, 0);
    for seed in 0..8 {
        let frames = frames_of(BuiltInShape::Bird, motion.clone(), Settings { fps: 15.0, ..settings(60, seed) });
        let found = turns(&frames, |time| parts(time).sum());
        for (off, std, is_used) in &found {
            assert!(off.abs() < 5.0 * std, "seed {seed}: {off} {std} {is_used}");
        }
        rejected += found.iter().filter(|(.., is_used)| !is_used).count();
        wide += found.iter().filter(|(_, std, _)| *std > 0.3).count();
    }
    println!("{rejected} not used, {wide} of little worth");
    assert!(rejected > 5 && wide < 20, "{rejected} {wide}");
}

#[test]
fn a_copy_of_a_frame_is_no_measurement_of_a_motion_that_changes() {
    let swinging = |t: f64| AffineMotion::from(RigidMotion { omega: 3.0 * (4.0 * t).sin(), b1: 0.2, b2: -0.1 });
    let (mut copies, mut taken) = (0, 0);
    for seed in 0..6 {
        let frames = frames_of(BuiltInShape::Glider, Motion::varying(swinging), settings(90, seed));
        let mut run = filter(MotionModel::Rigid);
        for frame in &frames {
            let is_copy = frame.index > 9 && frame.index % 5 == 0;
            let shown = if is_copy { frame.index - 1 } else { frame.index };
            let step = run.step(frame.time, &frames[shown].outline).expect("increasing times");
            copies += u32::from(is_copy);
            taken += u32::from(is_copy && step.is_accepted());
        }
    }
    // One in five was taken to show a body at rest.
    assert!(20 * taken < copies, "{taken} of {copies} copies");
}

/// Where it is fastest, its speed hardly changes for ten frames.
#[test]
fn a_body_that_swings_slowly_is_not_said_to_move_steadily_where_it_is_fastest() {
    let omega = |t: f64| 0.5 + 0.39 * (1.3 * t).cos();
    let swinging = move |t: f64| {
        let middle = Vector2::new(0.5 * (0.7 * t).sin(), 0.4 * ((0.9 * t + 1.0).sin() - 1.0_f64.sin()));
        let velocity = Vector2::new(0.35 * (0.7 * t).cos(), 0.36 * (0.9 * t + 1.0).cos());
        let omega = omega(t);
        AffineMotion::from(RigidMotion { omega, b1: velocity.x - omega * middle.y, b2: velocity.y + omega * middle.x })
    };
    let (mut off, mut stated) = (0, 0);
    for seed in 0..4 {
        let settings = Settings { points: 60, noise: 0.002, ..settings(900, seed) };
        let mut run = filter(MotionModel::Rigid);
        for frame in &frames_of(BuiltInShape::Glider, Motion::varying(swinging), settings) {
            run.step(frame.time, &frame.outline).expect("increasing times");
            let Some(estimate) = run.estimate().filter(|_| frame.index > 30) else { continue };
            let found = estimate.parameters().next().expect("omega comes first");
            let Some((value, deviation)) = found.value.zip(found.standard_deviation) else { continue };
            stated += 1;
            off += u32::from((value - omega(frame.time)).abs() > 4.0 * deviation);
        }
    }
    // Of sixteen seeds 16 of 13,904 are, in a few frames each.
    assert!(stated > 3000 && 500 * off < stated, "{off} of {stated}");
}
