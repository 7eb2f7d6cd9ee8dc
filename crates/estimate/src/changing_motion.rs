//! Smoothing of a motion that changes from frame to frame.
use freeform_riccati::{MotionModel, ParameterVector, logarithm};
use nalgebra::{DMatrix, DVector, Matrix3, Point2};

use crate::{
    information::scaled_inverse,
    motion_state::{MotionState},
    process_noise::ProcessNoise,
    smoother::{SmootherError, check},
};

/// What was expected of an object before a frame was looked at, from the frames before it.
#[derive(Debug, Clone, PartialEq)]
pub struct ExpectedState {
    /// Pose and motion, with the covariance of the prediction.
    pub state: MotionState,
    /// How far the velocity of the centroid goes with the turn of the object, from 0, where it stays the same, to 1, where it turns with it: the
    /// probability of a constant generator.
    pub turning_velocity: f64,
}

/// Beyond this squared distance from what was expected, for each parameter of pose and motion, a state is of another motion: what later frames tell of
/// that says nothing of the one before. By chance one in ten thousand states of a rigid motion is.
const ANOTHER_MOTION: f64 = 4.5;

/// No variance grows by more than this factor: where a change has been found, less is known than before, and nothing of that is handed back.
const NO_WORSE: f64 = 1.2;

/// Displacement, normalised, and rates by which derivatives are taken as differences: errors of a second order are a millionth of it, those of rounding less.
const DIFFERENCE: f64 = 1e-5;

/// What every state is known to be once all frames have been seen, of a motion that may change in between: fixed-interval smoothing (Rauch, Tung,
/// Striebel 1965) by what was expected of each state from the one before. `expected[t]` belongs to `states[t]`; where it is `None`, and where a state is
/// of another motion than was expected, nothing is handed back to the states before.
///
/// With F the derivative of the expected state by the one before, p the covariance of that where the outline is given and p' that of what was expected,
/// the gain is `p F' p'^-1`. What hypotheses of several dynamics expect together counts as one normal distribution.
///
/// # Errors
/// As [`smooth`](crate::smooth).
pub fn smooth_changing(
    states: &[MotionState],
    expected: &[Option<ExpectedState>],
) -> Result<Vec<MotionState>, SmootherError> {
    check(states)?;
    let mut smoothed = states.to_vec();
    for t in (1..states.len()).rev() {
        let (before, after) = smoothed.split_at_mut(t);
        let expected = expected.get(t).and_then(Option::as_ref);
        if let (Some(state), Some(next), Some(expected)) = (before.last_mut(), after.first(), expected)
            && is_as_expected(&states[t], &expected.state)
            && let Some(better) = taken_back(state, next, expected)
        {
            *state = better;
        }
    }
    Ok(smoothed)
}

/// Whether a state is of the motion that was expected.
fn is_as_expected(found: &MotionState, expected: &MotionState) -> bool {
    let Some(difference) = difference(found, expected) else { return false };
    // What the frame has told makes up for the difference of the covariances; the sum of both is the least that can be said where rounding leaves that
    // indefinite.
    let told = &expected.within - &found.within;
    let squared = |covariance: &DMatrix<f64>| {
        let information = scaled_inverse(covariance)?;
        Some((difference.transpose() * information * &difference)[(0, 0)])
    };
    let least = squared(&(&expected.within + &found.within));
    let distance = squared(&told).filter(|squared| *squared >= 0.0).or(least);
    distance.is_some_and(|squared| squared <= ANOTHER_MOTION * difference.len() as f64)
}

/// By how much a state lies off another: the pose on the group, on the left, then the motion.
fn difference(state: &MotionState, from: &MotionState) -> Option<DVector<f64>> {
    let k = state.model.parameter_count();
    let pose = logarithm(&(state.pose * from.pose.try_inverse()?))?;
    let pose = state.model.parameters_of(&pose);
    Some(DVector::from_fn(2 * k, |i, _| if i < k { pose[i] } else { state.motion[i - k] - from.motion[i - k] }))
}

/// A filtered state corrected by the smoothed one after it; `None` where numbers do not allow it.
fn taken_back(state: &MotionState, next: &MotionState, expected: &ExpectedState) -> Option<MotionState> {
    let k = state.model.parameter_count();
    let derivative = derivative(state, expected)?;
    let gain = &state.within * derivative.transpose() * scaled_inverse(&expected.state.within)?;
    let correction = &gain * difference(next, &expected.state)?;
    let covariance = &state.covariance + &gain * (&next.covariance - &expected.state.covariance) * gain.transpose();
    let within = &state.within + &gain * (&next.within - &expected.state.within) * gain.transpose();
    let is_better = |covariance: &DMatrix<f64>, before: &DMatrix<f64>| {
        (0..2 * k).all(|i| (0.0..=NO_WORSE * before[(i, i)]).contains(&covariance[(i, i)]))
    };
    if !correction.iter().all(|entry| entry.is_finite())
        || !is_better(&covariance, &state.covariance)
        || !is_better(&within, &state.within)
    {
        return None;
    }
    let mut better = state.clone();
    better.pose = state.model.flow(&correction.as_slice()[..k], 1.0).into_inner() * state.pose;
    (0..k).for_each(|j| better.motion[j] += correction[k + j]);
    better.covariance = 0.5 * (&covariance + covariance.transpose());
    better.within = 0.5 * (&within + within.transpose());
    // Later frames do not tell where the body frame lies beside the outline, but that what was known of it later holds for all poses.
    let back = adjoint(state.model, &(better.pose * next.pose.try_inverse()?))?;
    better.body_frame = &back * &next.body_frame * back.transpose();
    Some(better)
}

/// The adjoint of a map as a matrix of the size of the model.
fn adjoint(model: MotionModel, map: &Matrix3<f64>) -> Option<DMatrix<f64>> {
    let k = model.parameter_count();
    let adjoint = model.adjoint(map, &map.try_inverse()?);
    Some(DMatrix::from_fn(k, k, |i, j| adjoint[i][j]))
}

/// The derivative of what is expected of a state at a later time by the state.
fn derivative(state: &MotionState, expected: &ExpectedState) -> Option<DMatrix<f64>> {
    let seconds = expected.state.time - state.time;
    let generator = state.transition(seconds, &ProcessNoise::default()).matrix;
    let turning = expected.turning_velocity.clamp(0.0, 1.0);
    if turning == 1.0 || state.model == MotionModel::Projective {
        return Some(generator);
    }
    Some(turning * generator + (1.0 - turning) * derivative_of_straight(state, seconds)?)
}

/// The derivative of a state whose rates and whose velocity of the centroid stay the same.
fn derivative_of_straight(state: &MotionState, seconds: f64) -> Option<DMatrix<f64>> {
    let (model, k) = (state.model, state.model.parameter_count());
    let after = |pose: &Matrix3<f64>, motion: &ParameterVector| straight(model, (pose, motion), &state.centroid, seconds);
    let (pose, motion) = after(&state.pose, &state.motion);
    let back = pose.try_inverse()?;
    let mut derivative = DMatrix::zeros(2 * k, 2 * k);
    for j in 0..2 * k {
        let (mut of_pose, mut other) = (ParameterVector::default(), state.motion);
        if j < k { of_pose[j] = DIFFERENCE } else { other[j - k] += DIFFERENCE }
        let moved = model.flow(&of_pose[..k], 1.0).into_inner() * state.pose;
        let (moved, later) = after(&moved, &other);
        let change = model.parameters_of(&logarithm(&(moved * back))?);
        for i in 0..k {
            derivative[(i, j)] = change[i] / DIFFERENCE;
            derivative[(k + i, j)] = (later[i] - motion[i]) / DIFFERENCE;
        }
    }
    Some(derivative)
}

/// Pose and motion after some time in which the rates and the velocity of the centroid stay the same; the centroid is given in the body frame.
fn straight(
    model: MotionModel,
    (pose, motion): (&Matrix3<f64>, &ParameterVector),
    centroid: &Point2<f64>,
    seconds: f64,
) -> (Matrix3<f64>, ParameterVector) {
    let k = model.parameter_count();
    let generator = model.generator(&motion[..k]);
    let linear = |m: &Matrix3<f64>| m.fixed_view::<2, 2>(0, 0).into_owned();
    let part = |m: &Matrix3<f64>| m.fixed_view::<2, 1>(0, 2).into_owned();
    let here = linear(pose) * centroid.coords + part(pose);
    let velocity = linear(&generator) * here + part(&generator);
    let there = here + seconds * velocity;
    let turned = model.linear_flow(&motion[..k], seconds) * linear(pose);
    let mut later = Matrix3::identity();
    later.fixed_view_mut::<2, 2>(0, 0).copy_from(&turned);
    later.fixed_view_mut::<2, 1>(0, 2).copy_from(&(there - turned * centroid.coords));
    let mut of_later = generator;
    of_later.fixed_view_mut::<2, 1>(0, 2).copy_from(&(velocity - linear(&generator) * there));
    (later, model.parameters_of(&of_later))
}
