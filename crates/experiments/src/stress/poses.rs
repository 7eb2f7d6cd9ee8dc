//! Whether the poses of a whole run are right.
use std::f64::consts::TAU;

use freeform_estimate::MotionState;
use freeform_motion::tracker::Trajectory;
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
                errors.add(
                    row.segment,
                    state,
                    (&truth.moved(first, time), truth.middle(first), truth.folds),
                    &mut reference,
                );
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
        segment: usize,
        state: &MotionState,
        (truth, middle, folds): (&Isometry2<f64>, Point2<f64>, usize),
        reference: &mut Option<Reference>,
    ) {
        let [angle, x, y] = state.pose_parameters()[..] else { return };
        // Angles of poses are clockwise, as omega is.
        let difference = angle.value + truth.rotation.angle();
        let step = TAU / folds as f64;
        let but_for_symmetry = |turn: f64| turn - step * (turn / step).round();
        let error = but_for_symmetry(difference);
        if segment > 0 {
            // Nobody knows how far the object has turned since the first segment: turns are judged from the first of their own.
            match reference.filter(|of| of.segment == segment) {
                _ if !error.is_finite() => {}
                Some(of) => {
                    let deviation = of.deviation.hypot(angle.standard_deviation);
                    self.turns.push(but_for_symmetry(error - of.error) / deviation);
                }
                None => *reference = Some(Reference { segment, error, deviation: angle.standard_deviation }),
            }
            return;
        }
        if error.is_finite() {
            self.turns.push(error / angle.standard_deviation);
        }
        // The point of the body that a place is of; a turn by the symmetry turns it about the middle.
        let here = Point2::new(x.value, y.value);
        let of_body = state.pose().inverse_transform_point(&here);
        let symmetric = if error.is_finite() { Rotation2::new(error - difference) } else { Rotation2::identity() };
        let there = truth * (middle + symmetric * (of_body - middle));
        let off = here - there;
        if off.iter().all(|error| error.is_finite()) {
            self.places.extend([off.x / x.standard_deviation, off.y / y.standard_deviation]);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use freeform_estimate::NormalisedState;
    use freeform_riccati::{MAX_PARAMETERS, MotionModel};
    use nalgebra::{DMatrix, Matrix3, Vector2};

    use super::*;

    /// A state whose place is that of the point (1, 2), in units of the radius 1, with deviations of 0.01.
    fn state(pose: Matrix3<f64>) -> MotionState {
        let covariance = DMatrix::identity(6, 6) * 1e-4;
        NormalisedState {
            model: MotionModel::Rigid,
            time: 0.0,
            origin: Point2::new(1.0, 2.0),
            radius: 1.0,
            pose,
            motion: [0.0; MAX_PARAMETERS],
            covariance: covariance.clone(),
            body_frame: DMatrix::zeros(3, 3),
            covariance_given_outline: covariance,
            observable: [true; MAX_PARAMETERS],
            hidden: [false; MAX_PARAMETERS],
            centroid: Point2::origin(),
        }
        .into()
    }

    fn added(
        segment: usize,
        pose: Matrix3<f64>,
        truth: Isometry2<f64>,
        reference: &mut Option<Reference>,
    ) -> PoseErrors {
        let mut errors = PoseErrors::default();
        // In the image, the middle is (0.5, 0) aside of the place that is stated.
        errors.add(segment, &state(pose), (&truth, Point2::new(1.5, 2.0), 4), reference);
        errors
    }

    #[test]
    fn a_turn_by_the_symmetry_about_the_middle_is_no_error_and_half_of_it_is_one() {
        let about_middle = |angle: f64| {
            let middle = Vector2::new(0.5, 0.0);
            let turn = Isometry2::new(Vector2::zeros(), angle);
            let shift = middle - turn * middle;
            Isometry2::new(shift, angle).to_homogeneous()
        };
        for turns in -3..=3 {
            let errors = added(0, about_middle(f64::from(turns) * FRAC_PI_2), Isometry2::identity(), &mut None);
            assert!(errors.turns.iter().chain(&errors.places).all(|error| error.abs() < 1e-9), "{turns}: {errors:?}");
        }
        assert!(added(0, about_middle(0.5 * FRAC_PI_2), Isometry2::identity(), &mut None).are_off());
        let elsewhere = Isometry2::new(Vector2::zeros(), FRAC_PI_2).to_homogeneous();
        assert!(added(0, elsewhere, Isometry2::identity(), &mut None).are_off(), "about another point than the middle");
    }

    #[test]
    fn in_a_later_segment_turns_are_counted_from_its_first_frame_and_places_are_not_judged() {
        let turned = |angle: f64| Isometry2::new(Vector2::zeros(), angle);
        let mut reference = None;
        let first = added(1, turned(0.3).to_homogeneous(), turned(0.1), &mut reference);
        assert_eq!((first.turns.len(), first.places.len()), (0, 0));
        let right = added(1, turned(0.5).to_homogeneous(), turned(0.3), &mut reference);
        assert!(right.turns[0].abs() < 1e-9 && right.places.is_empty());
        assert!(added(1, turned(0.7).to_homogeneous(), turned(0.3), &mut reference).are_off());
        assert_eq!(added(2, turned(0.7).to_homogeneous(), turned(0.3), &mut reference).turns.len(), 0);
    }
}
