//! Points keep to their side of thin parts: a test of the normal-consistency check on a whole track.
use freeform_curve_fit::Outline;
use freeform_riccati::MotionModel;
use nalgebra::{Matrix3, Point2, Vector2};

use super::Track;
use crate::measurement::{Frame, Pass};

/// A strip of length 1 and thickness 0.04, anticlockwise; a tenth of its upper side is `dip` lower.
fn strip(dip: f64) -> Vec<Point2<f64>> {
    let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 0.04), (0.0, 0.04)].map(|(x, y)| Point2::new(x, y));
    let mut points = Vec::new();
    for (i, from) in corners.iter().enumerate() {
        let to = corners[(i + 1) % 4];
        let count = if i % 2 == 0 { 200 } else { 8 };
        points.extend((0..count).map(|k| from + (to - from) * f64::from(k) / f64::from(count)));
    }
    for p in points.iter_mut().filter(|p| p.y == 0.04 && (p.x - 0.45).abs() < 0.05) {
        *p -= Vector2::new(0.0, dip);
    }
    points
}

fn normals_of(points: Vec<Point2<f64>>) -> Vec<(Point2<f64>, Vector2<f64>)> {
    let outline = |points| Outline::closed(points).expect("an outline");
    let mut frame = Frame::default();
    let mut track = Track::begin(MotionModel::Rigid, &outline(strip(0.0)), 0.0, &mut frame).expect("a track");
    track.set_noise(0.05);
    frame.load(&outline(points.clone()), track.reference());
    let view = track.view();
    frame.clear_shifts(view.map.cells().len());
    view.measure(&mut frame, &Matrix3::identity(), &[], Pass::First);
    let normals = frame.measurements.iter().map(|m| view.map.cells()[m.cell].normal);
    points.into_iter().zip(normals).collect()
}

#[test]
fn points_nearer_to_the_other_side_of_a_thin_part_stay_on_their_own_whichever_way_the_contour_runs() {
    for reversed in [false, true] {
        let mut points = strip(0.03);
        if reversed {
            points.reverse();
        }
        let middle = |p: &Point2<f64>| (p.x - 0.45).abs() < 0.04;
        let found = normals_of(points);
        let dipped: Vec<_> = found.iter().filter(|(p, _)| middle(p) && (p.y - 0.01).abs() < 1e-9).collect();
        let lower: Vec<_> = found.iter().filter(|(p, _)| middle(p) && p.y == 0.0).collect();
        assert!(dipped.len() > 10 && lower.len() > 10);
        assert!(dipped.iter().all(|(_, n)| n.y > 0.9), "reversed {reversed}: {dipped:?}");
        assert!(lower.iter().all(|(_, n)| n.y < -0.9), "reversed {reversed}");
    }
}
