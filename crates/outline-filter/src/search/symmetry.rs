//! Turns that bring an outline onto itself.
use nalgebra::Matrix3;

use crate::{
    measurement::{FirstPose, Frame},
    track::Track,
    tuning::symmetry as tuning,
};

/// Order of the symmetry of an outline: the largest n for which the known outline turned by the n-th part of a circle explains a frame
/// as well as it does in its pose, which is looked at first, and half of that turn does not; 1 where there is none, and where the outline is as good as
/// round.
pub(crate) fn symmetry_order(track: &Track, first: &FirstPose, pose: &Matrix3<f64>, frame: &mut Frame) -> usize {
    if track.turn_is_unseen() {
        return 1;
    }
    let mut as_good = |orders: Vec<usize>| -> Vec<usize> {
        if orders.is_empty() {
            return orders;
        }
        let turns = orders.iter().map(|n| track.turned(pose, std::f64::consts::TAU / *n as f64));
        let turns: Vec<_> = turns.collect();
        let likelihoods = track.compared_with(first, &turns, frame, tuning::FAR_WORSE * tuning::AS_GOOD);
        let is_as_good = likelihoods[1..].iter().map(|other| other.is_within(tuning::AS_GOOD, &likelihoods[0]));
        orders.into_iter().zip(is_as_good).filter_map(|(n, is_as_good)| is_as_good.then_some(n)).collect()
    };
    // What is turned onto itself by the n-th part of a circle is by that of every factor of n, too: the primes say what else may be.
    let all = 2..=tuning::LARGEST_ORDER;
    let mut found = as_good(all.clone().filter(|n| prime_factors(*n).next() == Some(*n)).collect());
    let may_be = |n: &usize| prime_factors(*n).all(|factor| factor < *n && found.contains(&factor));
    let composite = as_good(all.filter(may_be).collect());
    found.extend(composite);
    if found.is_empty() {
        return 1;
    }
    found.sort_unstable_by(|a, b| b.cmp(a));
    // Turns that are too small for the frame to show are no symmetry: half of one of a symmetry is seen.
    let halves: Vec<_> = found.iter().map(|n| track.turned(pose, std::f64::consts::PI / *n as f64)).collect();
    let likelihoods = track.compared_with(first, &halves, frame, tuning::FAR_WORSE * tuning::HALF_IS_WORSE);
    let seen = |at: &usize| !likelihoods[at + 1].is_within(tuning::HALF_IS_WORSE, &likelihoods[0]);
    (0..found.len()).find(seen).map_or(1, |at| found[at])
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
