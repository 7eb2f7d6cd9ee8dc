//! The hypotheses in the size of the model.
use freeform_riccati::{MAX_PARAMETERS, MotionModel};
use nalgebra::{Matrix3, Point2, SVector};

use super::{
    centred::{CentredDeviations, CentredPose, Summary},
    combination::Purpose,
    interacting::InteractingHypotheses,
    setting::{Dynamics, DynamicsWeights},
};
use crate::{belief::StateMatrix, map::NullDirection, prediction::PoseMatrix, update::PoseMeasurement};

/// Hypotheses of how the motion goes on, of any model. Matrices have the size that a model needs: most of the work on
/// larger ones would be on zeros.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum DynamicsFilter {
    Rigid(InteractingHypotheses<9>),
    Similarity(InteractingHypotheses<12>),
    Affine(InteractingHypotheses<18>),
    Projective(InteractingHypotheses<24>),
}

/// Calls a method of the hypotheses, whatever their size.
macro_rules! of_any_size {
    ($filter:expr, $hypotheses:ident => $value:expr) => {
        match $filter {
            DynamicsFilter::Rigid($hypotheses) => $value,
            DynamicsFilter::Similarity($hypotheses) => $value,
            DynamicsFilter::Affine($hypotheses) => $value,
            DynamicsFilter::Projective($hypotheses) => $value,
        }
    };
}

impl DynamicsFilter {
    /// Begins with what is believed of an object after a step of so many seconds, and the covariance of that if the outline is known. `None`
    /// for numbers that do not allow it.
    /// The place is the object's centroid in the body frame, with the null directions of its pose.
    pub(crate) fn begin(
        model: MotionModel,
        setting: Dynamics,
        summary: (&Summary, &StateMatrix),
        place: (Point2<f64>, &[NullDirection]),
        seconds: f64,
    ) -> Option<Self> {
        match model {
            MotionModel::Rigid => {
                InteractingHypotheses::begin(model, setting, summary, place, seconds).map(Self::Rigid)
            }
            MotionModel::Similarity => {
                InteractingHypotheses::begin(model, setting, summary, place, seconds).map(Self::Similarity)
            }
            MotionModel::Affine => {
                InteractingHypotheses::begin(model, setting, summary, place, seconds).map(Self::Affine)
            }
            MotionModel::Projective => {
                InteractingHypotheses::begin(model, setting, summary, place, seconds).map(Self::Projective)
            }
        }
    }

    /// Moves all hypotheses on by a step, after mixing their states; `pose` is where the object is predicted otherwise.
    /// Whether the numbers allow it.
    pub(crate) fn predict(&mut self, pose: &CentredPose, seconds: f64, null: &[NullDirection]) -> bool {
        of_any_size!(self, hypotheses => hypotheses.predict(pose, seconds, null))
    }

    /// Updates by what an accepted frame tells of the pose: the error of the reference pose. `off` are standard deviations of that pose about the
    /// centroid which come to those of the frame, such as for rounding.
    pub(crate) fn update(&mut self, measured: &PoseMeasurement, off: &CentredDeviations) {
        of_any_size!(self, hypotheses => hypotheses.update(measured, off));
    }

    /// Whether all states are finite: of those that are not nothing goes on.
    pub(crate) fn is_finite(&self) -> bool {
        of_any_size!(self, hypotheses => hypotheses.is_finite())
    }

    /// Records that the motion has changed in a way that no hypothesis models.
    pub(crate) fn record_change(&mut self) {
        of_any_size!(self, hypotheses => hypotheses.record_change());
    }

    /// Adds a displacement of the whole outline in the body frame, which later poses are measured against.
    pub(crate) fn add_shift(&mut self, shift: &SVector<f64, MAX_PARAMETERS>) {
        of_any_size!(self, hypotheses => hypotheses.add_shift(shift));
    }

    /// Takes what poses have in common to be no less than what the outline adds to them now: by the covariance of what is believed, and of that if
    /// the outline is known.
    pub(crate) fn renew_common_error(&mut self, summary: &Summary, given_outline: &StateMatrix) {
        of_any_size!(self, hypotheses => hypotheses.renew_common_error(summary, given_outline));
    }

    /// Covariance of the error of the body frame that all poses have in common, as the outline is now.
    pub(crate) fn common_error(&self) -> Option<PoseMatrix> {
        of_any_size!(self, hypotheses => hypotheses.common_error())
    }

    /// The covariance of where the body frame lies beside the outline as it is known now, as an error that all poses have in common.
    pub(crate) fn error_beyond_outline(&self) -> Option<PoseMatrix> {
        of_any_size!(self, hypotheses => hypotheses.error_beyond_outline())
    }

    /// The centroid, in the body frame that poses are counted from.
    pub(crate) fn centroid(&self) -> Point2<f64> {
        of_any_size!(self, hypotheses => hypotheses.centroid())
    }

    /// The pose in which the outline as it is now lies where a pose of these hypotheses has it.
    pub(crate) fn of_outline_now(&self, pose: &Matrix3<f64>) -> Matrix3<f64> {
        of_any_size!(self, hypotheses => hypotheses.of_outline_now(pose))
    }

    /// Takes nothing to be known along directions that were not shown so far, after a step of so many seconds.
    pub(crate) fn forget(&mut self, directions: &[NullDirection], seconds: f64) {
        of_any_size!(self, hypotheses => hypotheses.forget(directions, seconds));
    }

    /// Steps that the motion is known from, without a limit if it is constant.
    pub(crate) fn memory(&self) -> f64 {
        of_any_size!(self, hypotheses => hypotheses.memory())
    }

    /// Ends a step, also one whose frame has told nothing of the pose.
    pub(crate) fn end_step(&mut self) {
        of_any_size!(self, hypotheses => hypotheses.end_step());
    }

    /// Probabilities of the three kinds of dynamics.
    pub(crate) fn weights(&self) -> DynamicsWeights {
        of_any_size!(self, hypotheses => hypotheses.weights())
    }

    /// Whether the hypotheses, and not a constant generator alone, say where the object is expected next.
    pub(crate) fn leads(&self) -> bool {
        of_any_size!(self, hypotheses => hypotheses.leads())
    }

    /// Whether a turn that the outline does not show is told by the path of the centroid.
    pub(crate) fn turn_is_of_path(&self) -> bool {
        of_any_size!(self, hypotheses => hypotheses.turn_is_of_path())
    }

    /// Whether hypotheses other than a constant generator are not ruled out, and do not lead already.
    pub(crate) fn has_others(&self) -> bool {
        of_any_size!(self, hypotheses => hypotheses.has_others())
    }

    /// Factors, at least 1, by which the innovations say that deviations about the centroid are to be widened.
    pub(crate) fn factors(&self) -> CentredDeviations {
        of_any_size!(self, hypotheses => hypotheses.factors())
    }

    /// Mean square of the innovations, at least 1: how much larger than the model's errors are.
    pub(crate) fn widening(&self) -> f64 {
        of_any_size!(self, hypotheses => hypotheses.widening())
    }

    /// Whether the frames are explained best by a motion or a camera that changes at random.
    pub(crate) fn changes_at_random(&self) -> bool {
        of_any_size!(self, hypotheses => hypotheses.changes_at_random())
    }

    /// The states of all hypotheses taken together, that of a constant generator replaced by what is `given` for it, which knows the
    /// outline as well.
    pub(crate) fn combined(&self, given: Option<&Summary>, purpose: Purpose) -> Option<Summary> {
        of_any_size!(self, hypotheses => hypotheses.combined(given, purpose))
    }

    /// Sets another reference pose, near the one before.
    pub(crate) fn set_reference(&mut self, pose: &Matrix3<f64>) -> bool {
        of_any_size!(self, hypotheses => hypotheses.set_reference(pose))
    }

    /// Whether the hypotheses are those of a model and a setting, and all their numbers can be worked with.
    #[cfg(feature = "serde")]
    pub(crate) fn is_valid(&self, model: MotionModel, setting: Option<Dynamics>) -> bool {
        of_any_size!(self, hypotheses => hypotheses.is_valid(model, setting))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Hypotheses after a step of a thirtieth of a second, of a pose whose place is known to a deviation, and of a motion of which a step is.
    fn begun(place: f64, step: f64) -> Option<DynamicsFilter> {
        const SECONDS: f64 = 1.0 / 30.0;
        let covariance = |place: f64| {
            let velocity = step / SECONDS;
            let deviations = [0.01, place, place, 0.1, velocity, velocity];
            StateMatrix::from_fn(|i, j| if i == j && i < deviations.len() { deviations[i].powi(2) } else { 0.0 })
        };
        let summary = Summary { pose: Matrix3::identity(), motion: Default::default(), covariance: covariance(place) };
        // The outline is what the place is not known by.
        let given_outline = covariance(0.001);
        let place = (Point2::origin(), [].as_slice());
        DynamicsFilter::begin(MotionModel::Rigid, Dynamics::Auto, (&summary, &given_outline), place, SECONDS)
    }

    #[test]
    fn hypotheses_begin_once_a_step_is_known_wherever_the_object_has_gone_since_the_first_frame() {
        for place in [0.01, 3.0] {
            assert!(begun(place, 0.1).is_some(), "{place}");
            assert!(begun(place, 2.0).is_none(), "{place}");
        }
    }
}
