//! A track moved to where a frame shows its object, away from where it was expected.
use freeform_riccati::{MAX_PARAMETERS, logarithm, map_point};
use nalgebra::{Matrix3, SVector};

use super::Track;
use crate::{belief::Belief, prediction::TimeOfChange};

impl Track {
    /// Whether the motion is known from no more than one step: from two frames, or since it has changed. Nothing says then that it is steady.
    pub(crate) fn is_known_from_one_step(&self) -> bool {
        let Belief { memory, information, .. } = &self.belief;
        memory.shortest(information.k) <= memory.step
    }

    /// Whether one step has been measured since the object was found where nothing said how it had moved.
    pub(crate) fn is_found_one_step_ago(&self) -> bool {
        self.belief.memory.is_of_one_step()
    }

    /// Moves the predicted pose by what it was found to be off by, which the motion has made of it in so many seconds, up to now; by as much as the
    /// outline is displaced then, the motion may be another. False, and nothing changes, where the outline [is not shown](Track::is_shown) there.
    #[must_use]
    pub(crate) fn displace(&mut self, displacement: &SVector<f64, MAX_PARAMETERS>, seconds: f64) -> bool {
        let (step, before) = (self.belief.memory.step, self.belief.pose);
        let pose = self.pose_off_by(displacement, &before);
        if seconds <= 0.0 || step <= 0.0 || !self.map.is_shown_in(&pose) {
            return false;
        }
        self.belief.pose = pose;
        let mean_square = self.displacement_from(&before).powi(2);
        self.belief.motion.iter_mut().zip(displacement).for_each(|(rate, by)| *rate += by / seconds);
        self.add_change([mean_square / (seconds * seconds * step); 2], TimeOfChange::Any);
        true
    }

    /// The pose that is right if another one has an error, on the left.
    pub(crate) fn pose_off_by(&self, error: &SVector<f64, MAX_PARAMETERS>, pose: &Matrix3<f64>) -> Matrix3<f64> {
        self.model().flow(&error.as_slice()[..self.belief.parameter_count()], 1.0).into_inner() * pose
    }

    /// The error of the pose, on the left, if another one is right; none along what the outline does not show.
    pub(crate) fn error_to(&self, pose: &Matrix3<f64>) -> Option<SVector<f64, MAX_PARAMETERS>> {
        let change = logarithm(&(pose * self.body_pose().try_inverse()?))?;
        let mut error = self.model().parameters_of(&change);
        self.null_directions().subtract_from(&mut error);
        Some(SVector::from(error))
    }

    /// A normalised length in image lengths.
    pub(crate) fn in_image_lengths(&self, normalised: f64) -> f64 {
        normalised * self.reference.radius
    }

    /// How far the outline lies from where another pose has it, root mean square, normalised.
    pub(crate) fn displacement_from(&self, other: &Matrix3<f64>) -> f64 {
        let pose = &self.belief.pose;
        let apart = |centre| (map_point(pose, centre) - map_point(other, centre)).norm_squared();
        let cells = self.map.cells();
        (cells.iter().map(|cell| apart(&cell.centre)).sum::<f64>() / cells.len() as f64).sqrt()
    }
}
