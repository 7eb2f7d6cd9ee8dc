//! The outline that a filter knows, in its order.
use crate::filter_support::{filter, filtered, frames_of, settings};
use freeform_riccati::{MotionModel, RigidMotion};
use freeform_sim_camera::{BuiltInShape, Occlusion, Shape};
use nalgebra::Point2;

const RIGID: RigidMotion = RigidMotion { omega: std::f64::consts::FRAC_PI_2, b1: -0.3, b2: 0.4 };

#[test]
fn the_known_outline_runs_along_the_body_and_its_pose_takes_it_to_its_present_place() {
    let frames = frames_of(BuiltInShape::Bird, RIGID, settings(40, 7));
    let filter = filtered(MotionModel::Rigid, &frames);
    let known = filter.known_outline().expect("an outline");
    let [piece] = &known.pieces[..] else { panic!("{} pieces", known.pieces.len()) };
    assert!(piece.closed);
    // As the points that have no order: every one of them, and no other.
    let mut placed: Vec<Point2<f64>> = piece.points.iter().map(|p| known.pose * p).collect();
    let mut present: Vec<Point2<f64>> = filter.outline_points().collect();
    let by_place = |a: &Point2<f64>, b: &Point2<f64>| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y));
    placed.sort_by(by_place);
    present.sort_by(by_place);
    assert_eq!(placed.len(), present.len());
    assert!(placed.iter().zip(&present).all(|(a, b)| (a - b).norm() < 1e-9));
    // Where the body was at first, and once round it.
    let shape = Shape::from(BuiltInShape::Bird);
    let body: Vec<_> = (0..2000).map(|i| shape.point_at(f64::from(i) / 2000.0)).collect();
    let distance = |p: &Point2<f64>| body.iter().map(|q| (p - q).norm()).fold(f64::INFINITY, f64::min);
    assert!(piece.points.iter().all(|p| distance(p) < 0.01));
    let around = piece.points.iter().chain(piece.points.first());
    let steps: Vec<f64> = around.clone().zip(around.skip(1)).map(|(a, b)| (b - a).norm()).collect();
    let length: f64 = steps.iter().sum();
    assert!((length / shape.perimeter() - 1.0).abs() < 0.05, "{length}");
    assert!(steps.iter().all(|step| *step < 3.0 * length / steps.len() as f64));
}

#[test]
fn before_the_first_frame_no_outline_is_known_and_of_a_hidden_arc_none_is() {
    assert!(filter(MotionModel::Rigid).known_outline().is_none());
    let mut settings = settings(1, 7);
    settings.occlusion = Occlusion { fraction: 0.3, ..Occlusion::default() };
    let frames = frames_of(BuiltInShape::Bird, RIGID, settings);
    let known = filtered(MotionModel::Rigid, &frames).known_outline().expect("an outline");
    assert!(known.pieces.iter().all(|piece| !piece.closed));
}
