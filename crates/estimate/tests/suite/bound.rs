//! The Cramer-Rao bound against finite differences of the displacement, and what it says of shapes that tell nothing.
use freeform_estimate::{BoundError, BoundaryPoint, CramerRaoBound};
use freeform_riccati::MotionModel;
use nalgebra::{DMatrix, DVector, Matrix3, Point2, Vector2};
use proptest::prelude::*;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

const TIMES: [f64; 4] = [0.0, 0.13, 0.31, 0.4];
const NOISE: f64 = 0.01;

/// Points and normals of a curve with nothing symmetric about it, moved by a map.
fn curve(map: &Matrix3<f64>) -> Vec<BoundaryPoint> {
    let at = |i: f64| {
        let t = std::f64::consts::TAU * i / 60.0;
        let body =
            nalgebra::Vector3::new(0.5 * t.cos() + 0.07 * (2.0 * t).cos(), 0.3 * t.sin() + 0.04 * (3.0 * t).cos(), 1.0);
        let moved = map * body;
        Point2::new(moved.x / moved.z, moved.y / moved.z)
    };
    (0..60)
        .map(|i| {
            let tangent: Vector2<f64> = at(f64::from(i) + 1e-4) - at(f64::from(i) - 1e-4);
            BoundaryPoint { point: at(f64::from(i)), normal: Vector2::new(tangent.y, -tangent.x).normalize() }
        })
        .collect()
}

fn flow(model: MotionModel, theta: &[f64], seconds: f64) -> Matrix3<f64> {
    model.flow(theta, seconds).into_inner()
}

/// The information by central differences of where every point goes, over pose and motion.
fn numerical_information(model: MotionModel, theta: &[f64]) -> DMatrix<f64> {
    let k = theta.len();
    let step = 1e-5;
    let mut information = DMatrix::zeros(2 * k, 2 * k);
    for time in TIMES {
        let now = curve(&flow(model, theta, time));
        let displaced = |index: usize, by: f64| -> Vec<Point2<f64>> {
            let (mut pose, mut motion) = (vec![0.0; k], theta.to_vec());
            if index < k {
                pose[index] += by;
            } else {
                motion[index - k] += by;
            }
            let map = flow(model, &motion, time) * flow(model, &pose, 1.0);
            curve(&map).into_iter().map(|p| p.point).collect()
        };
        let differences: Vec<_> = (0..2 * k).map(|j| (displaced(j, step), displaced(j, -step))).collect();
        for (i, BoundaryPoint { normal, .. }) in now.iter().enumerate() {
            let g = DVector::from_fn(2 * k, |j, _| {
                let (after, before) = &differences[j];
                normal.dot(&(after[i] - before[i])) / (2.0 * step)
            });
            information += &g * g.transpose() / (NOISE * NOISE);
        }
    }
    information
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn the_information_is_that_of_finite_differences_for_every_model(
        theta in proptest::array::uniform8(-1.0_f64..1.0),
        which in 0_usize..4,
    ) {
        let model = MotionModel::ALL[which];
        let mut theta = theta[..model.parameter_count()].to_vec();
        // A strong perspective would take the curve through infinity.
        theta.iter_mut().skip(6).for_each(|c| *c *= 0.3);
        let mut bound = CramerRaoBound::new(model, &theta).expect("a motion");
        for time in TIMES {
            bound.add_frame(time, curve(&flow(model, &theta, time)), NOISE, 1.0).expect("a frame");
        }
        let expected = numerical_information(model, &theta);
        let error = (bound.information() - &expected).norm() / expected.norm();
        prop_assert!(error < 1e-5, "{error}");
    }
}

fn rigid_bound(points: &[BoundaryPoint], frames: usize) -> CramerRaoBound {
    let mut bound = CramerRaoBound::new(MotionModel::Rigid, &[0.0; 3]).expect("a motion");
    for frame in 0..frames {
        bound.add_frame(frame as f64 / 30.0, points.iter().copied(), NOISE, 1.0).expect("a frame");
    }
    bound
}

#[test]
fn a_resting_circle_tells_nothing_of_its_rotation_and_an_edge_nothing_of_the_slide_along_it() {
    let circle: Vec<_> = (0..100)
        .map(|i| {
            let (y, x) = (0.1 * f64::from(i)).sin_cos();
            BoundaryPoint { point: Point2::new(x, y), normal: Vector2::new(x, y) }
        })
        .collect();
    let covariance = rigid_bound(&circle, 5).covariance().expect("finite");
    assert_eq!(covariance.observable, [false, true, true]);
    assert_eq!(covariance.rank, 4);
    let edge: Vec<_> = (0..100)
        .map(|i| BoundaryPoint { point: Point2::new(0.01 * f64::from(i), 0.3), normal: Vector2::y() })
        .collect();
    let covariance = rigid_bound(&edge, 5).covariance().expect("finite");
    assert_eq!(covariance.observable, [true, false, true]);
}

#[test]
fn one_frame_shows_no_motion_and_four_times_the_points_halve_the_bound() {
    let points = curve(&Matrix3::identity());
    assert_eq!(rigid_bound(&points, 1).covariance().expect("finite").observable, [false; 3]);
    let once = rigid_bound(&points, 4).covariance().expect("finite");
    let four_times = rigid_bound(&points.repeat(4), 4).covariance().expect("finite");
    for (a, b) in once.standard_deviations().zip(four_times.standard_deviations()) {
        let ratio = a.expect("observable") / b.expect("observable");
        assert!((ratio - 2.0).abs() < 1e-9, "{ratio}");
    }
}

#[test]
fn the_bound_of_a_translation_seen_twice_is_the_textbook_one() {
    // All normals along x: b1 from two frames is a difference of two means over the time between.
    let points =
        [Point2::new(0.5, 0.2), Point2::new(0.5, -0.2)].map(|point| BoundaryPoint { point, normal: Vector2::x() });
    let mut bound = CramerRaoBound::new(MotionModel::Rigid, &[0.0; 3]).expect("a motion");
    bound.add_frame(0.0, points, NOISE, 1.0).expect("a frame");
    bound.add_frame(0.5, points, NOISE, 1.0).expect("a frame");
    let covariance = bound.covariance().expect("finite");
    let b1 = covariance.standard_deviations().nth(1).flatten().expect("observable");
    assert!((b1 - NOISE / 0.5).abs() < 1e-9, "{b1}");
}

#[test]
fn an_efficient_estimator_reaches_the_bound() {
    // Least squares on the distances of noisy points from the known lines they were taken on, by finite differences: nothing
    // of it is shared with the bound.
    let (model, theta) = (MotionModel::Rigid, [0.9, -0.3, 0.4]);
    let mut bound = CramerRaoBound::new(model, &theta).expect("a motion");
    let truth: Vec<_> = TIMES.iter().map(|time| curve(&flow(model, &theta, *time))).collect();
    for (time, points) in TIMES.iter().zip(&truth) {
        bound.add_frame(*time, points.iter().copied(), NOISE, 1.0).expect("a frame");
    }
    // Where the points go with the pose at time 0 (first three) and the motion (last three).
    let places = |state: &DVector<f64>| -> Vec<Point2<f64>> {
        let (pose, motion) = state.as_slice().split_at(3);
        let frame = |time: &f64| curve(&(flow(model, motion, *time) * flow(model, pose, 1.0)));
        TIMES.iter().flat_map(frame).map(|p| p.point).collect()
    };
    let centre = DVector::from_iterator(6, [0.0; 3].into_iter().chain(theta));
    let lines: Vec<BoundaryPoint> = truth.concat();
    let mut jacobian = DMatrix::zeros(lines.len(), 6);
    for j in 0..6 {
        let step = DVector::from_fn(6, |i, _| if i == j { 1e-5 } else { 0.0 });
        let (after, before) = (places(&(&centre + &step)), places(&(&centre - &step)));
        for (i, line) in lines.iter().enumerate() {
            jacobian[(i, j)] = line.normal.dot(&(after[i] - before[i])) / 2e-5;
        }
    }
    let solve = (jacobian.transpose() * &jacobian).try_inverse().expect("observable") * jacobian.transpose();
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let mut draw = || -> f64 { NOISE * rng.sample::<f64, _>(StandardNormal) };
    let deviations: Vec<f64> =
        bound.covariance().expect("finite").standard_deviations().map(|std| std.expect("observable")).collect();
    let (mut squares, runs) = ([0.0; 3], 400);
    for _ in 0..runs {
        let seen: Vec<_> = lines.iter().map(|line| line.point + Vector2::new(draw(), draw())).collect();
        let mut state = centre.clone();
        for _ in 0..4 {
            let now = places(&state);
            let missing =
                lines.iter().zip(seen.iter().zip(&now)).map(|(line, (seen, now))| line.normal.dot(&(seen - now)));
            state += &solve * DVector::from_iterator(lines.len(), missing);
        }
        for (j, square) in squares.iter_mut().enumerate() {
            *square += ((state[3 + j] - theta[j]) / deviations[j]).powi(2) / f64::from(runs);
        }
    }
    // Each is uncertain by 3.5 %.
    for (name, square) in ["omega", "b1", "b2"].iter().zip(squares) {
        let ratio = square.sqrt();
        assert!((ratio - 1.0).abs() < 0.12, "{name}: {ratio}");
    }
}

#[test]
fn bad_input_is_refused_with_the_reason() {
    let new = |theta: &[f64]| CramerRaoBound::new(MotionModel::Rigid, theta).err();
    assert_eq!(new(&[0.0; 2]), Some(BoundError::ParameterCount { found: 2, needed: 3 }));
    assert!(matches!(new(&[0.0, f64::NAN, 0.0]), Some(BoundError::ParameterNotFinite { index: 1, .. })));
    let mut bound = CramerRaoBound::new(MotionModel::Rigid, &[0.0; 3]).expect("a motion");
    assert_eq!(bound.add_frame(0.0, [], 0.0, 1.0), Err(BoundError::Noise { value: 0.0 }));
    assert!(matches!(bound.add_frame(f64::NAN, [], 0.1, 1.0), Err(BoundError::Frame { .. })));
    assert!(matches!(bound.add_frame(0.0, [], 0.1, -1.0), Err(BoundError::Frame { .. })));
    let bad = BoundaryPoint { point: Point2::new(f64::NAN, 0.0), normal: Vector2::x() };
    bound.add_frame(0.0, [bad], 0.1, 1.0).expect("points are not looked at one by one");
    assert_eq!(bound.covariance(), Err(BoundError::InformationNotFinite));
}
