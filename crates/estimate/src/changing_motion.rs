//! Smoothing of a motion that changes from frame to frame.
use freeform_riccati::MotionModel;
use nalgebra::{DMatrix, Matrix3};

use crate::{
    expected_derivative::derivative,
    information::scaled_inverse,
    motion_state::MotionState,
    smoother::{SmootherError, difference, from_the_last_back},
};

/// What was expected of an object before a frame was looked at, from the frames before it.
#[derive(Debug, Clone, PartialEq)]
pub struct ExpectedState {
    /// Pose and motion at the time of the frame, with the covariance of the prediction.
    pub state: MotionState,
    /// How far the velocity of the centroid goes with the turn of the object, from 0, where it stays the same, to 1, where it turns with it: the
    /// probability of a constant generator.
    pub turning_velocity: f64,
}

/// Squared distances that one in ten thousand of what is expected is beyond: chi square with 3, 4, 6 and 8 degrees of freedom.
const ANOTHER_MOTION: [(usize, f64); 4] = [(3, 21.1), (4, 23.5), (6, 27.9), (8, 31.8)];

/// What every state is known to be once all frames have been seen, of a motion that may change in between: fixed-interval smoothing (Rauch, Tung,
/// Striebel 1965) by what was expected of each state from the one before, by whatever dynamics. What several hypotheses of these expect together
/// counts as one normal distribution, as in the merging of the generalised pseudo-Bayesian estimators (Bar-Shalom, Li, Kirubarajan 2001, 11.6).
///
/// `expected[t]` belongs to `states[t]`. Where it is `None` or missing, where a state is of another motion than was expected, or known less well, and
/// where numbers do not allow it, nothing is handed back to the states before: they are smoothed by those between alone.
///
/// With F the derivative of the expected state by the one before, p the covariance of that where the outline is given and p' that of what was
/// expected, the gain is `K = p F' (F p F' + a)^-1`, where a is what `p' - F p F'` has of positive eigenvalues, and the covariance where the outline
/// is given `(I - K F) p (I - K F)' + K (a + q) K'`, with q that of the smoothed state after. Deviations become smaller by no more than that: what
/// frames have in common, the outline, edges that lie off, does not average out.
///
/// ```
/// use freeform_estimate::{ExpectedState, NormalisedState, ProcessNoise, smooth_changing};
/// use freeform_riccati::MotionModel;
/// use nalgebra::{DMatrix, Matrix3, Point2};
///
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
/// // The second frame tells more than the first; the motion may have changed in between by 0.1 rad/s.
/// let states = [state(0.1, 1.45, 1e-2).into(), state(0.2, 1.5, 1e-4).into()];
/// let expected = ExpectedState { state: state(0.2, 1.45, 2e-2).into(), turning_velocity: 1.0 };
/// let smoothed = smooth_changing(&states, &[None, Some(&expected)])?;
/// let omega = smoothed[0].motion().values()[0];
/// assert!(omega > 1.46 && omega < 1.49);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`smooth`](crate::smooth).
pub fn smooth_changing(
    states: &[MotionState],
    expected: &[Option<&ExpectedState>],
) -> Result<Vec<MotionState>, SmootherError> {
    from_the_last_back(states, |t, state, next| {
        let expected = expected.get(t + 1).copied().flatten()?;
        is_as_expected(&states[t + 1], &expected.state).then(|| taken_back(state, next, expected)).flatten()
    })
}

/// Whether a state is of the motion that was expected, and known as well at least: by how much a frame has moved the pose, in deviations of what a
/// frame moves it by.
fn is_as_expected(found: &MotionState, expected: &MotionState) -> bool {
    let Some(difference) = difference((&found.pose, &found.motion), expected) else { return false };
    let k = found.model.parameter_count();
    let Some((_, limit)) = ANOTHER_MOTION.into_iter().find(|(parameters, _)| *parameters == k) else { return false };
    let of_pose = difference.rows(0, k);
    let squared = |covariance: &DMatrix<f64>| {
        let information = scaled_inverse(&covariance.view((0, 0), (k, k)).into_owned())?;
        Some((of_pose.transpose() * information * of_pose)[(0, 0)])
    };
    // Where rounding leaves their difference indefinite, the sum of both covariances is the most that a frame moves a pose by.
    let told = squared(&(&expected.within - &found.within)).filter(|squared| *squared >= 0.0);
    let distance = told.or_else(|| squared(&(&expected.within + &found.within)));
    let is_known = (0..2 * k).all(|i| found.within[(i, i)] <= ROUNDED * expected.within[(i, i)]);
    is_known && distance.is_some_and(|squared| squared <= limit)
}

/// A variance that is larger by less than this is so by rounding.
const ROUNDED: f64 = 1.0 + 1e-9;

/// No number of a state is corrected by more than this many deviations: what says so is of another motion. One in ten thousand is by chance.
const LARGEST_CORRECTION: f64 = 3.9;

/// A filtered state corrected by the smoothed one after it; `None` where numbers do not allow it.
fn taken_back(state: &MotionState, next: &MotionState, expected: &ExpectedState) -> Option<MotionState> {
    let k = state.model.parameter_count();
    let derivative = derivative(state, expected)?;
    let by = |map: &DMatrix<f64>, covariance: &DMatrix<f64>| map * covariance * map.transpose();
    let moved = by(&derivative, &state.within);
    // Hypotheses of dynamics may have expected the state better than what is known of the one before tells: nothing has been added then.
    let added = without_negative(&expected.state.within, &(&expected.state.within - &moved))?;
    let gain = &state.within * derivative.transpose() * scaled_inverse(&(moved + &added))?;
    let correction = &gain * difference((&next.pose, &next.motion), &expected.state)?;
    let kept = DMatrix::identity(2 * k, 2 * k) - &gain * &derivative;
    let within = by(&kept, &state.within) + by(&gain, &(added + &next.within));
    let is_likely = |i: usize| correction[i].abs() <= LARGEST_CORRECTION * state.within[(i, i)].max(0.0).sqrt();
    if !(0..2 * k).all(is_likely) || !within.iter().all(|entry| entry.is_finite()) {
        return None;
    }
    let mut better = state.clone();
    better.pose = state.model.flow(&correction.as_slice()[..k], 1.0).into_inner() * state.pose;
    (0..k).for_each(|j| better.motion[j] += correction[k + j]);
    let shares: Vec<f64> = (0..2 * k).map(|i| share_left(state, &within, i).sqrt()).collect();
    better.covariance = DMatrix::from_fn(2 * k, 2 * k, |i, j| shares[i] * shares[j] * state.covariance[(i, j)]);
    better.within = 0.5 * (&within + within.transpose());
    // Later frames do not tell where the body frame lies beside the outline, but that what was known of it later holds for all poses.
    let back = adjoint(state.model, &(better.pose * next.pose.try_inverse()?))?;
    better.body_frame = &back * &next.body_frame * back.transpose();
    Some(better)
}

/// The share of a variance of a state that is left where that given the outline becomes another: less by as much, but no less than that, as
/// hypotheses of dynamics may know a state better than it is known without them.
fn share_left(state: &MotionState, within: &DMatrix<f64>, i: usize) -> f64 {
    let (all, before, after) = (state.covariance[(i, i)], state.within[(i, i)], within[(i, i)]);
    if all <= 0.0 {
        return 1.0;
    }
    ((all - before + after).max(after) / all).clamp(0.0, 1.0)
}

/// A symmetric matrix without its negative eigenvalues, which are found in the deviations of a covariance, so that units do not matter. `None` where
/// a number is not finite.
fn without_negative(covariance: &DMatrix<f64>, matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let size = covariance.nrows();
    let scale: Vec<f64> = covariance.diagonal().iter().map(|variance| variance.max(f64::MIN_POSITIVE).sqrt()).collect();
    let scaled = DMatrix::from_fn(size, size, |i, j| 0.5 * (matrix[(i, j)] + matrix[(j, i)]) / (scale[i] * scale[j]));
    let mut eigen = scaled.iter().all(|entry| entry.is_finite()).then(|| scaled.symmetric_eigen())?;
    eigen.eigenvalues.apply(|value| *value = value.max(0.0));
    let positive = eigen.recompose();
    Some(DMatrix::from_fn(size, size, |i, j| positive[(i, j)] * scale[i] * scale[j]))
}

/// The adjoint of a map as a matrix of the size of the model.
fn adjoint(model: MotionModel, map: &Matrix3<f64>) -> Option<DMatrix<f64>> {
    let k = model.parameter_count();
    let adjoint = model.adjoint(map, &map.try_inverse()?);
    Some(DMatrix::from_fn(k, k, |i, j| adjoint[i][j]))
}

#[cfg(test)]
mod tests {
    use freeform_riccati::{ParameterVector, logarithm};
    use nalgebra::{DVector, Point2};

    use super::*;
    use crate::{
        expected_derivative::straight, motion_state::NormalisedState, process_noise::ProcessNoise, smoother::smooth,
    };

    const RIGID: MotionModel = MotionModel::Rigid;
    const STEP: f64 = 0.1;
    const CENTROID: Point2<f64> = Point2::new(0.2, -0.1);

    fn state(time: f64, (pose, motion): (Matrix3<f64>, ParameterVector), covariance: DMatrix<f64>) -> MotionState {
        MotionState::from(NormalisedState {
            model: RIGID,
            time,
            origin: Point2::origin(),
            radius: 1.0,
            pose,
            motion,
            covariance_given_outline: covariance.clone(),
            covariance,
            body_frame: DMatrix::zeros(3, 3),
            observable: [true; 8],
            hidden: [false; 8],
            centroid: CENTROID,
        })
    }

    /// Numbers that have nothing in common (Lehmer), about normal, each the sum of twelve.
    fn noise(seed: u64) -> impl FnMut() -> f64 {
        let mut state = seed;
        let mut uniform = move || {
            state = state * 48_271 % 2_147_483_647;
            state as f64 / 2_147_483_647.0 - 0.5
        };
        move || (0..12).map(|_| uniform()).sum()
    }

    /// A body whose motion changes at random, followed by poses with noise: true motions, filtered states, and what was expected of each. `turning`
    /// is whether the velocity of its centroid turns with it; a jump of the motion comes before a frame.
    fn followed(
        frames: usize,
        turning: bool,
        change: f64,
        jump_before: Option<usize>,
        seed: u64,
    ) -> (Vec<ParameterVector>, Vec<MotionState>, Vec<Option<ExpectedState>>) {
        const NOISE: f64 = 0.01;
        let mut noise = noise(seed);
        let process = DMatrix::from_fn(6, 6, |i, j| if i == j && i >= 3 { change * change } else { 0.0 });
        let turning_velocity = f64::from(u8::from(turning));
        let move_on = |pose: &Matrix3<f64>, motion: &ParameterVector| match turning {
            true => (RIGID.flow(&motion[..3], STEP).into_inner() * pose, *motion),
            false => straight(RIGID, (pose, motion), &CENTROID, STEP),
        };
        let mut truth = (Matrix3::identity(), [0.7, 0.3, -0.2, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let begin = DMatrix::from_fn(6, 6, |i, j| if i == j { if i < 3 { NOISE * NOISE } else { 1.0 } } else { 0.0 });
        let mut known = state(0.0, (truth.0, [0.5, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]), begin);
        let (mut motions, mut states, mut expectations) = (vec![truth.1], vec![known.clone()], vec![None]);
        for frame in 1..frames {
            truth = move_on(&truth.0, &truth.1);
            (0..3).for_each(|j| truth.1[j] += change * noise() + if jump_before == Some(frame) { 1.0 } else { 0.0 });
            // The motion changes after the step, so that the pose of the frame tells nothing of it.
            let expected = ExpectedState {
                state: state(STEP * frame as f64, move_on(&known.pose, &known.motion), DMatrix::zeros(6, 6)),
                turning_velocity,
            };
            let by = derivative(&known, &expected).expect("finite");
            let covariance = &by * &known.covariance * by.transpose() + &process;
            let expected_state =
                state(expected.state.time, (expected.state.pose, expected.state.motion), covariance.clone());
            let off: Vec<f64> = (0..3).map(|_| NOISE * noise()).collect();
            let seen = RIGID.flow(&off, 1.0).into_inner() * truth.0;
            let innovation = logarithm(&(seen * expected_state.pose.try_inverse().expect("a map"))).expect("near");
            let innovation = DVector::from_column_slice(&RIGID.parameters_of(&innovation)[..3]);
            let of_pose = covariance.view((0, 0), (3, 3)) + NOISE * NOISE * DMatrix::identity(3, 3);
            let gain = covariance.columns(0, 3) * of_pose.try_inverse().expect("positive");
            let correction = &gain * innovation;
            let pose = RIGID.flow(&correction.as_slice()[..3], 1.0).into_inner() * expected_state.pose;
            let mut motion = expected_state.motion;
            (0..3).for_each(|j| motion[j] += correction[3 + j]);
            let after = &covariance - &gain * covariance.rows(0, 3);
            known = state(expected_state.time, (pose, motion), 0.5 * (&after + after.transpose()));
            motions.push(truth.1);
            states.push(known.clone());
            expectations.push(Some(ExpectedState { state: expected_state, ..expected }));
        }
        (motions, states, expectations)
    }

    fn smoothed_by(states: &[MotionState], expected: &[Option<ExpectedState>]) -> Vec<MotionState> {
        let expected: Vec<_> = expected.iter().map(Option::as_ref).collect();
        smooth_changing(states, &expected).expect("a run")
    }

    /// Mean squares of the errors of omega, and of these in their deviations.
    fn squares(states: &[MotionState], motions: &[ParameterVector]) -> [f64; 2] {
        let mut sums = [0.0; 2];
        for (state, motion) in states.iter().zip(motions).skip(3) {
            let error = state.motion[0] - motion[0];
            sums[0] += error * error / (states.len() - 3) as f64;
            sums[1] += error * error / state.covariance[(3, 3)] / (states.len() - 3) as f64;
        }
        sums
    }

    #[test]
    fn a_constant_generator_is_smoothed_as_by_the_smoother_of_constant_motions() {
        let (_, states, expected) = followed(12, true, 0.0, None, 1);
        let by_expectation = smoothed_by(&states, &expected);
        let all_at_once = smooth(&states, &ProcessNoise::default()).expect("a run");
        for (one, other) in by_expectation.iter().zip(&all_at_once).skip(4) {
            let off = difference((&one.pose, &one.motion), other).expect("near");
            let in_deviations = (0..6).map(|i| off[i].abs() / other.covariance[(i, i)].sqrt()).fold(0.0, f64::max);
            assert!(in_deviations < 0.1, "{in_deviations}");
            let variances = |state: &MotionState| state.covariance.diagonal();
            assert!((variances(one).component_div(&variances(other)).add_scalar(-1.0)).amax() < 1e-2);
        }
    }

    #[test]
    fn errors_of_a_motion_that_changes_become_smaller_and_stay_within_their_deviations() {
        for turning in [true, false] {
            let [mut before, mut after, mut standardised] = [0.0; 3];
            for seed in 1..=8 {
                let (motions, states, expected) = followed(50, turning, 0.05, None, seed);
                let smoothed = smoothed_by(&states, &expected);
                let [[error, _], [error_after, in_deviations]] = [&states, &smoothed].map(|of| squares(of, &motions));
                (before, after, standardised) =
                    (before + error, after + error_after, standardised + in_deviations / 8.0);
            }
            assert!(after < 0.7 * before, "{after} {before}");
            // Errors of neighbouring frames are alike: some sixty of 400 are independent, of whose mean square 0.18 is the deviation.
            assert!((0.5..1.6).contains(&standardised), "{standardised}");
        }
    }

    #[test]
    fn nothing_is_handed_back_over_a_sudden_change() {
        let (motions, states, expected) = followed(60, true, 0.002, Some(30), 1);
        let smoothed = smoothed_by(&states, &expected);
        for frame in 10..30 {
            let off = (smoothed[frame].motion[0] - motions[frame][0]).abs();
            assert!(off < 5.0 * smoothed[frame].covariance[(3, 3)].sqrt(), "frame {frame}: {off}");
        }
    }

    #[test]
    fn what_frames_have_in_common_is_not_averaged_out() {
        let (_, states, mut expected) = followed(40, true, 0.05, None, 1);
        // Correlated, and larger than what frames tell.
        let common = DMatrix::from_fn(6, 6, |i, j| {
            let deviations = [i, j].map(|i| 2.0 * states[20].within[(i, i)].sqrt());
            deviations[0] * deviations[1] * if i == j { 1.0 } else { 0.9 }
        });
        let off = |state: &MotionState| MotionState { covariance: &state.covariance + &common, ..state.clone() };
        let states: Vec<MotionState> = states.iter().map(off).collect();
        expected.iter_mut().flatten().for_each(|expected| expected.state = off(&expected.state));
        let smoothed = smoothed_by(&states, &expected);
        for (state, before) in smoothed.iter().zip(&states).take(39) {
            assert!((0..6).all(|i| state.covariance[(i, i)] > common[(i, i)]));
            assert!(
                state.covariance[(3, 3)] < before.covariance[(3, 3)] && state.covariance.clone().cholesky().is_some()
            );
        }
    }

    #[test]
    fn along_what_the_outline_does_not_show_nothing_is_handed_back() {
        let (_, states, mut expected) = followed(30, true, 0.05, None, 1);
        // As of a disc about the origin: nothing is known of the turn, and nothing wrong with it.
        let blind = |covariance: &DMatrix<f64>| {
            DMatrix::from_fn(6, 6, |i, j| if i % 3 == 0 || j % 3 == 0 { 0.0 } else { covariance[(i, j)] })
        };
        let of = |state: &MotionState| MotionState {
            covariance: blind(&state.covariance),
            within: blind(&state.within),
            ..state.clone()
        };
        let states: Vec<MotionState> = states.iter().map(of).collect();
        expected.iter_mut().flatten().for_each(|expected| expected.state = of(&expected.state));
        for (state, before) in smoothed_by(&states, &expected).iter().zip(&states) {
            assert_eq!(state.motion[0], before.motion[0]);
            assert!(state.covariance.iter().all(|entry| entry.is_finite()));
        }
    }

    #[test]
    fn a_motion_a_whole_turn_a_frame_apart_hands_nothing_back() {
        let (_, mut states, expected) = followed(30, true, 0.002, None, 1);
        let before: Vec<f64> = states.iter().take(15).map(|state| state.motion[0]).collect();
        states.iter_mut().skip(15).for_each(|state| state.motion[0] += std::f64::consts::TAU / STEP);
        let smoothed = smoothed_by(&states, &expected);
        for (state, before) in smoothed.iter().zip(before) {
            assert!((state.motion[0] - before).abs() < 0.5, "{} {before}", state.motion[0]);
        }
    }
}
