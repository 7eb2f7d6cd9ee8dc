use nalgebra::{Affine2, Matrix3, Translation2};

/// Numbers beyond this are no coordinates: their squares are none.
const LARGEST: f64 = 1e100;

/// Determinant of a map with columns of length 1 below which it has no inverse but by rounding.
const SINGULAR: f64 = 1e-15;

/// Whether a map of the plane, on homogeneous coordinates, is finite and has an inverse. Coordinates of pictures are of any size and as far away
/// as those of maps of countries: with rows and then columns of one length each the determinant tells of the map alone.
pub(crate) fn is_regular(map: &Matrix3<f64>) -> bool {
    let mut scaled = *map;
    scaled.row_iter_mut().for_each(|mut row| row /= row.norm());
    scaled.column_iter_mut().for_each(|mut column| column /= column.norm());
    // What is not finite, or has a row of zeros, has no determinant.
    scaled.determinant().abs() > SINGULAR
}

/// Whether coordinates can be worked with: those that a map takes to the image, and those that a shift takes to others of them.
pub(crate) fn are_coordinates(to_image: &Affine2<f64>, shift: &Translation2<f64>) -> bool {
    let is_affine = to_image.matrix().row(2).iter().eq(&[0.0, 0.0, 1.0]);
    let numbers = to_image.matrix().iter().chain(shift.vector.iter());
    is_affine && is_regular(to_image.matrix()) && { numbers }.all(|number| number.abs() < LARGEST)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_to_far_places_are_regular_and_those_to_lines_or_nowhere_are_not() {
        let far = Matrix3::new(0.03, 0.0, 5e5, 0.0, 0.03, 5e6, 0.0, 0.0, 1.0);
        assert!(is_regular(&far) && is_regular(&(1e30 * far)) && is_regular(&Matrix3::identity()));
        let to_a_line = Matrix3::new(1.0, 2.0, 3.0, 2.0, 4.0, 6.0, 0.0, 0.0, 1.0);
        for map in [to_a_line, far * to_a_line, Matrix3::zeros(), Matrix3::repeat(f64::NAN), f64::INFINITY * far] {
            assert!(!is_regular(&map), "{map}");
        }
    }
}
