use nalgebra::Point2;

/// How far along the straight side from one point to another its place nearest to `p` lies: 0 at `from`, 1 at `to`, and 0 of a side without
/// length. Not a number where a coordinate is none.
///
/// ```
/// use freeform_curve_fit::share_along_side;
/// use nalgebra::Point2;
///
/// let (from, to) = (Point2::new(1.0, 0.0), Point2::new(5.0, 0.0));
/// assert_eq!(share_along_side(&from, &to, &Point2::new(2.0, 7.0)), 0.25);
/// assert_eq!(share_along_side(&from, &to, &Point2::new(9.0, 7.0)), 1.0);
/// assert_eq!(share_along_side(&from, &from, &Point2::new(9.0, 7.0)), 0.0);
/// ```
#[inline]
#[must_use]
pub fn share_along_side(from: &Point2<f64>, to: &Point2<f64>, p: &Point2<f64>) -> f64 {
    // Plain numbers: searches spend most of their time here, also where nothing is optimised.
    let (along_x, along_y) = (to.x - from.x, to.y - from.y);
    let squared_length = along_x * along_x + along_y * along_y;
    let projected = along_x * (p.x - from.x) + along_y * (p.y - from.y);
    if squared_length > 0.0 { (projected / squared_length).clamp(0.0, 1.0) } else { 0.0 }
}
