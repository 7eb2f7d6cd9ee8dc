//! Points and normals under a map of the plane.
use nalgebra::{Matrix3, Point2, RowVector3, Vector2};

/// Image of a point under a map of the plane, given as a 3x3 matrix on homogeneous coordinates.
#[inline]
#[must_use]
pub fn map_point(map: &Matrix3<f64>, p: &Point2<f64>) -> Point2<f64> {
    map_point_by::<false>(map, p)
}

/// Whether the last row of a map is (0, 0, 1), so that AFFINE may be true of it: it then needs no divisions, which are most of the work.
#[inline]
#[must_use]
pub fn is_affine(map: &Matrix3<f64>) -> bool {
    map.row(2) == RowVector3::new(0.0, 0.0, 1.0)
}

/// Image of a point under a map of the plane, an affine one if AFFINE.
#[inline(always)]
#[must_use]
pub fn map_point_by<const AFFINE: bool>(map: &Matrix3<f64>, p: &Point2<f64>) -> Point2<f64> {
    let image = |row: usize| map[(row, 0)] * p.x + map[(row, 1)] * p.y + map[(row, 2)];
    if AFFINE { Point2::new(image(0), image(1)) } else { Point2::new(image(0) / image(2), image(1) / image(2)) }
}

/// `n' D` with D the derivative of a map of the plane at `p`, whose image there is `image`: how fast the distance along
/// n from the image grows as p moves.
#[inline]
#[must_use]
pub fn pull_back(map: &Matrix3<f64>, p: &Point2<f64>, image: &Point2<f64>, n: &Vector2<f64>) -> Vector2<f64> {
    pull_back_by::<false>(map, p, image, n)
}

/// As [`pull_back`], without divisions if AFFINE, which then must be [true of the map](is_affine).
#[inline(always)]
#[must_use]
pub fn pull_back_by<const AFFINE: bool>(
    map: &Matrix3<f64>,
    p: &Point2<f64>,
    image: &Point2<f64>,
    n: &Vector2<f64>,
) -> Vector2<f64> {
    let linear = |c: usize| n.x * map[(0, c)] + n.y * map[(1, c)];
    if AFFINE {
        return Vector2::new(linear(0), linear(1));
    }
    let w = map[(2, 0)] * p.x + map[(2, 1)] * p.y + map[(2, 2)];
    let along = n.x * image.x + n.y * image.y;
    Vector2::new((linear(0) - along * map[(2, 0)]) / w, (linear(1) - along * map[(2, 1)]) / w)
}
