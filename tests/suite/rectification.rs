//! Rigid motions in a plane that a perspective camera sees from aside.
use freeform_motion::{
    PlaneByOutlineError, Rectification, RectifyError, Tracker, TrackerSettings,
    curve_fit::Outline,
    outline_io::OutlineFrame,
    plane_by_outline,
    riccati::{MotionModel, RigidMotion},
    sim_camera::{BuiltInShape, Camera, Scene, Settings, Simulator},
    tracker::{FrameRejection, Method, RejectionCause},
};
use nalgebra::{Matrix3, Point2, Projective2, Vector2};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use crate::common::frames;

const MOTION: RigidMotion = RigidMotion { omega: 1.2, b1: -0.2, b2: 0.15 };

/// From the plane to a picture with a focal length of 900 pixels, for a camera 3 lengths from the origin of the plane that is tilted by an
/// angle in degrees: an object of size 1 is 300 pixels across.
fn picture_from_plane(tilt: f64) -> Projective2<f64> {
    let (sin, cos) = tilt.to_radians().sin_cos();
    let focal = Matrix3::from_diagonal(&nalgebra::Vector3::new(900.0, 900.0, 1.0));
    // The point (x, y) of the plane is at (x, y cos, 3 + y sin) before the camera.
    let view = Matrix3::new(1.0, 0.0, 0.0, 0.0, cos, 0.0, 0.0, sin, 3.0);
    let middle = Matrix3::new(1.0, 0.0, 640.0, 0.0, 1.0, 360.0, 0.0, 0.0, 1.0);
    Projective2::from_matrix_unchecked(middle * focal * view)
}

/// Pictures of a moving object, with noise in pixels.
fn pictures(shape: BuiltInShape, tilt: f64, noise: f64, count: usize, seed: u64) -> Vec<OutlineFrame> {
    let map = picture_from_plane(tilt);
    let settings = Settings { noise: 0.0, seed, ..frames(count) };
    let simulator = Simulator::new(Scene::new(shape, MOTION, Camera::default()), settings).expect("a simulation");
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    // Uniform, with this standard deviation.
    let mut error = || noise * 12.0_f64.sqrt() * (rng.random::<f64>() - 0.5);
    let seen = |frame: freeform_motion::sim_camera::Frame| {
        let points = frame.outline.points().map(|p| map * p + Vector2::new(error(), error())).collect();
        let outline = Outline::closed(points).expect("an outline");
        OutlineFrame { frame: frame.index as u64, time: frame.time, object: "0".to_owned(), outline }
    };
    simulator.frames().map(seen).collect()
}

fn rectifying(tilt: f64, method: Method) -> Tracker {
    let rectification = Rectification::new(&picture_from_plane(tilt).inverse()).expect("a regular map");
    let settings =
        TrackerSettings { rectification: Some(rectification), ..TrackerSettings::new(method, MotionModel::Rigid) };
    Tracker::new(settings).expect("default settings")
}

#[test]
fn a_rigid_motion_in_a_tilted_plane_keeps_its_three_parameters_without_a_bias() {
    for tilt in [0.0, 30.0, 60.0] {
        let (mut sums, mut deviations) = ([0.0; 3], [0.0; 3]);
        let runs = 8;
        for seed in 0..runs {
            let mut tracker = rectifying(tilt, Method::Filter);
            for frame in pictures(BuiltInShape::Bird, tilt, 0.3, 40, seed) {
                tracker.push(&frame);
            }
            let estimate = tracker.results().remove(0).estimate.expect("a motion");
            for (i, (p, truth)) in estimate.parameters().zip([MOTION.omega, MOTION.b1, MOTION.b2]).enumerate() {
                sums[i] += (p.value.expect("observable") - truth) / f64::from(runs as u32);
                deviations[i] += p.standard_deviation.expect("by the filter") / f64::from(runs as u32);
            }
        }
        // The mean of eight has a deviation of 0.35 of that of one.
        for (mean, deviation) in sums.iter().zip(deviations) {
            println!("tilt {tilt}: {mean} {deviation}");
            assert!(mean.abs() < 1.5 * deviation, "tilt {tilt}: {mean}, deviation of one run {deviation}");
            assert!(deviation < 0.003, "tilt {tilt}: {deviation}");
        }
    }
}

#[test]
fn without_rectification_the_rigid_motion_of_a_tilted_plane_is_wrong_by_many_deviations() {
    let mut tracker = Tracker::new(TrackerSettings::default()).expect("default settings");
    for frame in pictures(BuiltInShape::Bird, 50.0, 0.3, 40, 1) {
        tracker.push(&frame);
    }
    let result = tracker.results().remove(0);
    let omega = result.estimate.and_then(|estimate| estimate.parameters().next()?.value);
    assert!(omega.is_none_or(|omega| (omega - MOTION.omega).abs() > 0.05), "{omega:?}");
}

#[test]
fn the_adaptive_method_works_in_the_plane_too() {
    let mut tracker = rectifying(50.0, Method::Adaptive);
    for frame in pictures(BuiltInShape::Bird, 50.0, 0.0, 600, 1) {
        tracker.push(&frame);
    }
    let estimate = tracker.results().remove(0).estimate.expect("a motion");
    assert!((estimate.values()[0] - MOTION.omega).abs() < 0.03, "{estimate:?}");
}

#[test]
fn the_generator_in_the_picture_moves_points_of_the_picture_as_they_are_seen_to_move() {
    let map = picture_from_plane(40.0);
    let rectification = Rectification::new(&map.inverse()).expect("a regular map");
    let generator = rectification.generator_in_picture(&MOTION.generator());
    let motion = freeform_motion::riccati::ProjectiveMotion::of_generator(&generator);
    let p = Point2::new(0.3, -0.2);
    let at = |time: f64| map * (MOTION.flow(time) * p);
    let velocity = (at(1e-5) - at(-1e-5)) / 2e-5;
    assert!((motion.velocity(&at(0.0)) - velocity).norm() < 1e-4 * velocity.norm());
}

#[test]
fn an_outline_at_the_horizon_is_rejected_with_the_reason_and_a_singular_map_is_refused() {
    let mut tracker = rectifying(60.0, Method::Filter);
    // The horizon of the plane is where y sin 60 = -3, at 360 + 900 cot 60 pixels from the top or below.
    let horizon = 360.0 + 900.0 / 60.0_f64.to_radians().tan();
    let around = |k: i32| (std::f64::consts::TAU * f64::from(k) / 100.0).sin_cos();
    let circle = (0..100).map(|k| Point2::new(640.0 + 100.0 * around(k).0, horizon + 100.0 * around(k).1)).collect();
    let outline = Outline::closed(circle).expect("a circle");
    let seen = tracker.push(&OutlineFrame { frame: 3, time: 0.1, object: "0".to_owned(), outline });
    let cause = RejectionCause::NotRectified(RectifyError::Horizon);
    assert_eq!(
        (seen.time, seen.rejection),
        (Some(0.1), Some(FrameRejection { object: "0".to_owned(), frame: 3, cause }))
    );
    for bad in [Matrix3::new(1.0, 2.0, 3.0, 2.0, 4.0, 6.0, 0.0, 0.0, 1.0), Matrix3::repeat(f64::NAN), Matrix3::zeros()]
    {
        let error = Rectification::new(&Projective2::from_matrix_unchecked(bad)).expect_err("singular");
        assert!(matches!(error, RectifyError::Singular { .. }));
    }
}

/// Of a plane seen from aside, as a bird is that lies in it.
fn seen_at_rest(shape: BuiltInShape, tilt: f64, noise: f64, frames: u64) -> (Outline, Vec<Outline>) {
    let known = Outline::closed(shape.shape().sample(500, 0.0)).expect("an outline");
    let map = picture_from_plane(tilt);
    let mut rng = ChaCha8Rng::seed_from_u64(frames);
    let mut error = || noise * 12.0_f64.sqrt() * (rng.random::<f64>() - 0.5);
    let seen = (0..frames).map(|k| {
        let points = shape.shape().sample(300, 0.0007 * k as f64);
        // Turned and away from the middle.
        let place = nalgebra::Isometry2::new(Vector2::new(0.4, -0.3), 2.5);
        let points = points.iter().map(|p| map * (place * p) + Vector2::new(error(), error())).collect();
        Outline::closed(points).expect("an outline")
    });
    let seen = seen.collect();
    (known, seen)
}

#[test]
fn an_outline_known_in_the_plane_and_seen_at_rest_tells_the_plane() {
    for shape in [BuiltInShape::Bird, BuiltInShape::Van, BuiltInShape::Shoe, BuiltInShape::Glider, BuiltInShape::Square]
    {
        for tilt in [0.0, 60.0] {
            for (noise, frames, limit) in [(0.0, 1, 0.0005), (0.3, 1, 0.01), (0.3, 20, 0.004)] {
                // Many frames take long.
                if frames > 1 && shape != BuiltInShape::Bird {
                    continue;
                }
                let (known, seen) = seen_at_rest(shape, tilt, noise, frames);
                let found = plane_by_outline(&known, &seen).unwrap_or_else(|error| panic!("{shape} {tilt}: {error}"));
                // Lengths in the plane are right, wherever the known outline puts its origin.
                let map = found.plane_from_picture * picture_from_plane(tilt);
                let corners = [(0.0, 0.0), (0.8, 0.0), (0.8, -0.6), (0.0, -0.6)].map(|(x, y)| Point2::new(x, y));
                for (i, p) in corners.iter().enumerate() {
                    for q in &corners[..i] {
                        let off = (map * p - map * q).norm() - (p - q).norm();
                        assert!(off.abs() < limit, "{shape} {tilt} {noise} {frames}: {off}");
                    }
                }
                let expected = noise / 300.0;
                assert!(found.distance < 2.0 * expected + 1e-3, "{shape} {tilt}: {}", found.distance);
            }
        }
    }
}

#[test]
fn outlines_that_tell_no_plane_are_refused_with_the_reason() {
    let refused = |known: &Outline, seen: &[Outline]| plane_by_outline(known, seen).expect_err("refused");
    let (bird, seen) = seen_at_rest(BuiltInShape::Bird, 30.0, 0.0, 1);
    let another = seen_at_rest(BuiltInShape::Phone, 30.0, 0.0, 1).1;
    assert!(matches!(refused(&bird, &another), PlaneByOutlineError::AnotherOutline { .. }));
    assert_eq!(refused(&bird, &[]), PlaneByOutlineError::NothingSeen);
    for round in [BuiltInShape::Circle, BuiltInShape::Ellipse] {
        let (known, seen) = seen_at_rest(round, 30.0, 0.0, 1);
        assert_eq!(refused(&known, &seen), PlaneByOutlineError::Undetermined, "{round}");
    }
    let sheet = [(0.0, 0.0), (0.297, 0.0), (0.297, 0.21), (0.0, 0.21)].map(|(x, y)| Point2::new(x, y));
    let sheet = Outline::closed(sheet.to_vec()).expect("a sheet");
    let map = picture_from_plane(40.0);
    let of_sheet = sheet.mapped(|p| map * p).expect("an outline");
    assert_eq!(refused(&sheet, &[of_sheet]), PlaneByOutlineError::TwoPlanes);
    let arc: Vec<_> = seen[0].points().take(100).copied().collect();
    let arc = freeform_motion::curve_fit::OpenArc::new(arc).expect("an arc");
    let arcs = freeform_motion::curve_fit::OpenOutline::new(vec![arc]).expect("arcs");
    assert_eq!(refused(&bird, &[Outline::Open(arcs)]), PlaneByOutlineError::NotWhole);
}
