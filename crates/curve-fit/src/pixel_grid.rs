use nalgebra::{Point2, Vector2};

/// How the pixels of a picture lie in the image plane. Places in the picture are `[column, row]`, columns to the right and
/// rows downwards: pixel `[c, r]` reaches from there to `[c + 1, r + 1]`, and its centre is at `[c + 0.5, r + 0.5]`.
///
/// ```
/// use freeform_curve_fit::PixelGrid;
/// use nalgebra::{Point2, Vector2};
///
/// // A picture 100 pixels high, pixels of 0.5 x 0.5, y upwards from its lower left corner.
/// let grid = PixelGrid::new([0.0, 100.0], Point2::origin(), Vector2::new(0.5, -0.5));
/// assert_eq!(grid.to_plane(20.5, 99.5), Point2::new(10.25, 0.25));
/// assert_eq!(grid.to_pixels(&Point2::new(10.25, 0.25)), [20.5, 99.5]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PixelGrid {
    place: [f64; 2],
    point: Point2<f64>,
    pitch: Vector2<f64>,
}

impl PixelGrid {
    /// The grid whose `[column, row]` `place` lies at `point` of the plane. `pitch` says how much x grows from column to column
    /// and y from row to row, in units of the plane: its y is negative where y runs upwards. Both are to be finite and not 0.
    #[must_use]
    pub fn new(place: [f64; 2], point: Point2<f64>, pitch: Vector2<f64>) -> Self {
        Self { place, point, pitch }
    }

    /// From the picture to the plane.
    #[must_use]
    pub fn to_plane(&self, column: f64, row: f64) -> Point2<f64> {
        let x = self.point.x + self.pitch.x * (column - self.place[0]);
        Point2::new(x, self.point.y + self.pitch.y * (row - self.place[1]))
    }

    /// Width and height of a pixel, in units of the plane; positive.
    #[must_use]
    pub fn pixel_size(&self) -> Vector2<f64> {
        self.pitch.abs()
    }

    /// From the plane to `[column, row]` of the picture.
    #[must_use]
    pub fn to_pixels(&self, point: &Point2<f64>) -> [f64; 2] {
        [0, 1].map(|k| self.place[k] + (point[k] - self.point[k]) / self.pitch[k])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn places_go_to_the_plane_and_back(
            column in 0.0..2000.0_f64, row in 0.0..2000.0_f64, height in 1..2000_u32, size in 0.001..100.0_f64, aspect in 0.2..5.0_f64,
        ) {
            for pitch in [Vector2::new(size * aspect, -size), Vector2::new(size * aspect, size)] {
                let grid = PixelGrid::new([0.0, f64::from(height)], Point2::new(0.3, -7.0), pitch);
                let [c, r] = grid.to_pixels(&grid.to_plane(column, row));
                prop_assert!((c - column).abs() < 1e-6 && (r - row).abs() < 1e-6);
                prop_assert!(grid.to_plane(column + 1.0, row).x > grid.to_plane(column, row).x);
                let [right, lower] = grid.to_pixels(&(grid.to_plane(column, row) + grid.pixel_size()));
                prop_assert!((right - column - 1.0).abs() < 1e-6 && ((lower - row).abs() - 1.0).abs() < 1e-6);
                prop_assert_eq!(grid.to_plane(column, row + 1.0).y > grid.to_plane(column, row).y, pitch.y > 0.0);
            }
        }
    }
}
