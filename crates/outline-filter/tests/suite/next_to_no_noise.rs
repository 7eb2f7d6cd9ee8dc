//! Outlines whose points have less noise than straight cells may leave of a bend.
use crate::filter_support::{filter, frames_of, settings};
use freeform_riccati::{MotionModel, RigidMotion};
use freeform_sim_camera::{BuiltInShape, Dynamics, Motion, Sampling, Settings, Trajectory};
use nalgebra::{Affine2, Point2, Vector2};

/// Angles and places of poses: the root mean square of errors over deviations, and the share within 95 %.
fn errors_over_deviations(noise: f64) -> [f64; 2] {
    let path =
        Trajectory::new(Point2::origin(), 1.3, Vector2::new(0.3, -0.2), Dynamics::Velocity).expect("finite numbers");
    let motion = Motion::varying(move |t| path.motion(t));
    let (mut squares, mut inside, mut all) = (0.0, 0.0, 0.0);
    for shape in [BuiltInShape::Bird, BuiltInShape::Phone, BuiltInShape::Van, BuiltInShape::Hat] {
        for seed in 0..5 {
            let frames = frames_of(shape, motion.clone(), Settings { noise, ..settings(40, seed) });
            let centre = frames[0].outline.centroid();
            let mut run = filter(MotionModel::Rigid);
            for frame in &frames {
                run.step(frame.time, &frame.outline).expect("increasing times");
                let Some(state) = run.state() else { continue };
                let there: Affine2<f64> =
                    nalgebra::try_convert(motion.flow(0.0, frame.time)).expect("a rigid motion is affine");
                let place = there * centre;
                let pose = state.pose_parameters();
                let turned = pose[0].value - path.turn(frame.time);
                let errors = [turned.sin().atan2(turned.cos()), pose[1].value - place.x, pose[2].value - place.y];
                for (error, parameter) in errors.into_iter().zip(&pose) {
                    let in_deviations = error / parameter.standard_deviation;
                    squares += in_deviations * in_deviations;
                    inside += f64::from(u8::from(in_deviations.abs() < 1.96));
                    all += 1.0;
                }
            }
        }
    }
    [f64::sqrt(squares / all), inside / all]
}

#[test]
fn deviations_of_poses_are_as_small_as_the_noise_of_points_makes_them() {
    for noise in [0.003, 0.0002] {
        let [ratio, held] = errors_over_deviations(noise);
        assert!((0.57..1.1).contains(&ratio) && held > 0.95, "noise {noise}: {ratio}, {held}");
    }
}

/// Angles of poses of bodies that swing about their centroid, from the fifth frame on, and how many of them are off by more than four deviations.
fn angles_off(points: usize, sampling: Sampling) -> [u32; 2] {
    let (mut all, mut off) = (0, 0);
    for (shape, seed) in
        [BuiltInShape::Bird, BuiltInShape::Phone, BuiltInShape::Hat, BuiltInShape::Glider].into_iter().zip(0..)
    {
        for (amplitude, frequency) in [(0.3, 6.0), (0.9, 4.0), (1.4, 9.0)] {
            let turn = move |time: f64| amplitude * (frequency * time + 0.4).sin();
            let rate = move |time: f64| amplitude * frequency * (frequency * time + 0.4).cos();
            let motion = Motion::varying(move |time| RigidMotion { omega: rate(time), b1: 0.0, b2: 0.0 });
            let settings = Settings { noise: 0.0005, points, sampling, ..settings(60, seed) };
            let mut run = filter(MotionModel::Rigid);
            for frame in frames_of(shape, motion, settings) {
                run.step(frame.time, &frame.outline).expect("increasing times");
                let Some(angle) = run.state().filter(|_| frame.index >= 4).map(|state| state.pose_parameters()[0])
                else {
                    continue;
                };
                let error = angle.value - (turn(frame.time) - turn(0.0));
                all += 1;
                off += u32::from(error.sin().atan2(error.cos()).abs() > 4.0 * angle.standard_deviation);
            }
        }
    }
    [all, off]
}

/// Of maps that were cut by a constant motion, or into cells of which each frame shows a quarter, one angle in 25 was off.
#[test]
fn poses_of_a_body_that_swings_are_within_their_deviations_also_where_its_map_is_cut_from_many_frames() {
    for (points, sampling) in
        [(80, Sampling::Regular { jitter: 0.0 }), (80, Sampling::Regular { jitter: 1.0 }), (200, Sampling::Independent)]
    {
        let [all, off] = angles_off(points, sampling);
        assert!(all > 500 && off * 300 < all, "{points} points, {sampling:?}: {off} of {all}");
    }
}
