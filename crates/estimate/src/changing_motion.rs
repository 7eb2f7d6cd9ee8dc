//! Smoothing of a motion that changes from frame to frame.
use freeform_riccati::{MotionModel, ParameterVector, logarithm};
use nalgebra::{DMatrix, DVector, Matrix3, Point2};

use crate::{
    information::scaled_inverse,
    motion_state::MotionState,
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
    /// The part of its covariance that frames do not average out, such as edges that lie off: of pose and motion, 2 k by 2 k.
    pub systematic: DMatrix<f64>,
}

/// Beyond this squared distance from where it was expected, for each parameter of the pose, a state is of another motion: what later frames tell of that
/// says nothing of the one before. By chance a frame in ten thousand of a rigid motion is (chi square, 21 with three degrees of freedom).
const ANOTHER_MOTION: f64 = 7.0;

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
    let expected_of = |t: usize| expected.get(t).and_then(Option::as_ref);
    let mut smoothed = states.to_vec();
    // What is random in the state after.
    let mut random_after = None;
    for t in (0..states.len()).rev() {
        // Of the first state of a run it is told by the one after.
        let systematic = expected_of(t).or(expected_of(t + 1)).map(|expected| &expected.systematic);
        let random =
            systematic.map_or_else(|| Some(states[t].covariance.clone()), |part| without(&states[t].covariance, part));
        let next = smoothed.get(t + 1).zip(expected_of(t + 1)).zip(random_after.take());
        let found = next.zip(random.as_ref()).and_then(|(((next, expected), random_after), random)| {
            let is_expected = is_as_expected(&states[t + 1], &expected.state);
            is_expected.then(|| taken_back((&states[t], random), (next, &random_after), expected)).flatten()
        });
        random_after = match found {
            Some((better, random)) => {
                smoothed[t] = better;
                Some(random)
            }
            None => random,
        };
    }
    Ok(smoothed)
}

/// Whether a state is of the motion that was expected, by its pose: by how much a frame has moved that, in deviations of what a frame moves it by.
fn is_as_expected(found: &MotionState, expected: &MotionState) -> bool {
    let Some(difference) = difference(found, expected) else { return false };
    let k = found.model.parameter_count();
    let of_pose = difference.rows(0, k);
    let squared = |covariance: &DMatrix<f64>| {
        let information = scaled_inverse(&covariance.view((0, 0), (k, k)).into_owned())?;
        Some((of_pose.transpose() * information * of_pose)[(0, 0)])
    };
    // Where rounding leaves their difference indefinite, the sum of both covariances is the most that a frame moves a pose by.
    let told = squared(&(&expected.within - &found.within)).filter(|squared| *squared >= 0.0);
    let distance = told.or_else(|| squared(&(&expected.within + &found.within)));
    distance.is_some_and(|squared| squared <= ANOTHER_MOTION * k as f64)
}

/// By how much a state lies off another: the pose on the group, on the left, then the motion.
fn difference(state: &MotionState, from: &MotionState) -> Option<DVector<f64>> {
    let k = state.model.parameter_count();
    let pose = logarithm(&(state.pose * from.pose.try_inverse()?))?;
    let pose = state.model.parameters_of(&pose);
    Some(DVector::from_fn(2 * k, |i, _| if i < k { pose[i] } else { state.motion[i - k] - from.motion[i - k] }))
}

/// A filtered state corrected by the smoothed one after it; `None` where numbers do not allow it, or less would be known then.
fn taken_back(
    (state, random): (&MotionState, &DMatrix<f64>),
    (next, random_after): (&MotionState, &DMatrix<f64>),
    expected: &ExpectedState,
) -> Option<(MotionState, DMatrix<f64>)> {
    let k = state.model.parameter_count();
    let derivative = derivative(state, expected)?;
    let gain = &state.within * derivative.transpose() * scaled_inverse(&expected.state.within)?;
    let correction = &gain * difference(next, &expected.state)?;
    let step = Step { kept: DMatrix::identity(2 * k, 2 * k) - &gain * &derivative, gain, derivative };
    let expected_random = &expected.state.covariance - &expected.systematic;
    let smoothed = step.covariance(random, &expected_random, random_after)?;
    let within = step.covariance(&state.within, &expected.state.within, &next.within)?;
    let is_better = (0..2 * k).all(|i| smoothed[(i, i)] <= NO_WORSE * random[(i, i)]);
    if !is_better || !correction.iter().all(|entry| entry.is_finite()) {
        return None;
    }
    let mut better = state.clone();
    better.pose = state.model.flow(&correction.as_slice()[..k], 1.0).into_inner() * state.pose;
    (0..k).for_each(|j| better.motion[j] += correction[k + j]);
    better.covariance += &smoothed - random;
    better.within = within;
    // Later frames do not tell where the body frame lies beside the outline, but that what was known of it later holds for all poses.
    let back = adjoint(state.model, &(better.pose * next.pose.try_inverse()?))?;
    better.body_frame = &back * &next.body_frame * back.transpose();
    Some((better, smoothed))
}

/// How a state is made of what was known of it and of the state after it.
struct Step {
    /// I - K F, by which what was known counts.
    kept: DMatrix<f64>,
    /// K.
    gain: DMatrix<f64>,
    /// F.
    derivative: DMatrix<f64>,
}

impl Step {
    /// The random part of the covariance of a smoothed state: from that of the filtered one, of what was expected of the one after it, and of that
    /// smoothed. Positive by its form, whatever rounding does. `None` where a number is not finite.
    fn covariance(&self, before: &DMatrix<f64>, expected: &DMatrix<f64>, next: &DMatrix<f64>) -> Option<DMatrix<f64>> {
        let by = |map: &DMatrix<f64>, covariance: &DMatrix<f64>| map * covariance * map.transpose();
        let added = without(expected, &by(&self.derivative, before))?;
        let sum = by(&self.kept, before) + by(&self.gain, &(next + added));
        sum.iter().all(|entry| entry.is_finite()).then(|| 0.5 * (&sum + sum.transpose()))
    }
}

/// What is left of a covariance when another is subtracted, without negative eigenvalues; these are found in deviations of the former, so that units do
/// not matter. `None` where a number is not finite.
fn without(covariance: &DMatrix<f64>, part: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let size = covariance.nrows();
    let scale: Vec<f64> = covariance.diagonal().iter().map(|variance| variance.max(f64::MIN_POSITIVE).sqrt()).collect();
    let rest = covariance - part;
    let scaled = DMatrix::from_fn(size, size, |i, j| 0.5 * (rest[(i, j)] + rest[(j, i)]) / (scale[i] * scale[j]));
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
    let after =
        |pose: &Matrix3<f64>, motion: &ParameterVector| straight(model, (pose, motion), &state.centroid, seconds);
    let (pose, motion) = after(&state.pose, &state.motion);
    let back = pose.try_inverse()?;
    let mut derivative = DMatrix::zeros(2 * k, 2 * k);
    for j in 0..2 * k {
        let (mut of_pose, mut other) = (ParameterVector::default(), state.motion);
        if j < k {
            of_pose[j] = DIFFERENCE
        } else {
            other[j - k] += DIFFERENCE
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{motion_state::NormalisedState, smoother::smooth};

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

    /// A body whose motion changes at random, followed by poses with noise: true motions, filtered states, and what was expected of each. `turning` is
    /// whether the velocity of its centroid turns with it; a jump of the motion comes before a frame.
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
                systematic: DMatrix::zeros(6, 6),
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
        let by_expectation = smooth_changing(&states, &expected).expect("a run");
        let all_at_once = smooth(&states, &ProcessNoise::default()).expect("a run");
        for (one, other) in by_expectation.iter().zip(&all_at_once).skip(4) {
            let off = difference(one, other).expect("near");
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
                let smoothed = smooth_changing(&states, &expected).expect("a run");
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
        let smoothed = smooth_changing(&states, &expected).expect("a run");
        for frame in 10..30 {
            let off = (smoothed[frame].motion[0] - motions[frame][0]).abs();
            assert!(off < 5.0 * smoothed[frame].covariance[(3, 3)].sqrt(), "frame {frame}: {off}");
        }
    }

    #[test]
    fn what_frames_have_in_common_is_not_averaged_out() {
        let (_, states, mut expected) = followed(40, true, 0.05, None, 1);
        let common = DMatrix::from_fn(6, 6, |i, j| if i == j { 4.0 * states[20].covariance[(i, i)] } else { 0.0 });
        let off = |state: &MotionState| MotionState { covariance: &state.covariance + &common, ..state.clone() };
        let states: Vec<MotionState> = states.iter().map(off).collect();
        for expected in expected.iter_mut().flatten() {
            (expected.state, expected.systematic) = (off(&expected.state), common.clone());
        }
        for state in smooth_changing(&states, &expected).expect("a run") {
            assert!((0..6).all(|i| state.covariance[(i, i)] > common[(i, i)]));
        }
    }

    #[test]
    fn a_centroid_whose_velocity_stays_the_same_goes_straight_while_the_body_turns() {
        let motion = [0.9, 0.4, -0.3, 0.0, 0.0, 0.0, 0.0, 0.0];
        let mut body = (Matrix3::identity(), motion);
        let place = |pose: &Matrix3<f64>| pose.transform_point(&CENTROID);
        let places: Vec<Point2<f64>> = (0..5)
            .map(|_| {
                body = straight(RIGID, (&body.0, &body.1), &CENTROID, STEP);
                place(&body.0)
            })
            .collect();
        let velocity = RIGID.generator(&motion[..3]) * CENTROID.to_homogeneous();
        for (k, at) in (1..).zip(&places) {
            let straight = CENTROID + f64::from(k) * STEP * velocity.xy();
            assert!((at - straight).norm() < 1e-12, "{at} {straight}");
        }
        assert!((body.1[0] - motion[0]).abs() < 1e-15);
    }
}
