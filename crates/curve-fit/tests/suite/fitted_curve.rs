//! The curve of a fit as lines, and its parts beside the outline.
use std::f64::consts::TAU;

use freeform_curve_fit::{Degree, Fit, FitSettings, Fitter, Outline, Rectangle, stray_parts};
use nalgebra::Point2;

fn fitted(degree: Degree, outline: &Outline) -> Fit {
    let mut fitter = Fitter::new(FitSettings { degree, ..FitSettings::default() }).expect("settings");
    fitter.fit(outline).expect("a curve")
}

fn ellipse() -> Outline {
    let angle = |i: i32| TAU * f64::from(i) / 200.0;
    let points = (0..200).map(|i| Point2::new(5.0 + 2.0 * angle(i).cos(), angle(i).sin())).collect();
    Outline::closed(points).expect("an ellipse")
}

#[test]
fn the_curve_of_an_ellipse_is_one_closed_line_on_its_zero_set() {
    let fit = fitted(Degree::Conic, &ellipse());
    let curve = fit.curve_within(&Rectangle { low: Point2::new(2.0, -2.0), high: Point2::new(8.0, 2.0) });
    assert_eq!(curve.len(), 1);
    assert_eq!(curve[0].first(), curve[0].last());
    assert!(curve[0].len() > 200);
    for p in &curve[0] {
        let value = fit.working().evaluate(&fit.normalisation().to_working(p));
        assert!(value.abs() < 1e-5, "{p}: {value}");
    }
}

#[test]
fn a_part_is_stray_where_no_point_of_the_outline_is_nearest_to_it() {
    let outline = ellipse();
    let circle = |x: f64, radius: f64| -> Vec<Point2<f64>> {
        let angle = |i: i32| TAU * f64::from(i) / 20.0;
        (0..=20).map(|i| Point2::new(x + radius * angle(i).cos(), radius * angle(i).sin())).collect()
    };
    // Round the left end, inside without touching, round the right end, far away.
    let parts = [circle(3.2, 0.4), circle(5.0, 0.05), circle(6.8, 0.4), circle(20.0, 1.0)];
    assert_eq!(stray_parts(&parts, &outline), [false, false, false, true]);
    assert_eq!(stray_parts(&parts[..1], &outline), [false]);
    assert!(stray_parts(&[], &outline).is_empty());
    assert!(fitted(Degree::Conic, &outline).stray_places(&outline).is_empty());
}
