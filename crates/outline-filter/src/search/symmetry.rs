//! Turns that bring an outline onto itself.
use std::f64::consts::{PI, TAU};

use freeform_riccati::MotionModel;
use nalgebra::{Matrix3, Point2, Rotation2, Vector2};

use super::{
    near_symmetry::centre_of,
    refinement::{Steps, refined},
};
use crate::{
    map::map_between,
    measurement::{FirstPose, Frame},
    track::{Track, wrapped},
    tuning::symmetry as tuning,
};

/// Which point the turns are about that may bring an outline onto itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum TurnCentre {
    /// The middle of what has been seen of it.
    Middle,
    /// The fixed point of the best turn about the middle, once that has been refined to the frame: for outlines of which some parts have been seen more
    /// often than others. After few frames that point is not known, and outlines that have shown no mark yet would pass for symmetric. An outline that
    /// may be stretched is turned about its middle all the same: its turns are none of the picture.
    Found,
}

/// Order of the symmetry of an outline: the largest n for which the known outline turned by the n-th part of a circle explains a frame
/// as well as it does in its pose, which is looked at first, and half of that turn does not; 1 where there is none, and where the outline is as good as
/// round.
pub(crate) fn symmetry_order(
    track: &Track,
    first: &FirstPose,
    (pose, about): (&Matrix3<f64>, TurnCentre),
    frame: &mut Frame,
) -> usize {
    if track.turn_is_unseen() {
        return 1;
    }
    let primes: Vec<_> = (2..=tuning::LARGEST_ORDER).filter(|n| prime_factors(*n).next() == Some(*n)).collect();
    let mut turned = Turned { track, first, pose, centre: None };
    let mut of_primes = turned.mean_squares(&primes, frame, about);
    if about == TurnCentre::Found
        && let Some(centre) = turned.centre_of_best(&primes, &of_primes, &frame.points)
    {
        let about_centre = Turned { centre: Some(centre), ..turned };
        let of_centre = about_centre.mean_squares(&primes, frame, about);
        if least(&of_centre) < least(&of_primes) {
            (turned, of_primes) = (about_centre, of_centre);
        }
    }
    let mut found = as_good(&primes, &of_primes);
    // What is turned onto itself by the n-th part of a circle is by that of every factor of n, too: the primes say what else may be.
    let may_be = |n: &usize| prime_factors(*n).all(|factor| factor < *n && found.contains(&factor));
    let composite: Vec<_> = (2..=tuning::LARGEST_ORDER).filter(may_be).collect();
    found.extend(as_good(&composite, &turned.mean_squares(&composite, frame, about)));
    if found.is_empty() {
        return 1;
    }
    found.sort_unstable_by(|a, b| b.cmp(a));
    // Turns that are too small for the frame to show are no symmetry: half of one of a symmetry is seen.
    let halves: Vec<_> = found.iter().map(|n| turned.by(PI / *n as f64)).collect();
    let likelihoods = track.compared_with(first, &halves, frame, tuning::FAR_WORSE * tuning::HALF_IS_WORSE);
    let seen = |at: &usize| !likelihoods[at + 1].is_within(tuning::HALF_IS_WORSE, &likelihoods[0]);
    (0..found.len()).find(seen).map_or(1, |at| found[at])
}

/// The orders whose turns explain a frame as well as none does, by the [mean squares](Turned::mean_squares) of their turns.
fn as_good(orders: &[usize], mean_squares: &[f64]) -> Vec<usize> {
    orders.iter().zip(mean_squares).filter(|(_, times)| **times <= tuning::AS_GOOD).map(|(order, _)| *order).collect()
}

fn least(mean_squares: &[f64]) -> f64 {
    mean_squares.iter().copied().fold(f64::INFINITY, f64::min)
}

/// The outline of a track turned from a pose, which has been looked at first.
#[derive(Clone, Copy)]
struct Turned<'a> {
    track: &'a Track,
    first: &'a FirstPose,
    pose: &'a Matrix3<f64>,
    /// What it is turned about, in the body frame; the middle of what has been seen of it where that is `None`.
    centre: Option<Vector2<f64>>,
}

impl Turned<'_> {
    fn by(&self, angle: f64) -> Matrix3<f64> {
        match &self.centre {
            Some(centre) => self.pose * map_between(Rotation2::new(angle).matrix(), centre, centre),
            None => self.track.turned(self.pose, angle),
        }
    }

    /// Mean squares of the innovations after the n-th part of a circle, for some n, in that of the pose that has been looked at first.
    fn mean_squares(&self, orders: &[usize], frame: &mut Frame, about: TurnCentre) -> Vec<f64> {
        if orders.is_empty() {
            return Vec::new();
        }
        let poses: Vec<_> = orders.iter().map(|n| self.by(TAU / *n as f64)).collect();
        // Beyond the limit they are those of a first look, which stops there.
        let limit = match about {
            TurnCentre::Middle => tuning::AS_GOOD,
            TurnCentre::Found => tuning::NEARLY_AS_GOOD,
        };
        let likelihoods = self.track.compared_with(self.first, &poses, frame, tuning::FAR_WORSE * limit);
        likelihoods[1..].iter().map(|other| other.mean_square_over(&likelihoods[0])).collect()
    }

    /// The fixed point of the best of some turns, refined to the points of the frame, in the body frame. `None` where no turn is in doubt, which is
    /// nearly, but not quite, as good as none; and where the refinement has led to another turn, or to a point aside of the outline's middle.
    fn centre_of_best(&self, orders: &[usize], mean_squares: &[f64], points: &[Point2<f64>]) -> Option<Vector2<f64>> {
        let are_in_doubt = mean_squares.iter().any(|times| (tuning::AS_GOOD..tuning::NEARLY_AS_GOOD).contains(times));
        if !are_in_doubt || self.track.model() > MotionModel::Similarity {
            return None;
        }
        let (best, _) = orders.iter().zip(mean_squares).min_by(|a, b| a.1.total_cmp(b.1))?;
        let angle = TAU / *best as f64;
        let found = refined(self.track, points, MotionModel::Rigid, &self.by(angle), Steps::REFINEMENT);
        let step = self.pose.try_inverse()? * found.pose;
        let is_same_turn = wrapped(step[(1, 0)].atan2(step[(0, 0)]) - angle).abs() < tuning::SAME * angle;
        let centre = centre_of(&step).filter(|_| is_same_turn)?;
        ((centre - self.track.map().centroid().coords).norm() < tuning::OFF_MIDDLE).then_some(centre)
    }
}

/// Prime factors of a number, each as often as it divides.
fn prime_factors(number: usize) -> impl Iterator<Item = usize> {
    let mut rest = number;
    let mut factor = 2;
    std::iter::from_fn(move || {
        if rest < 2 {
            return None;
        }
        while !rest.is_multiple_of(factor) {
            // What has no factor up to its root is a prime.
            factor = if factor * factor < rest { factor + 1 } else { rest };
        }
        rest /= factor;
        Some(factor)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prime_factors_multiply_to_the_number() {
        let factors = |number: usize| prime_factors(number).collect::<Vec<_>>();
        assert_eq!(factors(72), [2, 2, 2, 3, 3]);
        assert_eq!(factors(49), [7, 7]);
        assert_eq!(factors(71), [71]);
        for number in 2..=72 {
            let factors = factors(number);
            assert_eq!(factors.iter().product::<usize>(), number);
            assert!(
                factors.iter().all(|factor| (2..*factor).all(|other| factor % other != 0)),
                "{number}: {factors:?}"
            );
        }
    }
}
