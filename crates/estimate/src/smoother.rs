use freeform_riccati::{ParameterVector, logarithm};
use nalgebra::{DVector, Matrix3};

use crate::{
    information::scaled_inverse,
    motion_state::{MotionState, Transition},
    process_noise::ProcessNoise,
};

/// Why states cannot be smoothed together.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SmootherError {
    /// Times must increase.
    #[error("state {index} at {time} s after one at {previous} s")]
    TimeNotIncreasing {
        /// Position of the state, counted from 0.
        index: usize,
        /// Time of the state before, in seconds.
        previous: f64,
        /// Its time.
        time: f64,
    },
    /// The states are not of one run of a filter: another model, or another first outline.
    #[error("state {index} is of another run than the ones before it")]
    AnotherRun {
        /// Position of the state, counted from 0.
        index: usize,
    },
}

/// What every state is known to be once all frames have been seen: fixed-interval smoothing (Rauch, Tung, Striebel 1965) of the
/// states that a filter was in after each frame, with the process noise that it was run with. Pose errors are taken on the group,
/// on the left.
///
/// With the process noise Q and the covariance p of pose and motion where the outline is given, the gain is `F^-1 (I - Q (F p F' +
/// Q)^-1)`: of an outline that is estimated along, this is the share of pose and motion in the gain of the whole, and what later frames
/// have changed in the outline is left out. Without process noise every smoothed state is the last one taken back along the motion.
///
/// ```
/// use freeform_estimate::{NormalisedState, ProcessNoise, smooth};
/// use freeform_riccati::MotionModel;
/// use nalgebra::{DMatrix, Matrix3, Point2};
///
/// // Two states of an object; the second frame contains much more information than the first.
/// let state = |time: f64, omega: f64, variance: f64| NormalisedState {
///     model: MotionModel::Rigid,
///     time,
///     origin: Point2::origin(),
///     radius: 1.0,
///     pose: MotionModel::Rigid.flow(&[omega * time, 0.0, 0.0], 1.0).into_inner(),
///     motion: [omega, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
///     covariance: variance * DMatrix::identity(6, 6),
///     body_frame: DMatrix::zeros(3, 3),
///     covariance_given_outline: variance * DMatrix::identity(6, 6),
///     observable: [true; 8],
///     hidden: [false; 8],
///     centroid: Point2::origin(),
/// };
/// let states = [state(0.1, 1.4, 1e-2).into(), state(0.2, 1.5, 1e-6).into()];
/// let smoothed = smooth(&states, &ProcessNoise::default())?;
/// // Without process noise the motion was the same all the time.
/// assert_eq!(smoothed[0].motion().values()[0], 1.5);
/// assert!((smoothed[0].pose_parameters()[0].value - 0.15).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Times that do not increase; states of different runs. A run ends where the filter finds the object anew: its states before and after
/// that are smoothed apart.
pub fn smooth(states: &[MotionState], noise: &ProcessNoise) -> Result<Vec<MotionState>, SmootherError> {
    from_the_last_back(states, |_, state, next| taken_back(state, next, noise))
}

/// States of one run smoothed one after the other, the last first: each, at its position, becomes what is made of it and of the smoothed one after it,
/// and stays as it was filtered where that is `None`.
pub(crate) fn from_the_last_back(
    states: &[MotionState],
    better: impl Fn(usize, &MotionState, &MotionState) -> Option<MotionState>,
) -> Result<Vec<MotionState>, SmootherError> {
    for (i, pair) in states.windows(2).enumerate() {
        let [a, b] = pair else { continue };
        let index = i + 1;
        if a.time.is_nan() || b.time.is_nan() || b.time <= a.time {
            return Err(SmootherError::TimeNotIncreasing { index, previous: a.time, time: b.time });
        }
        if (a.model, a.origin, a.radius) != (b.model, b.origin, b.radius) {
            return Err(SmootherError::AnotherRun { index });
        }
    }
    let mut smoothed = states.to_vec();
    for t in (1..states.len()).rev() {
        if let Some(state) = better(t - 1, &smoothed[t - 1], &smoothed[t]) {
            smoothed[t - 1] = state;
        }
    }
    Ok(smoothed)
}

/// By how much a pose and a motion lie off a state: the pose on the group, on the left, then the motion.
pub(crate) fn difference(
    (pose, motion): (&Matrix3<f64>, &ParameterVector),
    state: &MotionState,
) -> Option<DVector<f64>> {
    let k = state.model.parameter_count();
    let of_pose = state.model.parameters_of(&logarithm(&(pose * state.pose.try_inverse()?))?);
    Some(DVector::from_fn(2 * k, |i, _| if i < k { of_pose[i] } else { motion[i - k] - state.motion[i - k] }))
}

/// A filtered state corrected by the smoothed one after it; `None` where numbers do not allow it.
fn taken_back(state: &MotionState, next: &MotionState, process_noise: &ProcessNoise) -> Option<MotionState> {
    let k = state.model.parameter_count();
    // Linearised at the smoothed motion, so that without process noise the path is met exactly.
    let Transition { flow, matrix, inverse: back, noise } = next.transition(next.time - state.time, process_noise);
    let pose = flow.try_inverse()? * next.pose;
    let mut gain = back.clone();
    let mut correction = DVector::zeros(2 * k);
    if noise.iter().any(|q| *q > 0.0) {
        let within = &matrix * &state.within * matrix.transpose() + &noise;
        let drifted = &back * &noise * scaled_inverse(&within)?;
        gain -= &drifted;
        correction = -(drifted * &matrix * difference((&pose, &next.motion), state)?);
    }
    let predicted = &matrix * &state.covariance * matrix.transpose() + &noise;
    let covariance = &state.covariance + &gain * (&next.covariance - predicted) * gain.transpose();
    if !(correction.iter().all(|e| e.is_finite()) && covariance.iter().all(|e| e.is_finite())) {
        return None;
    }
    let mut better = state.clone();
    better.pose = state.model.flow(&correction.as_slice()[..k], 1.0).into_inner() * pose;
    (0..k).for_each(|j| better.motion[j] = next.motion[j] + correction[k + j]);
    better.covariance = 0.5 * (&covariance + covariance.transpose());
    // One error that all poses have in common: the last state says it, as what it knows of the outline is no part of it any more.
    let carried = back.view((0, 0), (k, k));
    better.body_frame = carried * &next.body_frame * carried.transpose();
    better.observable.iter_mut().zip(next.observable).for_each(|(seen, later)| *seen |= later);
    Some(better)
}
