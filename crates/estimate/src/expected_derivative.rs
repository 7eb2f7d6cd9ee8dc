//! The derivative of what is expected of an object by what is known of it.
use freeform_riccati::{MotionModel, ParameterVector, logarithm};
use nalgebra::{DMatrix, Matrix3, Point2};

use crate::{changing_motion::ExpectedState, motion_state::MotionState, process_noise::ProcessNoise};

/// Displacement, normalised, and rates by which derivatives are taken as differences: errors of a second order are some 1e-5, those of rounding less.
const DIFFERENCE: f64 = 1e-5;

/// The derivative of what is expected of a state at a later time by the state.
pub(crate) fn derivative(state: &MotionState, expected: &ExpectedState) -> Option<DMatrix<f64>> {
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
            of_pose[j] = DIFFERENCE;
        } else {
            other[j - k] += DIFFERENCE;
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
pub(crate) fn straight(
    model: MotionModel,
    (pose, motion): (&Matrix3<f64>, &ParameterVector),
    centroid: &Point2<f64>,
    seconds: f64,
) -> (Matrix3<f64>, ParameterVector) {
    let k = model.parameter_count();
    let generator = model.generator(&motion[..k]);
    let linear = |m: &Matrix3<f64>| m.fixed_view::<2, 2>(0, 0).into_owned();
    let here = (pose * centroid.to_homogeneous()).xy();
    let velocity = (generator * here.push(1.0)).xy();
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

    const RIGID: MotionModel = MotionModel::Rigid;
    const STEP: f64 = 0.1;
    const CENTROID: Point2<f64> = Point2::new(0.2, -0.1);

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
