use freeform_estimate::{MotionEstimate, ParameterEstimate, PlaneEstimate, PointVelocity};
use freeform_outline_filter::{Ambiguity, DynamicsWeights, PlaneAmbiguity};
use nalgebra::DMatrix;

use super::{family::MotionFamily, settings::Method};
use crate::rejection::FrameRejection;
use crate::{PictureTracing, Warning};

/// The result for an object after all its frames so far.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectResult {
    /// Name of the object.
    pub object: String,
    /// The method of identification.
    pub method: Method,
    /// The family of motions.
    pub motion: MotionFamily,
    /// Number of frames, including rejected ones.
    pub frames: usize,
    /// Frames that were not used.
    pub frames_rejected: usize,
    /// Why the first rejected frame was not used.
    pub first_rejection: Option<FrameRejection>,
    /// The last known motion, in space if a camera scale is given. All numbers are finite. `None` if no motion was found,
    /// and for a plane in space.
    pub estimate: Option<MotionEstimate>,
    /// Covariance of the parameters of `estimate`, k by k in their order, as if those that are not stated were known. `None` where the
    /// method gives none, and for a plane in space.
    pub covariance: Option<DMatrix<f64>>,
    /// The last known motion of a plane in space.
    pub plane: Option<Box<PlaneEstimate>>,
    /// Velocity of the middle of the object in the last frame, in space if a camera scale is given (motion filter). It may be known while
    /// the angular velocity is not observable, as for a circle.
    pub velocity: Option<PointVelocity>,
    /// Whether the outlines do not show how the middle moves, as those of a bar whose ends are out of the picture (motion filter). Where they do, a
    /// velocity that is not stated is not known well enough, or [ambiguous](Self::ambiguity).
    pub hides_velocity: bool,
    /// Turns between which the outlines do not decide (motion filter).
    pub ambiguity: Option<Ambiguity>,
    /// Two motions of a plane in space that the outlines do not decide between.
    pub plane_ambiguity: Option<Box<PlaneAmbiguity>>,
    /// Other angular velocities, rad/s, that explain the outlines as well, because the outline has a symmetry (motion filter); of
    /// affine and projective motion mean ones, (a2 - a3) / 2.
    pub aliases: Vec<f64>,
    /// Probabilities of the hypotheses of dynamics (motion filter, from the third frame on).
    pub dynamics: Option<DynamicsWeights>,
    /// Warnings on the result, causes before consequences.
    pub warnings: Vec<Warning>,
}

impl ObjectResult {
    /// The result for an object of which nothing is known, with no frames. What is known of another object takes the place of its fields.
    ///
    /// ```
    /// use freeform_motion::{riccati::MotionModel, tracker::{Method, ObjectResult}};
    ///
    /// let unknown = ObjectResult::unknown("left", Method::Filter, MotionModel::Rigid);
    /// let lost = ObjectResult { frames: 30, frames_rejected: 30, ..unknown };
    /// assert!(lost.parameters().is_none() && lost.warnings.is_empty());
    /// ```
    #[must_use]
    pub fn unknown(object: impl Into<String>, method: Method, motion: impl Into<MotionFamily>) -> Self {
        Self {
            object: object.into(),
            method,
            motion: motion.into(),
            frames: 0,
            frames_rejected: 0,
            first_rejection: None,
            estimate: None,
            covariance: None,
            plane: None,
            velocity: None,
            hides_velocity: false,
            ambiguity: None,
            plane_ambiguity: None,
            aliases: Vec::new(),
            dynamics: None,
            warnings: Vec::new(),
        }
    }

    /// Whether the method gives a velocity of the middle, where it is known: the motion filter does, but not of a plane in space.
    #[must_use]
    pub fn has_velocity(&self) -> bool {
        self.motion.has_velocity(self.method)
    }

    /// The parameters of the motion, whichever family it is of; none where no motion was found.
    #[must_use]
    pub fn parameters(&self) -> Option<Vec<ParameterEstimate>> {
        parameters_of(self.estimate.as_ref(), self.plane.as_deref())
    }

    /// The same result where it is in doubt what the outlines show: of a motion that is stated of two frames alone a warning says so.
    ///
    /// Two outlines of whatever things have a motion from one to the other; that a third lies where it leads is what speaks for it. The accepted
    /// frames are counted from the first one on, also those before the object was given up and the filter started again: of that
    /// [`Warning::Restarted`] tells. The warning is given once, however often this is called. Where a frame was rejected besides the two it is
    /// given without this.
    #[must_use]
    pub fn of_doubtful_outlines(self) -> Self {
        self.warned_of_two_frames()
    }

    /// The same result, of outlines that were found so in pictures: its warnings advise what has not been chosen yet.
    #[must_use]
    pub fn traced_by(mut self, tracing: PictureTracing) -> Self {
        for warning in &mut self.warnings {
            match warning {
                Warning::NotObservable { contours, .. } => *contours = tracing.contours,
                Warning::WrongFamily { ground, .. } => *ground = tracing.ground,
                _ => {}
            }
        }
        self
    }

    /// The same result with the warning that two frames alone tell the motion, where another one was rejected: it does not lie where they lead.
    pub(super) fn with_others_rejected(self) -> Self {
        if self.frames_rejected > 0 { self.warned_of_two_frames() } else { self }
    }

    fn warned_of_two_frames(mut self) -> Self {
        let is_of_two = self.frames.saturating_sub(self.frames_rejected) <= 2;
        let count = self.motion.parameter_names().len();
        let is_stated = self.unstated().len() < count || self.velocity.is_some();
        if is_stated && is_of_two && !self.warnings.contains(&Warning::OfTwoFrames) {
            self.warnings.push(Warning::OfTwoFrames);
            self.warnings.sort_by_key(Warning::order);
        }
        self
    }
}

/// Names of the components of the velocity of the middle of an object.
pub const VELOCITY_NAMES: [&str; 2] = ["v1", "v2"];

/// The parameters of whichever is known.
pub(super) fn parameters_of(
    estimate: Option<&MotionEstimate>,
    plane: Option<&PlaneEstimate>,
) -> Option<Vec<ParameterEstimate>> {
    let of_picture = estimate.map(|estimate| estimate.parameters().collect());
    of_picture.or_else(|| plane.map(|plane| plane.parameters().collect()))
}

#[cfg(test)]
mod tests {
    use freeform_riccati::MotionModel;
    use nalgebra::{Matrix2, Point2, Vector2};

    use super::*;

    /// Warnings of an object of so many accepted frames beside three rejected ones, where it is in doubt what its outlines show.
    fn warnings_of(accepted: usize, is_stated: bool) -> Vec<Warning> {
        let unknown = ObjectResult::unknown("left", Method::Filter, MotionModel::Rigid);
        let (point, velocity, covariance) = (Point2::origin(), Vector2::x(), Matrix2::identity());
        let velocity = is_stated.then_some(PointVelocity { point, velocity, covariance });
        let warnings = vec![Warning::Lost { last_known: None }, Warning::Restarted { times: 1 }];
        ObjectResult { frames: accepted + 3, frames_rejected: 3, velocity, warnings, ..unknown }
            .of_doubtful_outlines()
            .of_doubtful_outlines()
            .warnings
    }

    #[test]
    fn what_is_stated_of_two_frames_beside_a_rejected_one_is_warned_of_though_nothing_is_in_doubt() {
        let unknown = ObjectResult::unknown("left", Method::Filter, MotionModel::Rigid);
        let (point, velocity, covariance) = (Point2::origin(), Vector2::x(), Matrix2::identity());
        let stated = ObjectResult { velocity: Some(PointVelocity { point, velocity, covariance }), ..unknown };
        let warnings_of = |frames, frames_rejected| {
            ObjectResult { frames, frames_rejected, ..stated.clone() }.with_others_rejected().warnings
        };
        assert_eq!(warnings_of(3, 1), [Warning::OfTwoFrames]);
        assert_eq!(warnings_of(4, 1), []);
        assert_eq!(warnings_of(2, 0), []);
    }

    #[test]
    fn what_is_stated_of_two_frames_alone_is_warned_of_once_and_of_three_not() {
        let (lost, restarted) = (Warning::Lost { last_known: None }, Warning::Restarted { times: 1 });
        assert_eq!(warnings_of(2, true), [lost.clone(), Warning::OfTwoFrames, restarted.clone()]);
        assert_eq!(warnings_of(3, true), [lost.clone(), restarted.clone()]);
        assert_eq!(warnings_of(2, false), [lost, restarted]);
    }
}
