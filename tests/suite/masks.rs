//! What two-valued masks tell, whose outlines are rounded to pixels.
use freeform_motion::estimate::PointVelocity;
use freeform_motion::outline_filter::{FilterSettings, MotionFilter};
use freeform_motion::outline_io::{GrayImage, TraceSettings, trace_mask};
use nalgebra::Vector2;

const FRAMES: u32 = 24;

/// A filter that has followed masks of what is inside, 10 of them in a second.
fn followed(inside: impl Fn(f64, f64, f64) -> bool) -> MotionFilter {
    let settings = FilterSettings { mask_pixel: 1.0, ..FilterSettings::default() };
    let mut filter = MotionFilter::new(settings).expect("settings in their ranges");
    for frame in 0..FRAMES {
        let time = 0.1 * f64::from(frame);
        let mask = GrayImage::from_fn(160, 80, |column, row| {
            // As the outlines have it, y upwards.
            let (x, y) = (f64::from(column) + 0.5, 79.5 - f64::from(row));
            [if inside(time, x, y) { 255 } else { 0 }].into()
        });
        let traced = trace_mask(&mask, &TraceSettings::default()).expect("an object");
        filter.step(time, &traced.outline).expect("a good frame");
    }
    filter
}

fn is_right(velocity: &PointVelocity, truth: Vector2<f64>) -> bool {
    let errors = (velocity.velocity - truth).abs();
    velocity.standard_deviations().iter().zip(errors.iter()).all(|(deviation, error)| *error < 3.0 * deviation)
}

#[test]
fn a_disc_has_a_velocity_and_no_turn_though_its_pixels_do_not_turn() {
    for radius in [6.0, 9.0, 12.3, 15.0, 20.0, 30.0] {
        for speed in [20.0, 13.7, 3.0] {
            let filter = followed(|time, x, y| (x - 40.3 - speed * time).hypot(y - 40.1) < radius);
            let omega = filter.estimate().and_then(|estimate| estimate.parameters().next()?.value);
            assert_eq!(omega, None, "radius {radius}, {speed} pixels/s");
            let velocity = filter.velocity().unwrap_or_else(|| panic!("radius {radius}, {speed} pixels/s"));
            assert!(is_right(&velocity, Vector2::new(speed, 0.0)), "radius {radius}, {speed} pixels/s: {velocity:?}");
            assert!(velocity.standard_deviations().max() < 1.0, "radius {radius}, {speed} pixels/s: {velocity:?}");
        }
    }
}

#[test]
fn a_turn_of_less_than_a_pixel_is_not_taken_for_none() {
    // The ends of the bar move by two thirds of a pixel in all.
    let omega = 0.02;
    let filter = followed(|time, x, y| {
        let (sin, cos) = (omega * time).sin_cos();
        // Clockwise is positive.
        let (u, v) = ((x - 80.0) * cos - (y - 40.0) * sin, (x - 80.0) * sin + (y - 40.0) * cos);
        u.abs() < 28.4 && v.abs() < 12.2 && !(u > 10.0 && v > 3.0)
    });
    let estimate = filter.estimate().expect("a motion");
    let found = estimate.parameters().next().expect("omega");
    let (value, deviation) = (found.value.expect("observable"), found.standard_deviation.expect("by the filter"));
    assert!((value - omega).abs() < 2.0 * deviation && deviation > 0.002, "{value} +- {deviation}");
}
