//! Hypotheses that follow poses measured with white noise, of a body that travels and turns, and has once been put aside at once.
use freeform_riccati::{MAX_PARAMETERS, MotionModel};
use nalgebra::{Matrix3, Point2, Rotation2, SMatrix, SVector, Vector2};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

use super::{CentredPose, Dynamics, DynamicsFilter, Purpose, Summary};
use crate::{belief::StateMatrix, dynamics::centred::of_both, update::PoseMeasurement};

const MODEL: MotionModel = MotionModel::Rigid;
const PARAMETERS: usize = 3;
const SECONDS: f64 = 0.05;
/// Of a pose, in rad and in RMS radii.
const NOISE: f64 = 0.003;
/// The frame that shows it aside first, and is not taken.
const JUMP_AT: usize = 15;
const SPIN: f64 = 0.5;
const VELOCITY: Vector2<f64> = Vector2::new(1.2, 0.0);
const JUMP: Vector2<f64> = Vector2::new(0.6, 0.0);

type PoseError = SVector<f64, MAX_PARAMETERS>;

fn pose(frame: usize, jump: Vector2<f64>) -> Matrix3<f64> {
    let time = frame as f64 * SECONDS;
    let place = VELOCITY * time + if frame >= JUMP_AT { jump } else { Vector2::zeros() };
    Rotation2::new(SPIN * time).to_homogeneous().append_translation(&place)
}

fn centred(pose: Matrix3<f64>) -> CentredPose {
    CentredPose { pose, centroid: Point2::origin() }
}

fn noise(random: &mut ChaCha8Rng) -> PoseError {
    PoseError::from_fn(|i, _| if i < PARAMETERS { NOISE * random.sample::<f64, _>(StandardNormal) } else { 0.0 })
}

/// Begun by two frames, of which the noise of the second makes the motion wrong.
fn begun(random: &mut ChaCha8Rng) -> Option<DynamicsFilter> {
    let mut second = pose(1, JUMP);
    let off = noise(random);
    second = second.append_translation(&Vector2::new(off[1], off[2]));
    let motion = MODEL.motion_between(&(second * pose(0, JUMP).try_inverse()?), SECONDS)?;
    let variance = NOISE * NOISE;
    let covariance = |of_outline: f64| {
        let about_centroid = StateMatrix::from_fn(|i, j| match (i / PARAMETERS, j / PARAMETERS) {
            _ if i % PARAMETERS != j % PARAMETERS => 0.0,
            (0, 0) => variance + of_outline,
            (1, 1) => variance / (SECONDS * SECONDS),
            (0, 1) | (1, 0) => variance / SECONDS,
            _ => 0.0,
        });
        let to = of_both(&centred(second).about_origin(MODEL)?, PARAMETERS);
        Some(to * about_centroid * to.transpose())
    };
    let summary = Summary { pose: second, motion, covariance: covariance(variance)? };
    let mut filter =
        DynamicsFilter::begin(MODEL, Dynamics::Auto, (&summary, &covariance(0.0)?), (Point2::origin(), &[]), SECONDS)?;
    filter.end_step();
    Some(filter)
}

/// Follows one frame; the errors of the velocity of the centroid in their deviations.
fn follow(filter: &mut DynamicsFilter, frame: usize, random: &mut ChaCha8Rng) -> Option<Vector2<f64>> {
    let truth = pose(frame, JUMP);
    let expected = if frame == JUMP_AT { pose(frame, Vector2::zeros()) } else { truth };
    assert!(filter.predict(&centred(expected), SECONDS, &[]));
    if frame == JUMP_AT {
        filter.end_step();
        return None;
    }
    let reference = match filter.combined(None, Purpose::Prediction) {
        Some(summary) if filter.leads() && frame != JUMP_AT + 1 => summary.pose,
        _ => truth,
    };
    assert!(filter.set_reference(&reference));
    let about_centroid = centred(reference).about_centroid(MODEL);
    let off = PoseError::from(MODEL.motion_between(&(truth * reference.try_inverse()?), 1.0)?);
    let seen = about_centroid * off + noise(random);
    let by_centroid = SMatrix::from_fn(|i, j| if i == j && i < PARAMETERS { 1.0 / (NOISE * NOISE) } else { 0.0 });
    let measured = PoseMeasurement {
        information: about_centroid.transpose() * by_centroid * about_centroid,
        pulled: about_centroid.transpose() * (by_centroid * seen),
    };
    filter.update(&measured, &SVector::zeros());
    let stated = filter.combined(None, Purpose::Statement)?;
    filter.end_step();
    let change = centred(truth).about_centroid(MODEL);
    let velocity = change * PoseError::from(stated.motion);
    let both = of_both(&change, PARAMETERS);
    let covariance = both * stated.covariance * both.transpose();
    Some(Vector2::from_fn(|i, _| {
        let deviation = covariance[(PARAMETERS + 1 + i, PARAMETERS + 1 + i)].sqrt();
        (velocity[1 + i] - VELOCITY[i]) / deviation
    }))
}

#[test]
fn the_velocity_of_a_body_that_has_been_put_aside_at_once_is_within_its_deviations_in_the_frames_after() {
    const FRAMES: usize = 30;
    const RUNS: u64 = 40;
    let mut squares = [0.0; FRAMES];
    for seed in 0..RUNS {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut filter = begun(&mut random).expect("a step is known");
        for (frame, sum) in (2..).zip(&mut squares[2..]) {
            if let Some(errors) = follow(&mut filter, frame, &mut random) {
                *sum += errors.norm_squared();
            }
        }
    }
    // Of 80 squares that are right, the mean is above 1.5 once in two thousand times.
    for (frame, sum) in squares.iter().enumerate().skip(JUMP_AT + 4) {
        let mean = sum / (2 * RUNS) as f64;
        assert!(mean < 1.5, "frame {frame}: {mean}");
    }
}
