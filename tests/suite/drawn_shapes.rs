//! The drawn shapes, which tables in docs/ are made with.
#[path = "../../examples/drawn_shapes.rs"]
#[expect(dead_code, reason = "the test writes no files")]
mod example;

use freeform_motion::curve_fit::{FitSettings, Fitter, Outline};
use freeform_motion::outline_filter::{FilterSettings, MotionFilter};
use freeform_motion::outline_io::{GrayImage, TraceSettings, TracedOutline, trace_objects};
use freeform_motion::riccati::{MotionModel, RigidMotion};
use freeform_motion::sim_camera::{
    BuiltInShape, Camera, Mask, Sampling, Scene, SequenceLength, Settings, Shape, Simulator,
};
use nalgebra::Point2;

/// The segments of a closed polygon.
fn segments(points: &[Point2<f64>]) -> Vec<(Point2<f64>, Point2<f64>)> {
    points.iter().copied().zip(points.iter().copied().cycle().skip(1)).collect()
}

fn assert_simple(name: &str, points: &[Point2<f64>]) {
    let side = |p: Point2<f64>, q: Point2<f64>, r: Point2<f64>| (q - p).perp(&(r - p));
    let segments = segments(points);
    for (i, (a, b)) in segments.iter().copied().enumerate() {
        for (c, d) in segments.iter().copied().skip(i + 2) {
            let crosses = side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0;
            assert!(!crosses, "{name}: {a} to {b} crosses {c} to {d}");
        }
    }
}

/// All outlines traced in a mask.
fn traced(mask: &Mask) -> Vec<TracedOutline> {
    let (width, height) = (mask.width as u32, mask.height as u32);
    let picture = GrayImage::from_raw(width, height, mask.grey.clone()).expect("as many values as pixels");
    trace_objects(&picture, &TraceSettings::default(), usize::MAX).expect("an object")
}

fn area(points: &[Point2<f64>]) -> f64 {
    0.5 * segments(points).iter().map(|(p, q)| p.coords.perp(&q.coords)).sum::<f64>()
}

#[test]
fn every_drawn_shape_is_a_simple_closed_curve_with_a_name_of_its_own() {
    let shapes = example::drawn_shapes();
    for (index, (name, points)) in shapes.iter().enumerate() {
        assert_simple(name, points);
        let built_in = BuiltInShape::ALL.map(BuiltInShape::name);
        let others = shapes[..index].iter().map(|(other, _)| *other);
        assert!(!others.chain(built_in).any(|other| other == *name), "{name}");
    }
}

#[test]
fn forty_points_of_a_bat_are_hardly_ever_taken_for_it_turned_by_half_a_circle() {
    let drawn = example::drawn_shapes().into_iter().find(|(name, _)| *name == "bat").expect("it is one of them");
    let shape = Shape::from_polygon(&drawn.1).expect("a shape").normalised();
    let motion = RigidMotion { omega: std::f64::consts::FRAC_PI_2, b1: -0.3, b2: 0.4 };
    let mut turned = Vec::new();
    for seed in 0..100 {
        let (length, sampling) = (SequenceLength::Frames(8), Sampling::Independent);
        let settings = Settings { length, sampling, points: 40, noise: 0.005, seed, ..Settings::default() };
        let scene = Scene::new(shape.clone(), motion, Camera::default());
        let mut filter = MotionFilter::new(FilterSettings::default()).expect("good settings");
        for frame in Simulator::new(scene, settings).expect("good settings").frames() {
            filter.step(frame.time, &frame.outline).expect("increasing times");
            let step = MotionModel::Rigid.flow(&[motion.omega, motion.b1, motion.b2], frame.time).inverse()
                * filter.pose().expect("a pose");
            let off = step.matrix()[(1, 0)].atan2(step.matrix()[(0, 0)]);
            if off.abs() > std::f64::consts::FRAC_PI_2 && !turned.contains(&seed) {
                turned.push(seed);
            }
        }
    }
    assert!(turned.len() <= 1, "{turned:?}");
}

#[test]
fn the_mask_of_a_drawn_shape_is_traced_as_one_closed_outline_of_the_shape_with_a_bounded_fit() {
    for (name, points) in example::drawn_shapes() {
        let mask = example::mask(&points).expect("a mask");
        assert!(mask.grey.iter().all(|grey| [0, 255].contains(grey)), "{name}");
        let found = traced(&mask);
        assert_eq!(found.len(), 1, "{name}");
        let outline = &found[0].outline;
        assert!(matches!(outline, Outline::Closed(_)) && !found[0].touches_border, "{name}");
        assert_eq!(outline.pieces().count(), 1, "{name}");
        let seen: Vec<Point2<f64>> = outline.points().copied().collect();
        assert_simple(name, &seen);
        // The longer side of the shape has 480 pixels.
        let extent = |points: &[Point2<f64>], axis: usize| {
            let values = points.iter().map(|p| p[axis]);
            values.clone().fold(f64::MIN, f64::max) - values.fold(f64::MAX, f64::min)
        };
        let pixels = 480.0 / extent(&points, 0).max(extent(&points, 1));
        let ratio = outline.signed_area() / (pixels * pixels * area(&points).abs());
        assert!((ratio - 1.0).abs() < 0.01, "{name}: area {ratio}");
        let fit = Fitter::new(FitSettings::default()).expect("settings").fit(outline).expect("a fit");
        assert!(fit.is_bounded(), "{name}");
    }
}
