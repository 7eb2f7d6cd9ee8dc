//! Motions that the outline does not show, in all hypotheses of dynamics: held at none, or told by a path.
use freeform_riccati::MAX_PARAMETERS;
use nalgebra::SVector;

use super::{centred::CentredVector, hypothesis::Hypothesis, interacting::InteractingHypotheses};
use crate::{map::NullDirection, tuning::dynamics as tuning};

impl<const N: usize> InteractingHypotheses<N> {
    /// Lets the path of the centroid tell what the outline does not show of the rates, from a prior that is as wide as steps of so many seconds
    /// allow.
    pub(super) fn add_turn_of_path(&mut self, null: &[NullDirection], seconds: f64) {
        let (from, k) = (self.reference.about_centroid(self.model), self.model.parameter_count());
        self.turn_is_of_path = true;
        self.lead_from_now_on();
        for NullDirection { direction, .. } in null {
            let direction = from * SVector::<f64, MAX_PARAMETERS>::from(*direction);
            let largest = (0..k - 2).map(|i| direction[i].abs()).fold(0.0, f64::max);
            if largest > 0.0 {
                let unit = tuning::LARGEST_STEP_OF_PATH / (seconds * largest);
                for hypothesis in &mut self.hypotheses {
                    for (i, j) in (0..k).flat_map(|i| (0..k).map(move |j| (i, j))) {
                        hypothesis.covariance[(k + i, k + j)] += direction[i] * direction[j] * unit * unit;
                    }
                }
            }
        }
    }

    /// Takes nothing to be known along directions that were not shown so far, after a step of so many seconds: neither of the pose, nor of the
    /// motion, nor of what changes it.
    pub(crate) fn forget(&mut self, directions: &[NullDirection], seconds: f64) {
        if seconds <= 0.0 || self.turn_is_of_path {
            return;
        }
        let from = self.reference.about_centroid(self.model);
        let (pose_variance, usual) = (self.pose_variance, self.usual_step.seconds());
        for NullDirection { direction, .. } in directions {
            let direction = from * SVector::<f64, MAX_PARAMETERS>::from(*direction);
            self.all().for_each(|hypothesis| hypothesis.forget(&direction, (&pose_variance, usual), seconds));
        }
    }

    /// Projects the null directions of the reference pose out of all hypotheses.
    pub(super) fn hold(&mut self, null: &[NullDirection]) {
        let Some(to) = self.reference.about_origin(self.model).filter(|_| !null.is_empty()) else { return };
        let (from, k) = (self.reference.about_centroid(self.model), self.model.parameter_count());
        for NullDirection { direction, dual } in null {
            let direction = from * SVector::<f64, MAX_PARAMETERS>::from(*direction);
            let dual = to.transpose() * SVector::<f64, MAX_PARAMETERS>::from(*dual);
            let short =
                |v: &SVector<f64, MAX_PARAMETERS>| CentredVector::from_fn(|i, _| if i < k { v[i] } else { 0.0 });
            self.all().for_each(|hypothesis| hypothesis.hold(&short(&direction), &short(&dual)));
        }
    }
}

impl<const N: usize> Hypothesis<N> {
    /// Takes next to nothing to be known along a direction of the pose after a step of so many seconds: the object may have moved along it by a
    /// radius or by some in the step, and its acceleration is that of a hypothesis that begins.
    fn forget(
        &mut self,
        direction: &SVector<f64, MAX_PARAMETERS>,
        (pose_variance, usual): (&CentredVector, f64),
        seconds: f64,
    ) {
        let k = Self::K;
        let accelerations = self.course.acceleration_prior(pose_variance, k, usual);
        // Of a multiple of the direction, along which it is that of a vector of this length.
        let squared = direction.norm_squared();
        let of_acceleration = (0..k).map(|i| accelerations[i] * (direction[i] / squared).powi(2)).sum::<f64>();
        for (block, variance) in [1.0, (seconds * seconds).recip(), of_acceleration].into_iter().enumerate() {
            for (i, j) in (0..k).flat_map(|i| (0..k).map(move |j| (i, j))) {
                self.covariance[(block * k + i, block * k + j)] += variance * direction[i] * direction[j];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use freeform_riccati::MotionModel;
    use nalgebra::{Matrix3, Point2};

    use super::*;
    use crate::{
        belief::StateMatrix,
        dynamics::{CentredPose, Dynamics, Summary},
    };

    #[test]
    fn a_slide_that_was_held_at_none_is_unknown_to_all_hypotheses_once_it_is_forgotten() {
        const SECONDS: f64 = 0.5;
        let covariance = |shared: f64| StateMatrix::from_fn(|i, j| if i == j && i < 6 { 1e-4 + shared } else { 0.0 });
        let summary = Summary { pose: Matrix3::identity(), motion: Default::default(), covariance: covariance(1e-5) };
        let (model, given_outline) = (MotionModel::Rigid, covariance(0.0));
        let place = (Point2::origin(), [].as_slice());
        let mut dynamics =
            InteractingHypotheses::<9>::begin(model, Dynamics::Auto, (&summary, &given_outline), place, SECONDS)
                .expect("hypotheses");
        let (mut direction, pose) =
            ([0.0; MAX_PARAMETERS], CentredPose { pose: Matrix3::identity(), centroid: place.0 });
        (direction[1], direction[2]) = (0.8, 0.6);
        let slide = [NullDirection { direction, dual: direction }];
        let along = |dynamics: &mut InteractingHypotheses<9>, block: usize| -> Vec<f64> {
            // About the centroid a shift is what it is about the origin.
            let slide = SVector::<f64, 9>::from_fn(|i, _| match i.checked_sub(3 * block) {
                Some(1) => 0.8,
                Some(2) => 0.6,
                _ => 0.0,
            });
            dynamics.all().map(|h| (slide.transpose() * h.covariance * slide)[(0, 0)]).collect()
        };
        assert!(dynamics.predict(&pose, SECONDS, &slide));
        for block in 0..3 {
            let all = along(&mut dynamics, block);
            assert!(all.iter().all(|variance| variance.abs() < 1e-11), "{block} {all:?}");
        }
        dynamics.forget(&slide, SECONDS);
        assert!(along(&mut dynamics, 0).iter().all(|variance| (variance - 1.0).abs() < 1e-6));
        assert!(along(&mut dynamics, 1).iter().all(|variance| (variance - 4.0).abs() < 1e-6));
        // A steady acceleration is as unknown as before; of a constant generator there is none.
        let of_accelerations = along(&mut dynamics, 2);
        assert!(of_accelerations.iter().any(|variance| *variance > 0.0) && of_accelerations[0] == 0.0);
        // Across it all is as it was.
        let across = dynamics.hypotheses[0].covariance[(0, 0)];
        assert!(across < 1e-3, "{across}");
    }
}
