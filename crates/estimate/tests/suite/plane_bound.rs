//! The bound of a plane in space against finite differences of where its points are seen.
use freeform_estimate::{BoundError, BoundaryPoint, PlaneBound};
use freeform_riccati::{PinholeCamera, PlaneMotion};
use nalgebra::{DMatrix, DVector, Matrix3, Point2, Vector2, Vector3};

const TIMES: [f64; 5] = [0.0, 0.2, 0.5, 0.7, 1.0];
const NOISE: f64 = 0.3;

fn camera() -> PinholeCamera {
    PinholeCamera::new(900.0, Point2::new(320.0, 240.0)).expect("a camera")
}

fn plane() -> PlaneMotion {
    PlaneMotion::of_parameters([0.3, -0.2, 0.5, 0.1, 0.05, 0.12, 0.4, -0.3])
}

/// Points and normals of a curve with nothing symmetric about it, moved by a map of normalised image points.
fn curve(map: &Matrix3<f64>) -> Vec<BoundaryPoint> {
    let at = |i: f64| {
        let t = std::f64::consts::TAU * i / 60.0;
        let start = Vector3::new(0.16 * t.cos() + 0.02 * (2.0 * t).cos(), 0.1 * t.sin() + 0.02 * (3.0 * t).cos(), 1.0);
        let moved = camera().to_picture() * map * start;
        Point2::new(moved.x / moved.z, moved.y / moved.z)
    };
    let point = |i: i32| {
        let tangent: Vector2<f64> = at(f64::from(i) + 1e-4) - at(f64::from(i) - 1e-4);
        BoundaryPoint { point: at(f64::from(i)), normal: Vector2::new(tangent.y, -tangent.x).normalize() }
    };
    (0..60).map(point).collect()
}

#[test]
fn the_bound_of_a_plane_is_that_of_finite_differences() {
    let mut bound = PlaneBound::new(plane(), camera()).expect("a motion");
    let mut information = DMatrix::zeros(16, 16);
    let step = 1e-5;
    for time in TIMES {
        let now = curve(plane().flow(time).matrix());
        let displaced = |index: usize, by: f64| {
            let (mut pose, mut parameters) = ([0.0; 8], plane().parameters());
            if index < 8 {
                pose[index] += by;
            } else {
                parameters[index - 8] += by;
            }
            let [a, b, c, d, e, f, g, h] = pose;
            let start = Matrix3::identity() + Matrix3::new(a, b, c, d, e, f, g, h, 0.0);
            curve(&(PlaneMotion::of_parameters(parameters).flow(time).into_inner() * start))
        };
        let differences: Vec<_> = (0..16).map(|j| (displaced(j, step), displaced(j, -step))).collect();
        for (i, BoundaryPoint { normal, .. }) in now.iter().enumerate() {
            let g = DVector::from_fn(16, |j, _| {
                let (after, before) = &differences[j];
                normal.dot(&(after[i].point - before[i].point)) / (2.0 * step)
            });
            information += &g * g.transpose() / (NOISE * NOISE);
        }
        bound.add_frame(time, now, NOISE, 1.0).expect("a frame");
    }
    let found = bound.covariance().expect("finite");
    assert_eq!((found.rank, &found.observable[..]), (16, &[true; 8][..]));
    let scale = information.diagonal().map(|entry| entry.sqrt().recip());
    let scaled = DMatrix::from_fn(16, 16, |i, j| information[(i, j)] * scale[i] * scale[j]);
    let inverse = scaled.try_inverse().expect("all is seen");
    for (j, found) in found.standard_deviations().enumerate() {
        let (found, expected) = (found.expect("observable"), inverse[(8 + j, 8 + j)].sqrt() * scale[8 + j]);
        assert!((found / expected - 1.0).abs() < 1e-4, "{j}: {found} {expected}");
    }
}

#[test]
fn a_turn_about_the_camera_bounds_neither_normal_nor_velocity_alone() {
    let turning = PlaneMotion { velocity: Vector3::zeros(), ..plane() };
    let mut bound = PlaneBound::new(turning, camera()).expect("a motion");
    for time in TIMES {
        bound.add_frame(time, curve(turning.flow(time).matrix()), NOISE, 1.0).expect("a frame");
    }
    let found = bound.covariance().expect("finite");
    assert_eq!(&found.observable[6..], [false, false]);
    assert!(found.standard_deviations().take(3).all(|std| std.is_some_and(|std| std < 0.1)));
}

#[test]
fn frames_that_cannot_be_are_refused() {
    let mut bound = PlaneBound::new(plane(), camera()).expect("a motion");
    for noise in [0.0, -1.0, f64::NAN] {
        assert!(matches!(bound.add_frame(0.0, [], noise, 1.0), Err(BoundError::Noise { .. })), "{noise}");
    }
    assert!(matches!(bound.add_frame(f64::NAN, [], 1.0, 1.0), Err(BoundError::Frame { .. })));
    let wrong = PlaneMotion { velocity: Vector3::new(0.0, f64::NAN, 0.0), ..plane() };
    assert!(matches!(PlaneBound::new(wrong, camera()), Err(BoundError::ParameterNotFinite { index: 4, .. })));
}
