//! Turns by which an outline nearly looks the same, as a gear does but for a mark.
use std::f64::consts::TAU;

use freeform_riccati::MotionModel;
use nalgebra::{Matrix2, Matrix3, Rotation2, Vector2};

use super::refinement::RegisteredPose;
use crate::{map::map_between, track::wrapped, tuning::registration as tuning};

/// Further poses to start from, where those that were found explain the frame nearly alike and are multiples of a part of a circle apart about one
/// point: the best of them, turned by all other multiples about it. None where that is not so, and where a pose may stretch the outline: that is no
/// turn of the body then.
pub(super) fn turns_of_near_symmetry(model: MotionModel, found: &[RegisteredPose]) -> Vec<Matrix3<f64>> {
    let Some(best) = found.iter().min_by(|a, b| a.score.total_cmp(&b.score)) else { return Vec::new() };
    let Some(inverse) = best.pose.try_inverse().filter(|_| model <= MotionModel::Similarity) else { return Vec::new() };
    let alike = found.iter().filter(|other| other.score <= tuning::NEARLY_ALIKE * best.score);
    let turned = alike.map(|other| (other, wrapped(other.turn - best.turn)));
    let turned: Vec<_> = turned.filter(|(_, turn)| turn.abs() > tuning::OFF_NEAR_SYMMETRY).collect();
    let turns: Vec<f64> = turned.iter().map(|(_, turn)| *turn).collect();
    // What takes one pose to the other turns the body about the centre of its symmetry, which is not that of what has been seen of it.
    let centres: Option<Vec<_>> = turned.iter().map(|(other, _)| centre_of(&(inverse * other.pose))).collect();
    let (Some(order), Some(centres)) = (common_order(&turns), centres) else { return Vec::new() };
    let centre = centres.iter().sum::<Vector2<f64>>() / centres.len() as f64;
    if centres.iter().any(|other| (other - centre).norm() > tuning::OFF_CENTRE) {
        return Vec::new();
    }
    let multiples = (1..order).map(|multiple| TAU / order as f64 * multiple as f64);
    let is_found = |by: f64| turns.iter().any(|turn| wrapped(turn - by).abs() < tuning::OFF_NEAR_SYMMETRY);
    let others = multiples.filter(|by| !is_found(*by));
    others.map(|by| best.pose * map_between(Rotation2::new(by).matrix(), &centre, &centre)).collect()
}

/// The point that a rigid map leaves where it is; `None` where it is no turn.
pub(super) fn centre_of(step: &Matrix3<f64>) -> Option<Vector2<f64>> {
    let linear = step.fixed_view::<2, 2>(0, 0);
    Some((Matrix2::identity() - linear).try_inverse()? * step.fixed_view::<2, 1>(0, 2))
}

/// The number of parts of a circle that turns are all multiples of, nearest in parts; `None` where there are no turns, or they are of none. One turn
/// alone is a multiple of one of many parts by chance, so that only few parts are looked for then.
fn common_order(turns: &[f64]) -> Option<usize> {
    let largest = match turns.len() {
        0 => return None,
        1 => tuning::LARGEST_BY_ONE_TURN,
        _ => tuning::LARGEST_NEAR_SYMMETRY,
    };
    let farthest_off = |order: usize| {
        let angle = TAU / order as f64;
        let off = turns.iter().map(|turn| (turn - angle * (turn / angle).round()).abs());
        (order, off.fold(0.0, f64::max))
    };
    let fitting = (2..=largest).map(farthest_off).filter(|(_, off)| *off < tuning::OFF_NEAR_SYMMETRY);
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
        assert_eq!(common_order(&of(14, &[1.0, 3.0, -4.0])), Some(14));
        assert_eq!(common_order(&of(2, &[1.0])), Some(2));
        assert_eq!(common_order(&of(24, &[1.003, 4.995])), Some(24));
        // One turn that may be of any of many parts, one that is no multiple of the others, and none.
        assert_eq!(common_order(&of(24, &[5.0])), None);
        assert_eq!(common_order(&[TAU / 5.0, TAU / 5.0 + 0.37, 1.0]), None);
        assert_eq!(common_order(&[]), None);
    }

    /// Poses of a body with a centre of symmetry aside, that has turned by these angles, are equally good.
    fn turned_about(centres: &[[f64; 2]], angles: &[f64]) -> Vec<RegisteredPose> {
        let pose = Matrix3::new(0.8, -0.6, 0.3, 0.6, 0.8, -0.2, 0.0, 0.0, 1.0);
        let of = |(centre, angle): (&[f64; 2], &f64)| {
            let centre = Vector2::from(*centre);
            let pose = pose * map_between(Rotation2::new(*angle).matrix(), &centre, &centre);
            RegisteredPose { pose, score: 0.01, spread: 0.01, turn: wrapped(0.4 + angle) }
        };
        centres.iter().zip(angles).map(of).collect()
    }

    #[test]
    fn poses_of_some_teeth_lead_to_those_of_all_others_about_the_same_centre() {
        let (centre, tooth) = ([0.2, -0.3], TAU / 9.0);
        let found = turned_about(&[centre; 3], &[0.0, 2.0 * tooth, -3.0 * tooth]);
        let others = turns_of_near_symmetry(MotionModel::Rigid, &found);
        assert_eq!(others.len(), 6);
        for (pose, multiple) in others.iter().zip([1.0, 3.0, 4.0, 5.0, 7.0, 8.0]) {
            let expected = turned_about(&[centre], &[multiple * tooth])[0].pose;
            assert!((pose - expected).norm() < 1e-12, "{multiple}: {pose} {expected}");
        }
        assert!(turns_of_near_symmetry(MotionModel::Affine, &found).is_empty());
        let elsewhere = turned_about(&[centre, centre, [0.6, 0.0]], &[0.0, 2.0 * tooth, -3.0 * tooth]);
        assert!(turns_of_near_symmetry(MotionModel::Rigid, &elsewhere).is_empty());
    }
}
