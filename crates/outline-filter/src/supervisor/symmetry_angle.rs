//! The angle by which an outline looks the same, and which turns it leaves open.
use std::f64::consts::TAU;

use crate::{
    track::wrapped,
    tuning::{symmetry::SAME, turn_hypotheses as tuning},
};

/// The angle by which an outline looks the same, rad: a whole turn where no symmetry of it is known.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(from = "f64"))]
pub(super) struct SymmetryAngle(f64);

impl Default for SymmetryAngle {
    fn default() -> Self {
        Self::WHOLE_TURN
    }
}

#[cfg(feature = "serde")]
impl From<f64> for SymmetryAngle {
    /// A saved state may have 0 for the angle of an outline that no symmetry has been looked for in.
    fn from(radians: f64) -> Self {
        if radians == 0.0 { Self::WHOLE_TURN } else { Self(radians) }
    }
}

impl SymmetryAngle {
    /// Of an outline without a known symmetry.
    pub(super) const WHOLE_TURN: Self = Self(TAU);

    /// Of an outline with a symmetry of some order, 1 where there is none.
    pub(super) fn of_order(order: usize) -> Self {
        Self(TAU / order as f64)
    }

    pub(super) fn radians(self) -> f64 {
        self.0
    }

    #[cfg(feature = "serde")]
    pub(super) fn is_valid(self) -> bool {
        self.0.is_finite() && self.0 > 0.0
    }

    /// Turns farther apart than this are different, rad.
    pub(super) fn different_turn(self) -> f64 {
        tuning::DIFFERENT_TURN.min(SAME * self.0)
    }

    /// Whether turns differ by a multiple of the angle of a symmetry, so that they look the same.
    pub(super) fn makes_alike(self, turn: f64, other: f64) -> bool {
        let steps = (turn - other) / self.0;
        self.0 < TAU && (steps - steps.round()).abs() <= SAME
    }

    /// Turns next to a present one that look the same.
    pub(super) fn turns_like(self, present: f64) -> Vec<f64> {
        let mut turns: Vec<f64> = [-1.0, 1.0, -2.0, 2.0].map(|step| present + step * self.0).into();
        if self.0 < TAU {
            let different_turn = self.different_turn();
            // By two steps back a triangle turns as by one step on.
            turns = turns.into_iter().map(wrapped).fold(Vec::new(), |mut distinct: Vec<f64>, turn| {
                if distinct.iter().all(|other| (other - turn).abs() >= different_turn) {
                    distinct.push(turn);
                }
                distinct
            });
            turns.retain(|turn| (turn - present).abs() > different_turn);
        } else {
            // A whole turn more or less looks the same; where it is surely the larger one it is not named.
            turns.retain(|turn| is_doubtful(*turn, present));
        }
        turns
    }
}

/// Whether a turn cannot be taken for granted against another.
pub(super) fn is_doubtful(other: f64, present: f64) -> bool {
    other.abs() < tuning::SURELY_SMALLER * present.abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_that_look_the_same_are_named_once() {
        for (order, others) in [(2, 1), (3, 2), (4, 3), (5, 4), (20, 4)] {
            let turns = SymmetryAngle::of_order(order).turns_like(-0.6);
            assert_eq!(turns.len(), others, "{order}: {turns:?}");
        }
    }

    #[cfg(feature = "serde")]
    #[test]
    fn the_angle_0_of_a_saved_state_is_read_as_that_of_no_known_symmetry() {
        assert_eq!(SymmetryAngle::from(0.0).radians(), TAU);
        assert_eq!(SymmetryAngle::from(1.0).radians(), 1.0);
        assert!(![-1.0, f64::NAN, f64::INFINITY].into_iter().any(|radians| SymmetryAngle::from(radians).is_valid()));
    }
}
