//! The drawn shapes, which tables in docs/ are made with.
#[path = "../../examples/drawn_shapes.rs"]
#[expect(dead_code, reason = "the test writes no files")]
mod example;

use freeform_motion::curve_fit::{FitSettings, Fitter, Outline};
use freeform_motion::outline_io::{GrayImage, TraceSettings, TracedOutline, trace_objects};
use freeform_motion::sim_camera::{BuiltInShape, Mask};
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
