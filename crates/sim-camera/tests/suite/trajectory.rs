//! Motions whose middle has a path of its own.
use freeform_riccati::RigidMotion;
use freeform_sim_camera::{Camera, Dynamics, Motion, Scene, SimulationError, Trajectory};
use nalgebra::{Matrix3, Point2, Projective2, Vector2};
use proptest::prelude::*;

fn number() -> impl Strategy<Value = f64> {
    -3.0..3.0_f64
}

fn vector() -> impl Strategy<Value = Vector2<f64>> {
    (number(), number()).prop_map(|(x, y)| Vector2::new(x, y))
}

fn any_dynamics() -> impl Strategy<Value = Dynamics> {
    prop_oneof![
        Just(Dynamics::Generator),
        Just(Dynamics::Velocity),
        (number(), vector()).prop_map(|(spin, middle)| Dynamics::Accelerating { spin, middle }),
        (0.5..3.0_f64).prop_map(|period| Dynamics::StopAndGo { period }),
        (0.5..3.0_f64, 0.0..=1.0_f64).prop_map(|(period, share)| Dynamics::Oscillating { period, share }),
    ]
}

fn any_trajectory() -> impl Strategy<Value = Trajectory> {
    (vector(), number(), vector(), any_dynamics()).prop_map(|(start, omega, velocity, dynamics)| {
        Trajectory::new(Point2::from(start), omega, velocity, dynamics).expect("finite")
    })
}

/// Whether the rates jump within `step` of a time.
fn jumps(trajectory: &Trajectory, time: f64, step: f64) -> bool {
    matches!(trajectory.dynamics(), Dynamics::StopAndGo { .. })
        && trajectory.omega(time - step) != trajectory.omega(time + step)
}

fn difference(a: &Projective2<f64>, b: &Projective2<f64>) -> f64 {
    (a.matrix() - b.matrix()).amax()
}

proptest! {
    #[test]
    fn the_derivative_of_the_pose_is_the_generator_times_the_pose(
        trajectory in any_trajectory(), time in 0.01..5.0_f64,
    ) {
        let step = 1e-5;
        prop_assume!(!jumps(&trajectory, time, step));
        let [before, after] = [time - step, time + step].map(|t| *trajectory.pose(t).matrix());
        let derivative: Matrix3<f64> = (after - before) / (2.0 * step);
        let expected = trajectory.motion(time).generator() * trajectory.pose(time).matrix();
        prop_assert!((derivative - expected).amax() < 1e-6, "{derivative} {expected}");
    }

    #[test]
    fn the_middle_goes_along_with_the_plane_and_its_velocity_is_that_of_the_generator(
        trajectory in any_trajectory(), time in 0.0..5.0_f64,
    ) {
        let middle = trajectory.middle(time);
        let carried = trajectory.pose(time) * trajectory.middle(0.0);
        prop_assert!((carried - middle).norm() < 1e-12);
        let velocity = trajectory.motion(time).generator() * middle.to_homogeneous();
        prop_assert!((velocity.xy() - trajectory.velocity(time)).norm() < 1e-11);
    }

    #[test]
    fn a_constant_generator_is_the_motion_that_it_is_without_a_trajectory(
        start in vector(), omega in number(), velocity in vector(), from in 0.0..3.0_f64, more in 0.0..3.0_f64,
    ) {
        let trajectory = Trajectory::new(Point2::from(start), omega, velocity, Dynamics::Generator).expect("finite");
        let motion = RigidMotion {
            omega,
            b1: velocity.x - omega * start.y,
            b2: velocity.y + omega * start.x,
        };
        prop_assert_eq!(trajectory.motion(from), motion);
        prop_assert_eq!(trajectory.pose(more), motion.flow(more));
        let [wrapped, plain] = [Motion::from(trajectory), Motion::from(motion)];
        prop_assert!(difference(&wrapped.flow(from, from + more), &plain.flow(from, from + more)) < 1e-13);
        prop_assert!(wrapped.is_constant() && plain.is_constant());
    }

    #[test]
    fn a_trajectory_in_a_scene_carries_the_outline_by_its_pose(
        trajectory in any_trajectory(), time in 0.0..4.0_f64, scale in 0.1..2.0_f64,
    ) {
        let camera = Camera::new(scale).expect("positive");
        let scene = Scene::new(freeform_sim_camera::BuiltInShape::Van, trajectory, camera);
        let pose = camera.image_map(&nalgebra::convert(trajectory.pose(time)));
        prop_assert!(difference(&scene.true_pose(time), &pose) < 1e-12);
        let motion = scene.image_motion(time);
        prop_assert!((motion.b1 - scale * trajectory.motion(time).b1).abs() < 1e-12);
        prop_assert_eq!(motion.a2, trajectory.omega(time));
    }

    #[test]
    fn without_anything_that_changes_all_dynamics_of_the_middle_are_those_of_constant_velocity(
        start in vector(), omega in number(), velocity in vector(), time in 0.0..5.0_f64,
    ) {
        let with = |dynamics| Trajectory::new(Point2::from(start), omega, velocity, dynamics).expect("finite");
        let plain = with(Dynamics::Velocity);
        for dynamics in [
            Dynamics::Accelerating { spin: 0.0, middle: Vector2::zeros() },
            Dynamics::Oscillating { period: 1.0, share: 0.0 },
            Dynamics::StopAndGo { period: 20.0 },
        ] {
            let other = with(dynamics);
            let poses = [&other, &plain].map(|t| nalgebra::convert(t.pose(time)));
            prop_assert!(difference(&poses[0], &poses[1]) < 1e-12, "{dynamics:?}");
            prop_assert_eq!(other.motion(time), plain.motion(time));
        }
    }
}

#[test]
fn an_object_that_stops_and_goes_rests_in_the_second_half_of_every_period() {
    let dynamics = Dynamics::StopAndGo { period: 2.0 };
    let trajectory = Trajectory::new(Point2::origin(), 1.0, Vector2::new(1.0, 0.0), dynamics).expect("finite");
    for (time, moved, moves) in
        [(0.5, 0.5, true), (1.0, 1.0, false), (1.9, 1.0, false), (2.0, 1.0, true), (4.5, 2.5, true)]
    {
        assert!((trajectory.turn(time) - moved).abs() < 1e-12, "{time}");
        assert!((trajectory.middle(time).x - moved).abs() < 1e-12, "{time}");
        assert_eq!(trajectory.velocity(time).x, f64::from(u8::from(moves)), "{time}");
    }
}

#[test]
fn an_object_that_swings_comes_back_after_a_period() {
    let dynamics = Dynamics::Oscillating { period: 1.5, share: 1.0 };
    let trajectory = Trajectory::new(Point2::new(1.0, 2.0), 2.0, Vector2::new(1.0, -1.0), dynamics).expect("finite");
    assert!(difference(&nalgebra::convert(trajectory.pose(3.0)), &Projective2::identity()) < 1e-12);
    assert!((trajectory.omega(0.75) + 2.0).abs() < 1e-12);
    assert!(!Motion::from(trajectory).is_constant());
}

#[test]
fn numbers_without_sense_are_refused_by_name() {
    let new = |omega, dynamics| Trajectory::new(Point2::origin(), omega, Vector2::zeros(), dynamics);
    let name = |result: Result<Trajectory, SimulationError>| match result {
        Err(SimulationError::OutOfRange { setting, .. }) => setting,
        other => panic!("{other:?}"),
    };
    assert_eq!(name(new(f64::NAN, Dynamics::Velocity)), "angular velocity");
    assert_eq!(name(new(1.0, Dynamics::StopAndGo { period: 0.0 })), "period");
    assert_eq!(name(new(1.0, Dynamics::Oscillating { period: f64::INFINITY, share: 0.5 })), "period");
    assert_eq!(name(new(1.0, Dynamics::Oscillating { period: 1.0, share: 1.5 })), "share that oscillates");
    let accelerating = Dynamics::Accelerating { spin: f64::NAN, middle: Vector2::zeros() };
    assert_eq!(name(new(1.0, accelerating)), "angular acceleration");
}
