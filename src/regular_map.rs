use nalgebra::Matrix3;

/// Determinant of a map over the product of the lengths of its rows below which it has no inverse but by rounding.
const SINGULAR: f64 = 1e-15;

/// Whether a map of the plane, on homogeneous coordinates, is finite and has an inverse. Coordinates of pictures are of any size: with rows of
/// one size each the determinant tells of the map alone.
pub(crate) fn is_regular(map: &Matrix3<f64>) -> bool {
    let lengths = map.row_iter().map(|row| row.norm()).product::<f64>();
    map.iter().all(|entry| entry.is_finite()) && map.determinant().abs() > SINGULAR * lengths
}
