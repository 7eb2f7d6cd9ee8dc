//! How well poses of an object explain a frame, compared with each other.
use freeform_curve_fit::Outline;
use nalgebra::Matrix3;

use super::{Track, wrapped};
use crate::{
    measurement::{FirstPose, Frame, NegativeLogLikelihood},
    tuning::{
        likelihood::{ENOUGH_POINTS, FAR_WORSE},
        registration as tuning,
    },
};

impl Track {
    /// Negative log-likelihoods of an outline in several poses.
    pub(crate) fn compared(
        &self,
        outline: &Outline,
        poses: &[Matrix3<f64>],
        frame: &mut Frame,
    ) -> Vec<NegativeLogLikelihood> {
        self.load_to_compare(outline, frame);
        self.view().negative_log_likelihoods(frame, poses)
    }

    /// As [`compared`](Self::compared), of one pose that others are [compared with](Self::compared_with) as long as the frame is loaded.
    pub(crate) fn first_of_compared(&self, outline: &Outline, pose: &Matrix3<f64>, frame: &mut Frame) -> FirstPose {
        self.load_to_compare(outline, frame);
        self.view().look_at_first(frame, pose)
    }

    /// Negative log-likelihood of a pose that others may be compared with.
    pub(crate) fn of_first(&self, first: &FirstPose) -> NegativeLogLikelihood {
        self.view().negative_log_likelihood_of_first(first)
    }

    /// Loads the points that poses are compared by.
    fn load_to_compare(&self, outline: &Outline, frame: &mut Frame) {
        frame.load(outline, self.reference);
        frame.thin_out(ENOUGH_POINTS);
    }

    /// Negative log-likelihoods of a pose and of others compared with it; what is far worse than that is not measured.
    pub(crate) fn compared_with(
        &self,
        first: &FirstPose,
        others: &[Matrix3<f64>],
        frame: &mut Frame,
        far_worse: f64,
    ) -> Vec<NegativeLogLikelihood> {
        self.view().negative_log_likelihoods_beside_first(frame, first, others, far_worse)
    }

    /// Whether the outline in a pose explains a frame significantly better than in most of the poses turned from it.
    pub(crate) fn shows_turn(&self, outline: &Outline, pose: &Matrix3<f64>, frame: &mut Frame) -> bool {
        let first = self.first_of_compared(outline, pose, frame);
        self.shows_turn_beside(&first, outline, pose, frame)
    }

    /// As [`shows_turn`](Self::shows_turn), of a pose that has been looked at first: others are compared with it as long as the frame is loaded, which it
    /// is also after this.
    pub(crate) fn shows_turn_beside(
        &self,
        first: &FirstPose,
        outline: &Outline,
        pose: &Matrix3<f64>,
        frame: &mut Frame,
    ) -> bool {
        let turns = (1..=tuning::OTHER_TURNS).map(|i| tuning::GOLDEN_ANGLE * i as f64);
        let others = turns.filter(|turn| wrapped(*turn).abs() >= tuning::NEAR).map(|turn| self.turned(pose, turn));
        let likelihoods = self.compared_with(first, &others.collect::<Vec<_>>(), frame, FAR_WORSE);
        let worse = likelihoods[1..].iter().filter(|other| other.is_worse_than(&likelihoods[0])).count();
        // What has been seen of a turn for the first time may be a single mark, which the next frame may hide: it then lies anywhere in
        // what that frame does not show.
        let is_new = self.turn_evidence().is_new();
        let share = if is_new { tuning::NEARLY_ALL } else { tuning::MOST };
        let is_shown = worse as f64 > share * (likelihoods.len() - 1) as f64;
        if !is_shown || !is_new {
            return is_shown;
        }
        let shows_it_again = self.begun_anew(outline, frame).is_some();
        self.load_to_compare(outline, frame);
        shows_it_again
    }
}
