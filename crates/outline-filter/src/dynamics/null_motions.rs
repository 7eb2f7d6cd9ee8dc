//! Motions that the outline does not show, in all hypotheses of dynamics: held at none, or told by a path.
use freeform_riccati::MAX_PARAMETERS;
use nalgebra::SVector;

use super::{centred::CentredVector, interacting::InteractingHypotheses};
use crate::{map::NullDirection, tuning::dynamics as tuning};

impl<const N: usize> InteractingHypotheses<N> {
    /// Lets the path of the centroid tell what the outline does not show of the rates, from a prior that is as wide as steps of so many seconds
    /// allow.
    pub(super) fn add_turn_of_path(&mut self, null: &[NullDirection], seconds: f64) {
        let (from, k) = (self.reference.about_centroid(self.model), self.model.parameter_count());
        (self.turn_is_of_path, self.leads) = (true, true);
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
