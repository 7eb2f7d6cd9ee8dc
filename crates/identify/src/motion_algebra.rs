//! Generators of a motion model as coordinate vectors: their velocity fields, and how they change with the frame.
use freeform_riccati::MotionModel;
use nalgebra::{Matrix3, Point2, RowVector3, Vector2};

use crate::estimate::MAX_PARAMETERS;

/// One value per parameter of a model, zeros behind.
pub(crate) type Coordinates = [f64; MAX_PARAMETERS];

/// Square matrix over the parameters of a model, zeros behind; `m[row][column]`.
pub(crate) type CoordinateMatrix = [[f64; MAX_PARAMETERS]; MAX_PARAMETERS];

/// Angular velocity omega of a generator, clockwise where y points up.
pub(crate) fn turn_rate(generator: &Matrix3<f64>) -> f64 {
    0.5 * (generator[(0, 1)] - generator[(1, 0)])
}

/// Coordinates of a generator in the basis of the model. A multiple of the identity, which moves nothing, is taken off
/// first; what lies outside the model is dropped.
pub(crate) fn coordinates(model: MotionModel, generator: &Matrix3<f64>) -> Coordinates {
    let g = generator - Matrix3::identity() * generator[(2, 2)];
    let (b1, b2) = (g[(0, 2)], g[(1, 2)]);
    let sigma = 0.5 * (g[(0, 0)] + g[(1, 1)]);
    let omega = turn_rate(&g);
    let full = [g[(0, 0)], g[(0, 1)], g[(1, 0)], g[(1, 1)], b1, b2, g[(2, 0)], g[(2, 1)]];
    let mut result = [0.0; MAX_PARAMETERS];
    match model {
        MotionModel::Rigid => result[..3].copy_from_slice(&[omega, b1, b2]),
        MotionModel::Similarity => result[..4].copy_from_slice(&[sigma, omega, b1, b2]),
        MotionModel::Affine => result[..6].copy_from_slice(&full[..6]),
        MotionModel::Projective => result = full,
    }
    result
}

/// Normal component of the velocity that each basis generator gives a point: entry j is `normal . (E_j p)`.
pub(crate) fn normal_velocities(model: MotionModel, p: &Point2<f64>, normal: &Vector2<f64>) -> Coordinates {
    let (x, y, u, v) = (p.x, p.y, normal.x, normal.y);
    match model {
        MotionModel::Rigid => [u * y - v * x, u, v, 0.0, 0.0, 0.0, 0.0, 0.0],
        MotionModel::Similarity => [u * x + v * y, u * y - v * x, u, v, 0.0, 0.0, 0.0, 0.0],
        MotionModel::Affine => [u * x, u * y, v * x, v * y, u, v, 0.0, 0.0],
        MotionModel::Projective => {
            let along = -(u * x + v * y);
            [u * x, u * y, v * x, v * y, u, v, along * x, along * y]
        }
    }
}

/// Matrix of `E -> T E T^-1` on coordinates, for a map T of the model's own group or a similarity.
pub(crate) fn adjoint(model: MotionModel, map: &Matrix3<f64>, inverse: &Matrix3<f64>) -> CoordinateMatrix {
    columns(model, model.basis().iter().map(|e| map * e * inverse))
}

/// Matrix whose columns are the coordinates of the given generators.
pub(crate) fn columns(model: MotionModel, generators: impl Iterator<Item = Matrix3<f64>>) -> CoordinateMatrix {
    let mut result = [[0.0; MAX_PARAMETERS]; MAX_PARAMETERS];
    for (column, generator) in generators.take(model.parameter_count()).enumerate() {
        for (row, value) in coordinates(model, &generator).into_iter().enumerate() {
            result[row][column] = value;
        }
    }
    result
}

/// Image of a point under a map of the plane.
pub(crate) fn map_point(map: &Matrix3<f64>, p: &Point2<f64>) -> Point2<f64> {
    map_point_by::<false>(map, p)
}

/// Whether the map has 1 below all points, so that AFFINE may be true of it: it then needs no divisions, which are most of the work.
pub(crate) fn is_affine(map: &Matrix3<f64>) -> bool {
    map.row(2) == RowVector3::new(0.0, 0.0, 1.0)
}

/// Image of a point under a map of the plane, an affine one if AFFINE.
#[inline(always)]
pub(crate) fn map_point_by<const AFFINE: bool>(map: &Matrix3<f64>, p: &Point2<f64>) -> Point2<f64> {
    let image = |row: usize| map[(row, 0)] * p.x + map[(row, 1)] * p.y + map[(row, 2)];
    if AFFINE { Point2::new(image(0), image(1)) } else { Point2::new(image(0) / image(2), image(1) / image(2)) }
}

/// `n' D` with D the derivative of a map of the plane at `p`, whose image there is `image`: how fast the distance along
/// n from the image grows as p moves.
pub(crate) fn pull_back(map: &Matrix3<f64>, p: &Point2<f64>, image: &Point2<f64>, n: &Vector2<f64>) -> Vector2<f64> {
    pull_back_by::<false>(map, p, image, n)
}

/// The same, for an affine map if AFFINE.
#[inline(always)]
pub(crate) fn pull_back_by<const AFFINE: bool>(
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
