//! Whether an outline turns in its place.
use std::f64::consts::TAU;

use nalgebra::Vector2;

use super::sight::Sight;
use super::tuning::turning::{self as tuning, DIRECTIONS, PARTS};
use crate::edges::median;

/// How far an outline reaches from its middle in every direction.
pub(super) struct Reach([f64; DIRECTIONS]);

impl Reach {
    /// `None` where there are too few points.
    pub(super) fn of(sight: &Sight) -> Option<Self> {
        let mut farthest = [0.0_f64; DIRECTIONS];
        for point in &sight.points {
            let from_middle = point - sight.centre;
            let reach = &mut farthest[direction_of(from_middle).floor() as usize % DIRECTIONS];
            *reach = reach.max(from_middle.norm());
        }
        let seen: Vec<usize> = (0..DIRECTIONS).filter(|k| farthest[*k] > 0.0).collect();
        if tuning::ONE_IN_SEEN * seen.len() < DIRECTIONS {
            return None;
        }
        // Directions between those of points.
        for (k, &from) in seen.iter().enumerate() {
            let to = seen[(k + 1) % seen.len()] + if k + 1 == seen.len() { DIRECTIONS } else { 0 };
            let rise = (farthest[to % DIRECTIONS] - farthest[from]) / (to - from) as f64;
            for between in from + 1..to {
                farthest[between % DIRECTIONS] = farthest[from] + rise * (between - from) as f64;
            }
        }
        Some(Self(farthest))
    }

    fn at(&self, direction: f64) -> f64 {
        let (below, part) = (direction.floor(), direction - direction.floor());
        let value = |k: f64| self.0[k.rem_euclid(DIRECTIONS as f64) as usize % DIRECTIONS];
        (1.0 - part) * value(below) + part * value(below + 1.0)
    }

    /// Mean square of what this, turned by so much, and another differ by.
    fn misfit(&self, other: &Self, turn: f64) -> f64 {
        let shift = turn / TAU * DIRECTIONS as f64;
        let squares = (0..DIRECTIONS).map(|k| (other.at(k as f64 + shift) - self.0[k]).powi(2));
        squares.sum::<f64>() / DIRECTIONS as f64
    }

    /// The same, turned by whole directions.
    fn misfit_by(&self, other: &Self, directions: usize) -> f64 {
        let (before, from) = other.0.split_at(directions);
        let (with_from, with_before) = self.0.split_at(from.len());
        let squares = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        (squares(with_from, from) + squares(with_before, before)) / DIRECTIONS as f64
    }

    /// Whether another is clearly more like this if this is turned.
    pub(super) fn has_turned_to(&self, other: &Self) -> bool {
        self.gain(other).is_some_and(|gain| gain < tuning::TURNED.powi(2))
    }

    /// By how much this, turned, is like another at its best, over how much it is as it lies: squared.
    fn gain(&self, other: &Self) -> Option<f64> {
        let as_it_lies = self.misfit(other, 0.0);
        let of_directions = (0..DIRECTIONS).map(|k| (k, self.misfit_by(other, k)));
        let (nearest, _) = of_directions.min_by(|a, b| a.1.total_cmp(&b.1))?;
        let part = |part: i32| (nearest as f64 + f64::from(part) / f64::from(PARTS)) * TAU / DIRECTIONS as f64;
        let least = (1 - PARTS..PARTS).map(|k| self.misfit(other, part(k))).fold(f64::INFINITY, f64::min);
        (as_it_lies > 0.0).then(|| least / as_it_lies)
    }
}

/// Whether what is seen turns: most outlines are clearly more like the first where that is turned.
pub(super) fn turns(sights: &[Sight]) -> bool {
    let Some((first, others)) = sights.split_first() else { return false };
    let Some(first) = Reach::of(first) else { return false };
    let gains = others.iter().filter_map(|other| first.gain(&Reach::of(other)?));
    median(gains).is_some_and(|gain| gain < tuning::TURNED.powi(2))
}

/// In parts of a circle, from 0 on.
fn direction_of(from_middle: Vector2<f64>) -> f64 {
    (from_middle.y.atan2(from_middle.x) / TAU).rem_euclid(1.0) * DIRECTIONS as f64
}

#[cfg(test)]
mod tests {
    use nalgebra::Point2;

    use super::*;
    use crate::choice::sight::Inner;

    /// What is seen of an outline that reaches so far from its middle in a direction.
    fn outline(reach: impl Fn(f64) -> f64) -> Sight {
        let centre = Point2::new(160.0, 120.0);
        let at = |k: usize| k as f64 / 700.0 * TAU;
        let points = (0..700).map(|k| centre + reach(at(k)) * Vector2::new(at(k).cos(), at(k).sin())).collect();
        let (contrast, objects, inner) = (1.0, [1, 1], Inner::default());
        Sight {
            frame: 0,
            centre,
            area: 2e4,
            invariants: None,
            is_clipped: false,
            points,
            contrast,
            objects,
            inner,
            second: 0.0,
        }
    }

    fn wheel(turn: f64) -> Sight {
        outline(|at| 80.0 + 4.0 * (17.0 * (at - turn)).cos().signum())
    }

    /// A plate with a notch.
    fn plate(notch: f64) -> Sight {
        outline(|at| {
            let side = 70.0 / at.cos().abs().max(at.sin().abs());
            if (at - notch).abs() < 0.1 { side - 15.0 } else { side }
        })
    }

    #[test]
    fn a_wheel_turns_and_a_plate_over_whose_edge_something_goes_does_not() {
        let wheels: Vec<Sight> = (0..12).map(|k| wheel(0.03 * f64::from(k))).collect();
        assert!(turns(&wheels));
        let plates: Vec<Sight> = (0..12).map(|k| plate(0.3 + 0.1 * f64::from(k))).collect();
        assert!(!turns(&plates));
        assert!(!turns(&vec![wheel(0.3); 5]));
    }

    #[test]
    fn a_wheel_has_turned_by_little_too_and_a_plate_over_whose_edge_something_goes_has_not() {
        let reach = |sight: Sight| Reach::of(&sight).expect("an outline");
        for turn in [0.02, 0.06, 0.3] {
            assert!(reach(wheel(0.2)).has_turned_to(&reach(wheel(0.2 + turn))), "{turn}");
            assert!(!reach(plate(0.2)).has_turned_to(&reach(plate(0.2 + turn))), "{turn}");
        }
        assert!(!reach(wheel(0.2)).has_turned_to(&reach(wheel(0.2))));
    }
}
