//! What is stated of the motion of a plane, and why something is not.
use freeform_estimate::PlaneEstimate;
use freeform_riccati::PlaneMotion;
use nalgebra::{Matrix3, Vector3};

use super::{plane_filter::PlaneFilter, scenery::Matrix8, solution::Solution};
use crate::tuning::plane as tuning;

/// Two motions of a plane that the frames do not decide between yet.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaneAmbiguity {
    /// The more probable one first.
    pub solutions: [PlaneSolution; 2],
    /// Names of the parameters in which they differ, and `normal`, which are not stated for it.
    pub parameters: Vec<&'static str>,
}

/// One of two motions of a plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneSolution {
    /// Motion and normal, with standard deviations.
    pub estimate: PlaneEstimate,
    /// Its probability.
    pub probability: f64,
}

/// Why something of the motion of a plane is not stated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlaneUnknown {
    /// The plane hardly moves, but for a turn about the camera, which all planes show alike: nothing tells its normal, nor the velocity that
    /// goes with it.
    HardlyMoves,
    /// The frames do not tell all of it well enough.
    NotYet,
}

/// Positions of w, v and the normal among the parameters.
const W: std::ops::Range<usize> = 0..3;
const V: std::ops::Range<usize> = 3..6;
const N: std::ops::Range<usize> = 6..8;

impl PlaneFilter {
    /// Two motions that explain the frames, as long as these do not decide between them.
    #[must_use]
    pub fn ambiguity(&self) -> Option<PlaneAmbiguity> {
        let [best, second] = &self.solutions[..] else { return None };
        let behind = self.behind(best, second);
        if behind > tuning::DECIDED {
            return None;
        }
        let [one, other] = [self.alone(best)?, self.alone(second)?];
        let probability = 1.0 / (1.0 + (-0.5 * behind).exp());
        let differs = differing(&one, &other);
        let mut parameters: Vec<_> =
            PlaneMotion::NAMES.into_iter().zip(differs).filter(|(_, d)| *d).map(|(n, _)| n).collect();
        if N.into_iter().any(|j| differs[j]) {
            parameters.push("normal");
        }
        (!parameters.is_empty()).then_some(PlaneAmbiguity {
            solutions: [
                PlaneSolution { estimate: one, probability },
                PlaneSolution { estimate: other, probability: 1.0 - probability },
            ],
            parameters,
        })
    }

    /// Why something is not stated that the two solutions do not differ in; `None` where all is known, or nothing yet.
    #[must_use]
    pub fn unknown(&self) -> Option<PlaneUnknown> {
        let alone = self.alone(self.solutions.first()?)?;
        if alone.known().iter().all(|known| *known) {
            return None;
        }
        let velocity = alone.motion().velocity;
        let is_slow = velocity.norm() * self.span() < tuning::HARDLY_MOVED || !moves(&velocity, alone.covariance());
        let has_normal = N.into_iter().all(|j| alone.known()[j]);
        Some(if is_slow && !has_normal { PlaneUnknown::HardlyMoves } else { PlaneUnknown::NotYet })
    }

    /// How far new frames lie from where the motion puts them: mean square in units of what is expected, at least 1. Much more
    /// than 1 where angular velocity or velocity change, the object bends, or focal length or principal point are wrong.
    #[must_use]
    pub fn misfit(&self) -> f64 {
        self.solutions.first().map_or(1.0, |best| best.agreement.excess())
    }

    /// By how much a solution is behind the best, twice the negative logarithm of the ratio of their likelihoods.
    fn behind(&self, best: &Solution, other: &Solution) -> f64 {
        let correlation = self.scenery.as_ref().map_or(1.0, |scenery| scenery.noise.correlation());
        (other.squares - best.squares) / (correlation * best.agreement.excess())
    }

    pub(super) fn estimate_of(&self, best: &Solution) -> Option<PlaneEstimate> {
        let alone = self.alone(best)?;
        let Some(second) = self.solutions.get(1).filter(|second| self.behind(best, second) <= tuning::DECIDED) else {
            return Some(alone);
        };
        let differs = differing(&alone, &self.alone(second)?);
        let mut known = *alone.known();
        known.iter_mut().zip(differs).for_each(|(known, differs)| *known &= !differs);
        Some(PlaneEstimate::new(*alone.motion(), *alone.covariance(), known))
    }

    /// A solution as if it were the only one.
    fn alone(&self, solution: &Solution) -> Option<PlaneEstimate> {
        if self.frame_count() < tuning::FEWEST_FRAMES {
            return None;
        }
        let (scenery, span) = (self.scenery.as_ref()?, self.span());
        let covariance = solution.covariance(scenery, span)? * solution.agreement.excess();
        let deviation = |j: usize| covariance[(j, j)].max(0.0).sqrt();
        // Noise alone is best explained by some small velocity, with a normal that fits it.
        let normal = moves(&solution.motion.velocity, &covariance)
            && N.into_iter().all(|j| deviation(j) <= tuning::LARGEST_DEVIATION_OF_NORMAL);
        let mut known = [normal; PlaneMotion::PARAMETERS];
        for j in W.chain(V) {
            let is_worth = deviation(j) * span <= tuning::LARGEST_DEVIATION;
            // The velocity goes with the normal: the picture shows their product.
            known[j] = is_worth && (W.contains(&j) || normal);
        }
        let estimate = PlaneEstimate::new(solution.motion, covariance, known);
        estimate.is_finite().then_some(estimate)
    }
}

/// Whether a velocity is beyond doubt, given the covariance of all parameters: Wald's statistic.
fn moves(velocity: &Vector3<f64>, covariance: &Matrix8) -> bool {
    let of_velocity: Matrix3<f64> = covariance.fixed_view::<3, 3>(V.start, V.start).into_owned();
    freeform_estimate::scaled_solution(&of_velocity, velocity)
        .is_some_and(|weighted| velocity.dot(&weighted) > tuning::MOVES)
}

/// In which parameters two solutions differ by more than a little.
fn differing(one: &PlaneEstimate, other: &PlaneEstimate) -> [bool; PlaneMotion::PARAMETERS] {
    let (a, b) = (one.motion().parameters(), other.motion().parameters());
    let differs = |j: usize| (a[j] - b[j]).abs() > tuning::DIFFERENT * one.covariance()[(j, j)].max(0.0).sqrt();
    let mut all: [bool; PlaneMotion::PARAMETERS] = std::array::from_fn(differs);
    // What belongs together is told together.
    for group in [V, N] {
        let any = group.clone().any(|j| all[j]);
        group.for_each(|j| all[j] = any);
    }
    all
}
