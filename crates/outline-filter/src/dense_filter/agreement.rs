//! Prediction and process noise against the reference. The update is compared in `update::solve`, growth in `track::growth` and shape
//! process noise in `prediction::shape_noise`, beside what they test.
use freeform_estimate::ProcessNoise;
use freeform_riccati::{MAX_PARAMETERS, MotionModel, map_point};
use nalgebra::{DMatrix, Point2, Vector2};
use proptest::prelude::*;

use super::{AGREES, DenseFilter, Problem, random_measurements, transition};
use crate::{
    belief::{Belief, StateMatrix, StateVector},
    measurement::{Frame, Measurement},
    tuning::update::GAUGE_WEIGHT,
    update::accumulate,
};

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_prediction_moves_mean_and_covariance_as_the_dense_filter_does(mut problem in Problem::any()) {
        let seconds = problem.seconds();
        let belief = &mut problem.belief;
        let mut dense = DenseFilter::of(&belief.information);
        dense.predict(&transition(belief.model, &belief.motion[..belief.parameter_count()], seconds));
        let flow = (belief.model.generator(&belief.motion[..belief.parameter_count()]) * seconds).exp();
        let expected = flow * belief.pose;
        prop_assert!(belief.predict(seconds, |_| true).is_some());
        // Projective maps are the same up to a factor.
        let pose = belief.pose * (expected[(2, 2)] / belief.pose[(2, 2)]);
        prop_assert!((pose - expected).norm() < AGREES * expected.norm());
        let difference = dense.difference(&belief.information, |_, _| true);
        prop_assert!(difference < AGREES, "{difference}");
        let difference = dense.difference_of_marginal(&belief.marginal);
        prop_assert!(difference < AGREES, "marginal {difference}");
    }

    #[test]
    fn process_noise_is_exact_for_pose_and_motion_each_offset_and_what_binds_them(mut problem in Problem::any()) {
        let added = problem.covariance();
        let belief = &mut problem.belief;
        let mut dense = DenseFilter::of(&belief.information);
        dense.add_covariance(&added);
        belief.add_covariance(&added);
        let state = dense.state;
        let difference = dense.difference(&belief.information, |i, j| i < state || j < state || i == j);
        prop_assert!(difference < AGREES, "{difference}");
        let difference = dense.difference_of_marginal(&belief.marginal);
        prop_assert!(difference < AGREES, "marginal {difference}");
    }

    /// With `G = P (P + Q)^-1` and slopes b of the offsets on pose and motion, offsets i and j lose `b_i' (P - G P) b_j`.
    #[test]
    fn process_noise_drops_what_offsets_would_know_of_each_other_beyond_pose_and_motion(mut problem in Problem::any()) {
        let added = problem.covariance();
        let belief = &mut problem.belief;
        let mut dense = DenseFilter::of(&belief.information);
        let state = dense.state;
        let before = dense.covariance.view((0, 0), (state, state)).clone_owned();
        let after = &before + added.view((0, 0), (state, state));
        let rest = &before - &before * after.cholesky().expect("positive definite").inverse() * &before;
        let cells = &belief.information.cells;
        let couplings: Vec<_> = cells.couplings().collect();
        let slopes = DMatrix::from_fn(state, cells.len(), |i, j| -couplings[j][i] / cells.own()[j]);
        let mut dropped = slopes.transpose() * rest * &slopes;
        dropped.fill_diagonal(0.0);
        let largest = dropped.amax();
        dense.add_covariance(&added);
        let mut of_offsets = dense.covariance.view_mut((state, state), dropped.shape());
        of_offsets -= dropped;
        belief.add_covariance(&added);
        let difference = dense.difference(&belief.information, |_, _| true);
        prop_assert!(difference < AGREES, "{difference}");
        prop_assert!(largest > 1e-6, "nothing to drop: {largest}");
    }

    /// Without process noise nothing is dropped, however long it goes on.
    #[test]
    fn predictions_and_frames_in_turn_stay_with_the_dense_filter(mut problem in Problem::any()) {
        let (model, k) = (problem.belief.model, problem.belief.parameter_count());
        let cells = problem.belief.offsets.len();
        let mut dense = DenseFilter::of(&problem.belief.information);
        for _ in 0..4 {
            let seconds = problem.seconds();
            dense.predict(&transition(model, &problem.belief.motion[..k], seconds));
            prop_assert!(problem.belief.predict(seconds, |_| true).is_some());
            let measurements = random_measurements(&mut problem.rng, k, 0..cells, 2 * cells);
            measurements.iter().for_each(|m| dense.measure(m));
            let mut frame = Frame::of_measurements(measurements, cells);
            accumulate(&mut frame, &mut problem.belief.information, &StateVector::zeros());
            problem.belief.marginal = problem.belief.information.marginal();
        }
        let difference = dense.difference(&problem.belief.information, |_, _| true);
        prop_assert!(difference < AGREES, "{difference}");
    }

    /// True poses are `expm(X)` after those believed: the transition is the derivative of that error by the errors before.
    #[test]
    fn the_transition_is_the_derivative_of_the_left_error_of_the_pose(mut problem in Problem::any()) {
        let seconds = problem.seconds();
        let (model, belief) = (problem.belief.model, &problem.belief);
        let k = model.parameter_count();
        let expected = transition(model, &belief.motion[..k], seconds);
        let believed = model.flow(&belief.motion[..k], seconds).into_inner() * belief.pose;
        let step = 1e-4;
        for j in 0..2 * k {
            let error_after = |size: f64| {
                let (mut error, mut motion) = ([0.0; MAX_PARAMETERS], belief.motion);
                if j < k { error[j] = size } else { motion[j - k] += size }
                let before = model.flow(&error[..k], 1.0).into_inner() * belief.pose;
                let truth = model.flow(&motion[..k], seconds).into_inner() * before;
                let change = truth * believed.try_inverse().expect("a pose");
                model.motion_between(&change, 1.0).expect("a small change")
            };
            let (forth, back) = (error_after(step), error_after(-step));
            for i in 0..k {
                let slope = (forth[i] - back[i]) / (2.0 * step);
                prop_assert!((slope - expected[(i, j)]).abs() < 1e-5, "{i} {j}: {slope} {}", expected[(i, j)]);
            }
        }
    }
}

#[test]
fn a_new_pose_keeps_what_each_offset_is_known_to_where_the_pose_is_given() {
    for model in MotionModel::ALL {
        let mut problem = Problem::of(model, 5, 1);
        let own = problem.belief.information.cells.own().to_vec();
        let pose = problem.belief.pose;
        problem.belief.relocate(pose);
        let dense = DenseFilter::of(&problem.belief.information);
        for (number, own) in own.into_iter().enumerate() {
            let at = dense.state + number;
            assert!((dense.covariance[(at, at)] * own - 1.0).abs() < AGREES);
        }
    }
}

/// A turning egg of 16 cells, seen by 200 points in every frame, whose motion changes by so much in a second: deviations of pose and
/// motion by the arrowhead filter over those of the dense one, after so many frames.
fn deviations_over_those_of_the_dense_filter(frames: usize, changes: f64) -> Vec<f64> {
    let (cells, points, sigma, seconds) = (16, 12.5, 0.005, 1.0 / 30.0);
    let model = MotionModel::Rigid;
    let mut belief = Belief::new(model);
    belief.motion[..3].copy_from_slice(&[1.0, 0.2, -0.1]);
    let gauge = GAUGE_WEIGHT * points * cells as f64;
    (0..3).for_each(|i| (belief.information.dense[i][i], belief.information.dense[3 + i][3 + i]) = (gauge, 1e-2));
    belief.information.cells.resize(cells);
    belief.information.cells.own_mut().fill(1e-3);
    belief.marginal = belief.information.marginal();
    let noise = ProcessNoise { rates: changes, velocities: changes };
    let mut added = StateMatrix::zeros();
    for (j, per_second) in noise.variances(model, 1.0).into_iter().enumerate().take(3) {
        added[(3 + j, 3 + j)] = per_second * seconds / (sigma * sigma);
    }
    let mut dense = DenseFilter::of(&belief.information);
    for frame in 0..frames {
        if frame > 0 {
            dense.predict(&transition(model, &belief.motion[..3], seconds));
            assert!(belief.predict(seconds, |_| true).is_some());
            dense.add_covariance(&added);
            belief.add_process_noise(&noise, seconds, 1.0, sigma * sigma);
        }
        let of_cell = |cell: usize| {
            let t = std::f64::consts::TAU * cell as f64 / cells as f64;
            let normal = belief.pose.fixed_view::<2, 2>(0, 0) * Vector2::new(0.6 * t.cos(), t.sin()).normalize();
            let at = map_point(&belief.pose, &Point2::new(t.cos() + 0.1 * (2.0 * t).cos(), 0.6 * t.sin()));
            let jacobian = model.normal_velocities(&at, &normal);
            Measurement { cell, residual: 0.0, by_offset: 1.0, jacobian, weight: points }
        };
        let measurements: Vec<_> = (0..cells).map(of_cell).collect();
        measurements.iter().for_each(|m| dense.measure(m));
        let mut frame = Frame::of_measurements(measurements, cells);
        accumulate(&mut frame, &mut belief.information, &StateVector::zeros());
        belief.marginal = belief.information.marginal();
    }
    let covariance = belief.covariance_of(&belief.marginal, 1.0).expect("a covariance");
    (0..6).map(|i| (covariance[(i, i)] / dense.covariance[(i, i)]).sqrt()).collect()
}

/// What is dropped says how well the outline as a whole is known in the body frame, in which the pose is told: the deviations of the pose
/// are too small, those of the motion, for which the body frame does not matter, hardly. docs/motion-filter.md tells these figures.
#[test]
fn what_process_noise_drops_is_missing_in_the_deviations_of_the_pose_and_hardly_in_those_of_the_motion() {
    let still = deviations_over_those_of_the_dense_filter(100, 0.0);
    assert!(still.iter().all(|ratio| (ratio - 1.0).abs() < 1e-6), "{still:?}");
    let mut least = 1.0;
    for changes in [0.001, 0.01, 0.1, 1.0] {
        for frames in [3, 30, 100, 300] {
            let ratios = deviations_over_those_of_the_dense_filter(frames, changes);
            let (pose, motion) = ratios.split_at(3);
            assert!(motion.iter().all(|ratio| (0.96..1.001).contains(ratio)), "{changes} {frames}: {motion:?}");
            assert!(pose.iter().all(|ratio| (0.6..1.001).contains(ratio)), "{changes} {frames}: {pose:?}");
            least = pose.iter().fold(least, |least: f64, ratio| least.min(*ratio));
        }
    }
    assert!((0.6..0.7).contains(&least), "the figure of the documents is another: {least}");
}
