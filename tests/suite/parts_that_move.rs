//! An outline of which a part does not move with the rest, through the tracker.
use crate::tracker::tracker;
use freeform_motion::{Warning, curve_fit::Outline, outline_io::OutlineFrame, tracker::Method};
use nalgebra::{Point2, Rotation2};

/// A stand with an arm that has swung by an angle, seen as one: 200 points, evenly spaced from another place on in every frame.
fn stand_with_arm(frame: u64, angle: f64) -> OutlineFrame {
    let arm = [(-0.15, 0.0), (-0.15, -1.2), (0.15, -1.2), (0.15, 0.0)].map(|(x, y)| Point2::new(x, y));
    let stand = [(1.0, 0.2), (1.0, 1.6), (-1.0, 1.6), (-1.0, 0.2)].map(|(x, y)| Point2::new(x, y));
    let corners: Vec<_> = stand.into_iter().chain(arm.map(|p| Rotation2::new(angle) * p)).collect();
    let sides: Vec<_> =
        (0..corners.len()).map(|i| (corners[i], corners[(i + 1) % corners.len()] - corners[i])).collect();
    let length: f64 = sides.iter().map(|(_, side)| side.norm()).sum();
    let at = |i: u64| {
        let mut along = (i as f64 + (0.618 * frame as f64).fract()) / 200.0 * length;
        let side = sides.iter().find(|(_, side)| {
            let is_here = along <= side.norm();
            along -= if is_here { 0.0 } else { side.norm() };
            is_here
        });
        let (from, side) = side.unwrap_or(&sides[0]);
        from + side * (along / side.norm()).min(1.0)
    };
    let outline = Outline::closed((0..200).map(at).collect()).expect("an outline");
    OutlineFrame { frame, time: frame as f64 / 30.0, object: "stand".to_owned(), outline }
}

/// The warnings of a stand that rests while its arm swings by so much.
fn warnings(amplitude: f64) -> Vec<Warning> {
    let mut tracker = tracker(Method::Filter);
    for frame in 0..40 {
        tracker.push(&stand_with_arm(frame, amplitude * (0.3 * frame as f64).sin()));
    }
    tracker.results()[0].warnings.clone()
}

#[test]
fn a_stand_that_is_seen_as_one_with_its_pendulum_is_told_to_have_a_part_that_moves_by_itself() {
    let found = warnings(1.2);
    let is_part =
        |warning: &Warning| matches!(warning, Warning::PartDisagrees { share } if (0.08..0.4).contains(share));
    assert!(found.iter().any(is_part), "{found:?}");
    let at_rest = warnings(0.0);
    assert!(!at_rest.iter().any(|warning| warning.code() == "part_disagrees"), "{at_rest:?}");
}
