//! Generators of a motion model as parameter vectors: their velocity fields, and how they change with the frame.
use nalgebra::{Matrix3, Point2, Vector2};

use crate::motion_model::{MAX_PARAMETERS, MotionModel};

/// One value per parameter of a model, zeros behind.
pub type ParameterVector = [f64; MAX_PARAMETERS];

/// Square matrix over the parameters of a model, zeros behind; `m[row][column]`.
pub type ParameterMatrix = [[f64; MAX_PARAMETERS]; MAX_PARAMETERS];

/// Angular velocity omega of a generator in rad/s, clockwise where y points up.
#[inline]
#[must_use]
pub fn turn_rate(generator: &Matrix3<f64>) -> f64 {
    0.5 * (generator[(0, 1)] - generator[(1, 0)])
}

/// Growth, turn and velocity of the similarity motion nearest to a generator, which is given by its entries.
fn parameters_of_similarity(entry: impl Fn(usize, usize) -> f64) -> [f64; 4] {
    let (sigma, omega) = (0.5 * (entry(0, 0) + entry(1, 1)), 0.5 * (entry(0, 1) - entry(1, 0)));
    [sigma, omega, entry(0, 2), entry(1, 2)]
}

impl MotionModel {
    /// Parameters of the motion in this model that is nearest to a generator in its entries: the inverse of
    /// [`generator`](Self::generator) for one of this model. A multiple of the identity, which moves nothing, is taken off
    /// first. As many as `parameter_count` in front, 0 behind.
    #[must_use]
    pub fn parameters_of(self, generator: &Matrix3<f64>) -> ParameterVector {
        let g = generator - Matrix3::identity() * generator[(2, 2)];
        let of_similarity = parameters_of_similarity(|i, j| g[(i, j)]);
        let full = [g[(0, 0)], g[(0, 1)], g[(1, 0)], g[(1, 1)], g[(0, 2)], g[(1, 2)], g[(2, 0)], g[(2, 1)]];
        let mut result = [0.0; MAX_PARAMETERS];
        match self {
            Self::Rigid => result[..3].copy_from_slice(&of_similarity[1..]),
            Self::Similarity => result[..4].copy_from_slice(&of_similarity),
            Self::Affine => result[..6].copy_from_slice(&full[..6]),
            Self::Projective => result = full,
        }
        result
    }

    /// Normal component of the velocity that each basis generator gives a point: entry j is `normal . (E_j p)`.
    #[inline]
    #[must_use]
    pub fn normal_velocities(self, p: &Point2<f64>, normal: &Vector2<f64>) -> ParameterVector {
        let (x, y, u, v) = (p.x, p.y, normal.x, normal.y);
        match self {
            Self::Rigid => [u * y - v * x, u, v, 0.0, 0.0, 0.0, 0.0, 0.0],
            Self::Similarity => [u * x + v * y, u * y - v * x, u, v, 0.0, 0.0, 0.0, 0.0],
            Self::Affine => [u * x, u * y, v * x, v * y, u, v, 0.0, 0.0],
            Self::Projective => {
                let along = -(u * x + v * y);
                [u * x, u * y, v * x, v * y, u, v, along * x, along * y]
            }
        }
    }

    /// Matrix of `E -> T E T^-1` on parameters, for a map T of the model's own group or a similarity, and its inverse.
    #[must_use]
    pub fn adjoint(self, map: &Matrix3<f64>, inverse: &Matrix3<f64>) -> ParameterMatrix {
        match self {
            Self::Rigid | Self::Similarity => self.adjoint_of_similarity(map, inverse),
            Self::Affine => Self::adjoint_of_affine(map, inverse),
            Self::Projective => self.parameter_columns(self.basis().iter().map(|e| map * e * inverse)),
        }
    }

    /// [`adjoint`](Self::adjoint) for affine motion: a generator with one entry becomes a column of the map times a row of the inverse.
    fn adjoint_of_affine(map: &Matrix3<f64>, inverse: &Matrix3<f64>) -> ParameterMatrix {
        const ENTRIES: [(usize, usize); 6] = [(0, 0), (0, 1), (1, 0), (1, 1), (0, 2), (1, 2)];
        let mut result = [[0.0; MAX_PARAMETERS]; MAX_PARAMETERS];
        for (entries, (i, j)) in result.iter_mut().zip(ENTRIES) {
            for (entry, (row, column)) in entries.iter_mut().zip(ENTRIES) {
                *entry = map[(i, row)] * inverse[(column, j)];
            }
        }
        result
    }

    /// [`adjoint`](Self::adjoint) for rigid and similarity motion, without the zeros of their generators.
    fn adjoint_of_similarity(self, map: &Matrix3<f64>, inverse: &Matrix3<f64>) -> ParameterMatrix {
        let product = |row: usize, column: usize| move |i: usize, j: usize| map[(i, row)] * inverse[(column, j)];
        let growth = |i, j| product(0, 0)(i, j) + product(1, 1)(i, j);
        let turn = |i, j| product(0, 1)(i, j) - product(1, 0)(i, j);
        let of_growth = parameters_of_similarity(growth);
        let of_others = [
            parameters_of_similarity(turn),
            parameters_of_similarity(product(0, 2)),
            parameters_of_similarity(product(1, 2)),
        ];
        let mut result = [[0.0; MAX_PARAMETERS]; MAX_PARAMETERS];
        let skipped = 4 - self.parameter_count();
        let columns = std::iter::once(of_growth).chain(of_others).skip(skipped);
        for (column, parameters) in columns.enumerate() {
            for (row, value) in parameters.into_iter().skip(skipped).enumerate() {
                result[row][column] = value;
            }
        }
        result
    }

    /// Matrix whose columns are the parameters of the given generators, one for each parameter of the model.
    #[must_use]
    pub fn parameter_columns(self, generators: impl Iterator<Item = Matrix3<f64>>) -> ParameterMatrix {
        let mut result = [[0.0; MAX_PARAMETERS]; MAX_PARAMETERS];
        for (column, generator) in generators.take(self.parameter_count()).enumerate() {
            for (row, value) in self.parameters_of(&generator).into_iter().enumerate() {
                result[row][column] = value;
            }
        }
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_adjoint_is_that_of_products_of_matrices() {
        let similarity = Matrix3::new(0.8, 0.5, 3.0, -0.5, 0.8, -2.0, 0.0, 0.0, 1.0);
        let affine = Matrix3::new(0.8, 0.3, 3.0, -0.6, 1.4, -2.0, 0.0, 0.0, 1.0);
        let cases =
            [(MotionModel::Rigid, similarity), (MotionModel::Similarity, similarity), (MotionModel::Affine, affine)];
        for (model, map) in cases {
            let inverse = map.try_inverse().expect("a regular map");
            let plain = model.parameter_columns(model.basis().iter().map(|e| map * e * inverse));
            assert_eq!(model.adjoint(&map, &inverse), plain, "{model}");
        }
    }
}
