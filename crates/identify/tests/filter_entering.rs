//! Objects that come into view from behind an edge: what is seen of them first may hide their turn or their slide.
mod filter_support;

use filter_support::{filter, settings};
use freeform_curve_fit::{OpenArc, OpenOutline, Outline};
use freeform_identify::MotionFilter;
use freeform_riccati::{MotionModel, RigidMotion};
use freeform_sim_camera::{BuiltInShape, Camera, Frame, Scene, Settings, Shape, Simulator};
use nalgebra::Point2;

/// What of an outline lies left of `edge`.
fn left_of(edge: f64, outline: &Outline) -> Option<Outline> {
    let points: Vec<Point2<f64>> = outline.points().copied().collect();
    let is_seen = |i: usize| points[i % points.len()].x < edge;
    if (0..points.len()).all(is_seen) {
        return Some(outline.clone());
    }
    let start = (0..points.len()).find(|i| is_seen(i + 1) && !is_seen(*i))?;
    let order: Vec<usize> = (start + 1..=start + points.len()).collect();
    let runs = order.chunk_by(|i, j| is_seen(*i) == is_seen(*j)).filter(|run| is_seen(run[0]) && run.len() > 5);
    let arc = |run: &[usize]| OpenArc::new(run.iter().map(|i| points[i % points.len()]).collect()).expect("an arc");
    Some(Outline::Open(OpenOutline::new(runs.map(arc).collect()).ok()?))
}

/// A filter that has seen a shape come out from behind an edge that moves to the right.
fn entered(shape: impl Into<Shape>, motion: RigidMotion, settings: Settings, from: f64) -> MotionFilter {
    let simulator = Simulator::new(Scene::new(shape, motion, Camera::default()), settings).expect("good settings");
    let mut filter = filter(MotionModel::Rigid);
    for Frame { time, outline, .. } in simulator.frames() {
        if let Some(seen) = left_of(from + 1.2 * time, &outline).filter(|seen| seen.point_count() >= 8) {
            filter.step(time, &seen).expect("increasing times");
        }
    }
    filter
}

fn assert_right(run: &MotionFilter, motion: RigidMotion, context: &str) {
    let estimate = run.estimate().expect("an estimate");
    for (parameter, truth) in estimate.parameters().zip([motion.omega, motion.b1, motion.b2]) {
        let (value, std) = (parameter.value.expect("known"), parameter.standard_deviation.expect("known"));
        assert!((value - truth).abs() < 6.0 * std && std < 0.1, "{context}: {value} {truth} {std}");
    }
}

const MOTIONS: [RigidMotion; 4] = [
    RigidMotion { omega: 0.0, b1: 0.0, b2: 0.0 },
    RigidMotion { omega: 0.6, b1: 0.0, b2: 0.0 },
    RigidMotion { omega: 2.0, b1: -0.3, b2: 0.2 },
    RigidMotion { omega: 2.0, b1: 0.0, b2: 0.0 },
];

#[test]
fn a_disc_of_which_a_bump_is_seen_last_tells_its_turn_then() {
    let rim = (0..720).map(|i| {
        let angle = std::f64::consts::TAU * f64::from(i) / 720.0;
        let off = (angle + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
        let radius = 0.5 * (1.0 + 0.35 * (-0.5 * (off / 0.25).powi(2)).exp());
        Point2::new(radius * angle.cos(), radius * angle.sin())
    });
    let disc = Shape::from_polygon(&rim.collect::<Vec<_>>()).expect("a shape");
    for motion in MOTIONS {
        for (seed, noise) in (0..4).zip([0.0005, 0.005].into_iter().cycle()) {
            let run = entered(disc.clone(), motion, Settings { noise, ..settings(30, seed) }, -0.1);
            assert_right(&run, motion, &format!("{motion:?} {noise}, seed {seed}"));
        }
    }
}

#[test]
fn a_square_of_which_one_side_is_seen_first_tells_its_slide_with_the_others() {
    for motion in MOTIONS {
        for (seed, noise) in (0..4).zip([0.0005, 0.005].into_iter().cycle()) {
            let run = entered(BuiltInShape::Square, motion, Settings { noise, ..settings(36, seed) }, -0.3);
            assert_right(&run, motion, &format!("{motion:?} {noise}, seed {seed}"));
        }
    }
}
