use nalgebra::{Affine2, Matrix2, Matrix3, Point2, Vector2};

use crate::outline::ClosedOutline;

/// Below this fraction of the triangles that it was summed from an area is rounding.
const NO_AREA: f64 = 1e-9;

/// Area, centroid and second central moments of the region that a closed polygon encloses.
///
/// They are exactly covariant: an affine map of the polygon moves them as it moves the region, however its points are spread.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AreaMoments {
    /// Area, positive, in squared units of the outline.
    pub area: f64,
    /// Centroid of the area.
    pub centroid: Point2<f64>,
    /// Mean of `(p - centroid) (p - centroid)'` over the area, in squared units of the outline: positive definite.
    pub covariance: Matrix2<f64>,
}

impl AreaMoments {
    /// The moments of a polygon, by Green's theorem. `None` where it encloses as much area one way round as the other, or crosses
    /// itself so that its moments are not those of a region.
    #[must_use]
    pub fn of(outline: &ClosedOutline) -> Option<Self> {
        let points = outline.points();
        // Relative to the mean, so that a large offset does not cancel the moments away.
        let count = points.len() as f64;
        let origin = Point2::from(points.iter().map(|p| p.coords / count).sum::<Vector2<f64>>());
        let (mut area, mut absolute, mut first, mut second) = (0.0, 0.0, Vector2::zeros(), Matrix2::zeros());
        for (p, q) in points.iter().zip(points.iter().cycle().skip(1)) {
            let (p, q) = (p - origin, q - origin);
            let (triangle, sum) = (0.5 * p.perp(&q), p + q);
            area += triangle;
            absolute += triangle.abs();
            first += triangle / 3.0 * sum;
            second += triangle / 12.0 * (p * p.transpose() + q * q.transpose() + sum * sum.transpose());
        }
        if area.abs() <= NO_AREA * absolute {
            return None;
        }
        let mean = first / area;
        let covariance = second / area - mean * mean.transpose();
        let definite = covariance[(0, 0)] > 0.0 && covariance.determinant() > 0.0;
        (definite && covariance.iter().all(|c| c.is_finite())).then(|| Self {
            area: area.abs(),
            centroid: origin + mean,
            covariance,
        })
    }

    /// The symmetric affine map from coordinates in which the region has the inertia of the unit disc about the origin (the second
    /// moments are 1/4 in every direction) to those of the outline.
    ///
    /// A region moved by an affine map has the same region there but for a turn or a reflection.
    #[must_use]
    pub fn image_from_inertia_circle(&self) -> Affine2<f64> {
        let linear = 2.0 * square_root(&self.covariance);
        let matrix = Matrix3::new(
            linear.m11,
            linear.m12,
            self.centroid.x,
            linear.m21,
            linear.m22,
            self.centroid.y,
            0.0,
            0.0,
            1.0,
        );
        Affine2::from_matrix_unchecked(matrix)
    }
}

/// The symmetric positive definite square root: `(C + sqrt(det C) I) / sqrt(tr C + 2 sqrt(det C))`.
fn square_root(c: &Matrix2<f64>) -> Matrix2<f64> {
    let root = c.determinant().sqrt();
    (c + Matrix2::identity() * root) / (c.trace() + 2.0 * root).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polygon(list: &[(f64, f64)]) -> ClosedOutline {
        ClosedOutline::new(list.iter().map(|&(x, y)| Point2::new(x, y)).collect()).expect("a polygon")
    }

    #[test]
    fn the_moments_of_a_rectangle_are_the_textbook_ones_either_way_round() {
        let corners = [(10.0, 3.0), (16.0, 3.0), (16.0, 5.0), (10.0, 5.0)];
        let mut reversed = corners;
        reversed.reverse();
        for corners in [corners, reversed] {
            let moments = AreaMoments::of(&polygon(&corners)).expect("an area");
            assert!((moments.area - 12.0).abs() < 1e-12);
            assert!((moments.centroid - Point2::new(13.0, 4.0)).norm() < 1e-12);
            assert!((moments.covariance - Matrix2::new(3.0, 0.0, 0.0, 1.0 / 3.0)).norm() < 1e-12);
        }
    }

    #[test]
    fn the_map_to_the_circle_of_inertia_makes_the_moments_those_of_a_disc() {
        let outline = polygon(&[(0.0, 0.0), (5.0, 1.0), (7.0, 4.0), (2.0, 3.0), (1.0, 6.0)]);
        let map = AreaMoments::of(&outline).expect("an area").image_from_inertia_circle();
        let there = outline.points().iter().map(|p| map.inverse() * p).collect();
        let moments = AreaMoments::of(&ClosedOutline::new(there).expect("a polygon")).expect("an area");
        assert!(moments.centroid.coords.norm() < 1e-13);
        assert!((moments.covariance - Matrix2::identity() / 4.0).norm() < 1e-13);
    }

    #[test]
    fn a_polygon_that_encloses_nothing_has_no_moments() {
        let eight = polygon(&[(0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 2.0)]);
        assert_eq!(AreaMoments::of(&eight), None);
    }
}
