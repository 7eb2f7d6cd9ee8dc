//! Turns by which an outline nearly looks the same, as a gear does but for a mark.
use std::f64::consts::TAU;

use nalgebra::{Matrix2, Matrix3, Rotation2, Vector2};

use super::refinement::RegisteredPose;
use crate::{map::map_between, track::wrapped, tuning::registration as tuning};

/// Further poses to start from, where those that were found explain the frame nearly alike and are multiples of a part of a circle apart about one
/// point: the best of them, turned by all other multiples about it. None where that is not so.
pub(super) fn turns_of_near_symmetry(found: &[RegisteredPose]) -> Vec<Matrix3<f64>> {
    let Some(best) = found.iter().min_by(|a, b| a.score.total_cmp(&b.score)) else { return Vec::new() };
    let alike: Vec<&RegisteredPose> =
        found.iter().filter(|other| other.score <= tuning::FAR_WORSE * best.score).collect();
    let turns: Vec<f64> = alike.iter().map(|other| wrapped(other.turn - best.turn)).collect();
    let farthest = alike.iter().zip(&turns).max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    let (Some(order), Some((other, _))) = (common_order(&turns), farthest) else { return Vec::new() };
    // What takes one pose to the other turns the body about the centre of its symmetry, which is not that of what has been seen of it.
    let Some(step) = best.pose.try_inverse().map(|inverse| inverse * other.pose) else { return Vec::new() };
    let linear = step.fixed_view::<2, 2>(0, 0);
    let shift: Vector2<f64> = step.fixed_view::<2, 1>(0, 2).into_owned();
    let Some(centre) = (Matrix2::identity() - linear).try_inverse().map(|inverse| inverse * shift) else {
        return Vec::new();
    };
    let angle = TAU / order as f64;
    let multiples = (1..order).map(|multiple| angle * multiple as f64);
    let is_found = |by: f64| turns.iter().any(|turn| wrapped(turn - by).abs() < tuning::OFF_NEAR_SYMMETRY);
    let others = multiples.filter(|by| !is_found(*by));
    others.map(|by| best.pose * map_between(Rotation2::new(by).matrix(), &centre, &centre)).collect()
}

/// The number of parts of a circle that turns are all multiples of, nearest in parts; `None` where they are of none that is small enough to be told
/// from chance, and where there is none but no turn at all.
fn common_order(turns: &[f64]) -> Option<usize> {
    let turned = || turns.iter().filter(|turn| turn.abs() > tuning::OFF_NEAR_SYMMETRY);
    turned().next()?;
    let farthest_off = |order: usize| {
        let angle = TAU / order as f64;
        let off = turned().map(|turn| (turn - angle * (turn / angle).round()).abs());
        (order, off.fold(0.0, f64::max))
    };
    let fitting =
        (2..=tuning::LARGEST_NEAR_SYMMETRY).map(farthest_off).filter(|(_, off)| *off < tuning::OFF_NEAR_SYMMETRY);
    // Multiples of an order fit as well as it does.
    let in_parts = |(order, off): &(usize, f64)| off.max(tuning::KNOWN_NEAR_SYMMETRY) * *order as f64;
    fitting.min_by(|a, b| in_parts(a).total_cmp(&in_parts(b))).map(|(order, _)| order)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_that_are_multiples_of_a_part_of_a_circle_have_its_order() {
        let of = |order: usize, multiples: &[f64]| -> Vec<f64> {
            multiples.iter().map(|multiple| wrapped(TAU / order as f64 * multiple)).collect()
        };
        assert_eq!(common_order(&of(14, &[0.0, 1.0, 3.0, -4.0])), Some(14));
        assert_eq!(common_order(&of(2, &[0.0, 1.0])), Some(2));
        assert_eq!(common_order(&of(24, &[0.0, 5.0])), Some(24));
        assert_eq!(common_order(&of(24, &[0.0, 1.003, 4.995])), Some(24));
        // One turn of them that is no multiple of the others, and none but the best.
        assert_eq!(common_order(&[0.0, TAU / 5.0, TAU / 5.0 + 0.37, 1.0]), None);
        assert_eq!(common_order(&[0.0, 0.001]), None);
    }
}
