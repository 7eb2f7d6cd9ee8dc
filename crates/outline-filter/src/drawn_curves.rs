//! Closed curves that unit tests draw about the origin, by the angle.
use freeform_curve_fit::Outline;
use nalgebra::{Point2, Rotation2};

/// A lobe that recurs so many times in a round, with the amplitudes of its cosine and its sine.
pub(crate) type Lobe = (f64, [f64; 2]);

/// Distance of a circle with lobes from the origin at an angle in rad, in radii of the circle.
pub(crate) fn lobed(angle: f64, lobes: &[Lobe]) -> f64 {
    lobes.iter().fold(1.0, |radius, (times, [cosine, sine])| {
        radius + cosine * (times * angle).cos() + sine * (times * angle).sin()
    })
}

/// The place at an angle in rad, so far from the origin.
pub(crate) fn polar(radius: f64, angle: f64) -> Point2<f64> {
    Point2::new(radius * angle.cos(), radius * angle.sin())
}

/// Points at so many evenly spaced angles in rad, from 0 on.
pub(crate) fn all_around(count: u32, point: impl FnMut(f64) -> Point2<f64>) -> Vec<Point2<f64>> {
    (0..count).map(|i| std::f64::consts::TAU * f64::from(i) / f64::from(count)).map(point).collect()
}

/// The outline through those.
pub(crate) fn outline(count: u32, point: impl FnMut(f64) -> Point2<f64>) -> Outline {
    Outline::closed(all_around(count, point)).expect("an outline")
}

/// Points on an outline, elsewhere on it from frame to frame, turned by 40 degrees in each.
pub(crate) fn turning(frame: u32, count: u32, radius: impl Fn(f64) -> f64) -> Outline {
    let turn = Rotation2::new(40.0_f64.to_radians() * f64::from(frame));
    let point = |i: u32| {
        let part = (0.618_034 * f64::from(frame)).fract();
        let t = std::f64::consts::TAU * (f64::from(i) + part) / f64::from(count);
        let noise = 0.004 * (12_345.678 * (f64::from(i) + 1.0) * (f64::from(frame) + 1.0).sqrt()).sin();
        turn * Point2::new(t.cos(), t.sin()) * (radius(t) + noise)
    };
    Outline::closed((0..count).map(point).collect()).expect("an outline")
}
