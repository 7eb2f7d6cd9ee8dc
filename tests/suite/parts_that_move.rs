//! An outline of which a part does not move with the rest, through the tracker.
use crate::tracker::tracker;
use freeform_motion::{Warning, curve_fit::Outline, outline_io::OutlineFrame, sim_camera::Shape, tracker::Method};
use nalgebra::{Point2, Rotation2};

/// A stand with an arm that has swung by an angle, seen as one: 200 points, evenly spaced from another place on in every frame.
fn stand_with_arm(frame: u64, angle: f64) -> OutlineFrame {
    let arm = [(-0.15, 0.0), (-0.15, -1.2), (0.15, -1.2), (0.15, 0.0)].map(|(x, y)| Point2::new(x, y));
    let stand = [(1.0, 0.2), (1.0, 1.6), (-1.0, 1.6), (-1.0, 0.2)].map(|(x, y)| Point2::new(x, y));
    let corners: Vec<_> = stand.into_iter().chain(arm.map(|p| Rotation2::new(angle) * p)).collect();
    let points = Shape::from_polygon(&corners).expect("a polygon").sample(200, (0.618 * frame as f64).fract());
    let outline = Outline::closed(points).expect("an outline");
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
