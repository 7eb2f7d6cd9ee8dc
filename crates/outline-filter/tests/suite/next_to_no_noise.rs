//! Outlines whose points have less noise than straight cells may leave of a bend.
use crate::filter_support::{filter, frames_of, settings};
use freeform_riccati::MotionModel;
use freeform_sim_camera::{BuiltInShape, Dynamics, Motion, Settings, Trajectory};
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
        assert!((0.58..1.1).contains(&ratio) && held > 0.95, "noise {noise}: {ratio}, {held}");
    }
}
