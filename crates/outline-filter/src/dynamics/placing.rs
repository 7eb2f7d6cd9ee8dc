//! Where hypotheses have the body frame and the centroid, while the outline is learnt on.
use freeform_riccati::MAX_PARAMETERS;
use nalgebra::{Matrix3, Point2, SVector};

use super::{
    centred::{CentredPose, Summary},
    common_error::CommonError,
    interacting::InteractingHypotheses,
};
use crate::{belief::StateMatrix, prediction::PoseMatrix};

impl<const N: usize> InteractingHypotheses<N> {
    /// Takes what poses have in common to be no less than what the outline adds to them now. Where parts of it come into view, while others are
    /// hidden, they are learnt in poses that are measured against those before.
    pub(crate) fn renew_common_error(&mut self, summary: &Summary, given_outline: &StateMatrix) {
        let reference = CentredPose { pose: summary.pose, centroid: self.reference.centroid };
        let [(_, covariance), (_, measured)] = Self::about_centroid(self.model, (summary, given_outline), &reference);
        self.common.renew(&CommonError::of_outline(self.model, &covariance, &measured, &reference), &reference);
    }

    /// Adds a displacement of the whole outline in the body frame, which later poses are measured against.
    pub(crate) fn add_shift(&mut self, shift: &SVector<f64, MAX_PARAMETERS>) {
        self.common.add_shift(shift);
    }

    /// Lets the hypotheses, and not a constant generator alone, say where the object is expected.
    pub(super) fn lead_from_now_on(&mut self) {
        self.leads = true;
        self.record_that_outline_moves();
    }

    /// Records that the outline is learnt in poses which others than a constant generator expect, or wrong ones. Poses are counted from where it was
    /// before from now on, and so is the centroid.
    pub(super) fn record_that_outline_moves(&mut self) {
        if !self.outline_has_moved {
            (self.outline_has_moved, self.centroid_now) = (true, None);
        }
    }

    /// Takes the centroid of the outline as it is now; where it is in the body frame that poses are counted from. As long as it is not placed anew
    /// it stays there.
    pub(super) fn place_centroid(&mut self, now: &Point2<f64>) -> Point2<f64> {
        if self.centroid_now == Some(*now) {
            return self.reference.centroid;
        }
        self.centroid_now = Some(*now);
        if self.outline_has_moved { self.common.before(now) } else { *now }
    }

    /// Covariance of the error of the body frame that all poses have in common, as the outline is now.
    pub(crate) fn common_error(&self) -> Option<PoseMatrix> {
        self.common.of_body_frame(&self.reference)
    }

    /// The covariance of where the body frame lies beside the outline as it is known now, as an error that all poses have in common.
    pub(crate) fn error_beyond_outline(&self) -> Option<PoseMatrix> {
        self.common.beyond_now(&self.reference)
    }

    /// The centroid, in the body frame that poses are counted from.
    pub(crate) fn centroid(&self) -> Point2<f64> {
        self.reference.centroid
    }

    /// The pose in which the outline as it is now lies where a pose of these hypotheses has it.
    pub(crate) fn of_outline_now(&self, pose: &Matrix3<f64>) -> Matrix3<f64> {
        self.common.of_outline_now(pose)
    }

    /// Sets another reference pose, near the one before.
    pub(crate) fn set_reference(&mut self, pose: &Matrix3<f64>) -> bool {
        let to = CentredPose { pose: *pose, centroid: self.reference.centroid };
        let (model, k) = (self.model, self.model.parameter_count());
        let Some(inverse) = self.reference.pose.try_inverse() else { return false };
        let Some(moved) = model.motion_between(&(pose * inverse), 1.0) else { return false };
        let moved = self.reference.about_centroid(model) * SVector::<f64, MAX_PARAMETERS>::from(moved);
        let apart = to.centre() - self.reference.centre();
        for hypothesis in self.all() {
            for j in 0..k - 2 {
                hypothesis.mean[j] -= moved[j];
            }
            hypothesis.mean[k - 2] -= apart.x;
            hypothesis.mean[k - 1] -= apart.y;
        }
        self.reference = to;
        true
    }
}
