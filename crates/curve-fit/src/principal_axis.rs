use nalgebra::Matrix2;

/// The angle of the axis along which points or a region spread most, in rad, from -pi/2 to pi/2; its other end is as good.
///
/// `second_moments` are central and symmetric, of which the upper triangle is read, in any unit: sums over the points or means. 0 where they are the same in all directions.
///
/// ```
/// use freeform_curve_fit::principal_angle;
/// use nalgebra::{Matrix2, Rotation2};
///
/// let turn = Rotation2::new(0.7).into_inner();
/// let moments = turn * Matrix2::new(4.0, 0.0, 0.0, 1.0) * turn.transpose();
/// assert!((principal_angle(&moments) - 0.7).abs() < 1e-12);
/// assert_eq!(principal_angle(&Matrix2::identity()), 0.0);
/// ```
#[must_use]
pub fn principal_angle(second_moments: &Matrix2<f64>) -> f64 {
    let (xx, xy, yy) = (second_moments.m11, second_moments.m12, second_moments.m22);
    0.5 * (2.0 * xy).atan2(xx - yy)
}
