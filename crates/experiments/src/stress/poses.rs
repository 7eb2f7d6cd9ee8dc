//! Whether the poses of a whole run are right.
use std::f64::consts::TAU;

use freeform_estimate::MotionState;
use freeform_motion::tracker::{Trajectory, TrajectoryRow};
use nalgebra::{Isometry2, Point2, Rotation2};

use super::rigid_poses::RigidPoses;

/// Error in standard deviations beyond which a pose is wrong. A run has hundreds of numbers: four would be too few for the largest of them.
pub(super) const WRONG: f64 = 5.0;

/// Errors of the poses of one run in standard deviations.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct PoseErrors {
    /// One for each angle that is stated.
    pub(super) turns: Vec<f64>,
    /// Two for each place that is stated.
    pub(super) places: Vec<f64>,
    /// Frames that were used, after the first.
    pub(super) frames: usize,
}

/// The turn of a frame that others are related to.
#[derive(Debug, Clone, Copy)]
struct Reference {
    segment: usize,
    error: f64,
    deviation: f64,
}

impl PoseErrors {
    /// Judges the rows of the one object of a trajectory. A turn by the angle of a symmetry of the body is none that an outline shows.
    pub(super) fn of(trajectory: &Trajectory, truth: &RigidPoses) -> Self {
        let mut used = trajectory.rows().iter().filter(|row| row.accepted);
        let Some(first) = used.next().and_then(|row| row.time) else { return Self::default() };
        let mut errors = Self::default();
        let mut reference = None;
        for row in used {
            errors.frames += 1;
            if let (Some(state), Some(time)) = (row.state(), row.time) {
                errors.add(row, state, &truth.moved(first, time), truth.middle(first), truth.folds, &mut reference);
            }
        }
        errors
    }

    /// Whether a pose that is stated is wrong.
    pub(super) fn are_off(&self) -> bool {
        self.turns.iter().chain(&self.places).any(|error| error.is_nan() || error.abs() > WRONG)
    }

    fn add(
        &mut self,
        row: &TrajectoryRow,
        state: &MotionState,
        truth: &Isometry2<f64>,
        middle: Point2<f64>,
        folds: usize,
        reference: &mut Option<Reference>,
    ) {
        let [angle, x, y] = state.pose_parameters()[..] else { return };
        // Angles of poses are clockwise, as omega is.
        let difference = angle.value + truth.rotation.angle();
        let step = TAU / folds as f64;
        let turns = if difference.is_finite() { (difference / step).round() } else { 0.0 };
        let error = difference - turns * step;
        if row.segment > 0 {
            // Nobody knows how far the object has turned since the first segment: turns are judged from the first of their own.
            match reference.filter(|of| of.segment == row.segment) {
                Some(of) if difference.is_finite() => {
                    let apart = error - of.error;
                    let apart = apart - step * (apart / step).round();
                    self.turns.push(apart / of.deviation.hypot(angle.standard_deviation));
                }
                None if difference.is_finite() => {
                    let deviation = angle.standard_deviation;
                    *reference = Some(Reference { segment: row.segment, error, deviation });
                }
                _ => {}
            }
            return;
        }
        if difference.is_finite() {
            self.turns.push(error / angle.standard_deviation);
        }
        // The point of the body that a place is of; a turn by the symmetry turns it about the middle.
        let here = Point2::new(x.value, y.value);
        let of_body = state.pose().inverse_transform_point(&here);
        let symmetric = Rotation2::new(-turns * step);
        let there = truth * (middle + symmetric * (of_body - middle));
        let off = here - there;
        if off.iter().all(|error| error.is_finite()) {
            self.places.extend([off.x / x.standard_deviation, off.y / y.standard_deviation]);
        }
    }
}
