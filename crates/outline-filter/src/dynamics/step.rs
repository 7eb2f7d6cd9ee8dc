//! A step in time, as all hypotheses of dynamics take it.
use freeform_riccati::MotionModel;
use nalgebra::{Matrix2, Matrix3, SMatrix, Vector2};

use super::{
    centred::{CentredPose, CentredVector, as_map},
    usual_step::Units,
};
use crate::tuning::dynamics as tuning;

/// A step in time between two reference poses.
#[derive(Debug, Clone, Copy)]
pub(super) struct Step<'a> {
    pub(super) model: MotionModel,
    pub(super) seconds: f64,
    /// Linear part of the pose before, with that of the pose after it taken off.
    pub(super) turned: Matrix2<f64>,
    /// Its logarithm, as rates; none for projective motion.
    pub(super) turned_by: CentredVector,
    /// As `turned`, with the perspective of both poses, for projective motion.
    pub(super) local: Matrix3<f64>,
    /// The centroid before the step, as seen from the one after it.
    pub(super) centre: Vector2<f64>,
    /// Variance of a pose as one frame tells it, of every parameter.
    pub(super) pose_variance: &'a CentredVector,
    /// What accelerations that change at random add to errors, motions and accelerations: parts of a variance over the fifth power of a
    /// usual step.
    pub(super) by_change: [[f64; 3]; 3],
}

impl<'a> Step<'a> {
    /// `None` where the numbers do not allow it.
    pub(super) fn new(
        (model, seconds): (MotionModel, f64),
        [from, to]: [&CentredPose; 2],
        Units { pose_variance, usual, steps }: Units<'a>,
    ) -> Option<Self> {
        let turned = from.linear() * to.linear().try_inverse()?;
        let (mut turned_by, mut local) = (CentredVector::zeros(), Matrix3::identity());
        if model == MotionModel::Projective {
            local = from.local(model) * to.local(model).try_inverse()?;
        } else {
            let by = model.motion_between(&as_map(&turned), 1.0)?;
            turned_by = CentredVector::from_fn(|j, _| by[j]);
        }
        let by_change = shares_of_change(steps, usual);
        let centre = from.centre() - to.centre();
        Some(Self { model, seconds, turned, turned_by, local, centre, pose_variance, by_change })
    }

    /// Propagation of the N = 3 k errors of a hypothesis, as far as it is that of the pose by itself, where the rates stay and its centroid
    /// does not turn; `turn` is the linear part of the motion over the step.
    pub(super) fn pose_transition<const N: usize>(&self, turn: &Matrix2<f64>) -> SMatrix<f64, N, N> {
        let (model, k, dt) = (self.model, N / 3, self.seconds);
        let rates = k - 2;
        let mut f = SMatrix::<f64, N, N>::identity();
        if model <= MotionModel::Similarity {
            // Turns and growth commute.
            (0..rates).for_each(|i| f[(i, k + i)] = dt);
        } else {
            let map = as_map(turn);
            let carried = model.adjoint(&map, &map.try_inverse().unwrap_or(map));
            for i in 0..rates {
                for j in 0..rates {
                    let own = f64::from(u8::from(i == j));
                    f[(i, j)] = carried[i][j];
                    f[(i, k + j)] = 0.5 * dt * (own + carried[i][j]);
                }
            }
        }
        for i in rates..k {
            f[(i, k + i)] = dt;
        }
        f
    }
}

/// What accelerations that change at random add to errors, motions and accelerations over some steps of so many seconds: parts of a variance over the
/// fifth power of one.
fn shares_of_change(steps: f64, seconds: f64) -> [[f64; 3]; 3] {
    let (fifth, time) = (steps.powi(5), steps * seconds);
    let (of_motion, of_acceleration) = (fifth / (8.0 * time), fifth / (6.0 * time.powi(2)));
    let of_both = fifth / (2.0 * time.powi(3));
    [
        [fifth / 20.0, of_motion, of_acceleration],
        [of_motion, fifth / (3.0 * time.powi(2)), of_both],
        [of_acceleration, of_both, fifth / time.powi(4)],
    ]
}

/// How far a velocity takes an object over a step that is pushed on by one per second and turns with rates A beside that, from none: the integral of
/// that of the turn, `sum of A^n dt^(n+2) / (n+2)!`. A step is of a turn or two at most.
pub(super) fn pushed_along(rates: &Matrix2<f64>, seconds: f64) -> Matrix2<f64> {
    let mut term = Matrix2::identity() * (0.5 * seconds * seconds);
    let mut sum = term;
    for n in 3..=tuning::MOST_TERMS {
        term = rates * term * (seconds / f64::from(n));
        sum += term;
        if term.norm_squared() <= f64::EPSILON * f64::EPSILON * sum.norm_squared() {
            break;
        }
    }
    sum
}

/// How much farther than at the velocity before a step its part that turns with the object carries over the step, from the integral of the
/// turn.
pub(super) fn turned_along(along: &Matrix2<f64>, seconds: f64) -> Matrix2<f64> {
    along - Matrix2::identity() * seconds
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn accelerations_change_over_a_gap_by_as_much_as_in_its_steps_one_after_the_other() {
        const SECONDS: f64 = 1.0 / 30.0;
        let transition = Matrix3::new(1.0, SECONDS, 0.5 * SECONDS * SECONDS, 0.0, 1.0, SECONDS, 0.0, 0.0, 1.0);
        let of = |steps: f64| Matrix3::from(shares_of_change(steps, SECONDS));
        let mut one_by_one = Matrix3::zeros();
        for steps in 1_u8..=17 {
            one_by_one = transition * one_by_one * transition.transpose() + of(1.0);
            let at_once = of(f64::from(steps));
            let off = one_by_one.zip_map(&at_once, |a, b| (a / b - 1.0).abs()).max();
            assert!(off < 1e-12, "{steps}: {one_by_one} {at_once}");
        }
    }
}
