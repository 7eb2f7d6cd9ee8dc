use nalgebra::{Complex, Matrix2, Matrix3, Projective2};

use crate::{
    exponential::{exponential, linear_exponential},
    motion::{ProjectiveMotion, SimilarityMotion},
};

/// Largest number of parameters of any model, that of a projective motion.
pub const MAX_PARAMETERS: usize = 8;

/// What a parameter of a motion model is, and with it how it changes with the unit of length.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ParameterKind {
    /// Rate of growth, turning or shear, per second: `sigma`, `omega`, `a1` to `a4`. The unit of length does not matter.
    Rate,
    /// Velocity at the origin, lengths per second: `b1`, `b2`.
    Velocity,
    /// Rate of perspective, per length and second: `c1`, `c2`.
    Perspective,
}

/// Family of motions of the plane, and with it the meaning of a parameter vector theta: `A = sum theta_j E_j`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum MotionModel {
    /// omega, b1, b2: see [`RigidMotion`](crate::RigidMotion).
    Rigid,
    /// sigma, omega, b1, b2: see [`SimilarityMotion`](crate::SimilarityMotion).
    Similarity,
    /// a1, a2, a3, a4, b1, b2: see [`AffineMotion`](crate::AffineMotion).
    Affine,
    /// a1, a2, a3, a4, b1, b2, c1, c2: see [`ProjectiveMotion`](crate::ProjectiveMotion).
    Projective,
}

const fn generator_of(rows: [[f64; 3]; 3]) -> Matrix3<f64> {
    let [[a1, a2, b1], [a3, a4, b2], [c1, c2, c3]] = rows;
    Matrix3::new(a1, a2, b1, a3, a4, b2, c1, c2, c3)
}

const fn entry(row: usize, column: usize) -> Matrix3<f64> {
    let mut rows = [[0.0; 3]; 3];
    rows[row][column] = 1.0;
    generator_of(rows)
}

const SIGMA: Matrix3<f64> = generator_of([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0; 3]]);
const OMEGA: Matrix3<f64> = generator_of([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0; 3]]);
const A1: Matrix3<f64> = entry(0, 0);
const A2: Matrix3<f64> = entry(0, 1);
const A3: Matrix3<f64> = entry(1, 0);
const A4: Matrix3<f64> = entry(1, 1);
const B1: Matrix3<f64> = entry(0, 2);
const B2: Matrix3<f64> = entry(1, 2);
const C1: Matrix3<f64> = entry(2, 0);
const C2: Matrix3<f64> = entry(2, 1);

impl MotionModel {
    /// All models, fewest parameters first. Each holds the one before.
    pub const ALL: [Self; 4] = [Self::Rigid, Self::Similarity, Self::Affine, Self::Projective];

    /// Largest number of parameters of any model.
    pub const MAX_PARAMETERS: usize = MAX_PARAMETERS;

    /// Number of parameters: 3, 4, 6 or 8.
    #[must_use]
    pub const fn parameter_count(self) -> usize {
        self.basis().len()
    }

    /// Names of the parameters in order.
    #[must_use]
    pub const fn parameter_names(self) -> &'static [&'static str] {
        match self {
            Self::Rigid => &["omega", "b1", "b2"],
            Self::Similarity => &["sigma", "omega", "b1", "b2"],
            Self::Affine => &["a1", "a2", "a3", "a4", "b1", "b2"],
            Self::Projective => &["a1", "a2", "a3", "a4", "b1", "b2", "c1", "c2"],
        }
    }

    /// What each parameter is, in order.
    #[must_use]
    pub const fn parameter_kinds(self) -> &'static [ParameterKind] {
        use ParameterKind::{Perspective, Rate, Velocity};
        match self {
            Self::Rigid => &[Rate, Velocity, Velocity],
            Self::Similarity => &[Rate, Rate, Velocity, Velocity],
            Self::Affine => &[Rate, Rate, Rate, Rate, Velocity, Velocity],
            Self::Projective => &[Rate, Rate, Rate, Rate, Velocity, Velocity, Perspective, Perspective],
        }
    }

    /// Units of the parameters in order, the length unit left out: a velocity is in lengths per second, written `1/s`.
    #[must_use]
    pub const fn units(self) -> &'static [&'static str] {
        match self {
            Self::Rigid => &["rad/s", "1/s", "1/s"],
            Self::Similarity => &["1/s", "rad/s", "1/s", "1/s"],
            Self::Affine => &["1/s"; 6],
            Self::Projective => &["1/s"; 8],
        }
    }

    /// The matrices `E_j` of `A = sum theta_j E_j`, in the order of the parameters.
    #[must_use]
    pub const fn basis(self) -> &'static [Matrix3<f64>] {
        match self {
            Self::Rigid => &[OMEGA, B1, B2],
            Self::Similarity => &[SIGMA, OMEGA, B1, B2],
            Self::Affine => &[A1, A2, A3, A4, B1, B2],
            Self::Projective => &[A1, A2, A3, A4, B1, B2, C1, C2],
        }
    }

    /// The generator `A = sum theta_j E_j`, per second.
    ///
    /// # Panics
    /// If `parameters` does not have `parameter_count` entries.
    #[must_use]
    pub fn generator(self, parameters: &[f64]) -> Matrix3<f64> {
        let basis = self.basis();
        assert_eq!(parameters.len(), basis.len(), "number of parameters of a {self} motion");
        // Written out: this is asked for dozens of times a frame, and most entries of the basis are zero.
        match *parameters {
            [omega, b1, b2] => generator_of([[0.0, omega, b1], [0.0 - omega, 0.0, b2], [0.0; 3]]),
            [sigma, omega, b1, b2] => generator_of([[sigma, omega, b1], [0.0 - omega, sigma, b2], [0.0; 3]]),
            [a1, a2, a3, a4, b1, b2] => generator_of([[a1, a2, b1], [a3, a4, b2], [0.0; 3]]),
            _ => parameters.iter().zip(basis).fold(Matrix3::zeros(), |sum, (theta, e)| sum + e * *theta),
        }
    }

    /// The parameters of a motion in this model, in its order; `None` where the model does not hold the motion.
    ///
    /// ```
    /// use freeform_riccati::{MotionModel, RigidMotion};
    ///
    /// let motion = RigidMotion { omega: 1.5, b1: -0.3, b2: 0.4 }.into();
    /// assert_eq!(MotionModel::Rigid.parameters_of_motion(&motion), Some(vec![1.5, -0.3, 0.4]));
    /// ```
    #[must_use]
    pub fn parameters_of_motion(self, motion: &ProjectiveMotion) -> Option<Vec<f64>> {
        let ProjectiveMotion { a1, a2, a3, a4, b1, b2, c1, c2 } = *motion;
        let is_affine = c1 == 0.0 && c2 == 0.0;
        let is_similarity = is_affine && a1 == a4 && a2 == -a3;
        match self {
            Self::Rigid => (is_similarity && a1 == 0.0).then(|| vec![a2, b1, b2]),
            Self::Similarity => is_similarity.then(|| vec![a1, a2, b1, b2]),
            Self::Affine => is_affine.then(|| vec![a1, a2, a3, a4, b1, b2]),
            Self::Projective => Some(vec![a1, a2, a3, a4, b1, b2, c1, c2]),
        }
    }

    /// The map of the plane that the motion makes in `seconds`: in closed form for rigid and similarity motion, `expm(A
    /// seconds)` otherwise. Its last row is exactly `(0, 0, 1)` for all but projective motion, so that `nalgebra::try_convert`
    /// makes it an `Affine2`.
    ///
    /// # Panics
    /// If `parameters` does not have `parameter_count` entries.
    #[must_use]
    pub fn flow(self, parameters: &[f64], seconds: f64) -> Projective2<f64> {
        let generator = self.generator(parameters);
        let map = match self {
            Self::Rigid | Self::Similarity => {
                let (sigma, omega, b1, b2) =
                    (generator[(0, 0)], generator[(0, 1)], generator[(0, 2)], generator[(1, 2)]);
                SimilarityMotion { sigma, omega, b1, b2 }.flow(seconds).to_homogeneous()
            }
            Self::Affine | Self::Projective => exponential(&(generator * seconds)),
        };
        Projective2::from_matrix_unchecked(map)
    }
}

impl MotionModel {
    /// Linear part of [`flow`](Self::flow), which the velocity has no part in; for all but projective motion.
    ///
    /// # Panics
    /// If `parameters` does not have `parameter_count` entries.
    #[must_use]
    pub fn linear_flow(self, parameters: &[f64], seconds: f64) -> Matrix2<f64> {
        let generator = self.generator(parameters);
        if self <= Self::Similarity {
            let linear = (Complex::new(generator[(0, 0)], -generator[(0, 1)]) * seconds).exp();
            return Matrix2::new(linear.re, -linear.im, linear.im, linear.re);
        }
        linear_exponential(&(generator.fixed_view::<2, 2>(0, 0) * seconds))[0]
    }

    /// [`linear_flow`](Self::linear_flow), and its integral over the time: how far a velocity that turns with the object carries a point, for
    /// each component of the velocity; for all but projective motion.
    ///
    /// # Panics
    /// If `parameters` does not have `parameter_count` entries.
    #[must_use]
    pub fn linear_flow_with_integral(self, parameters: &[f64], seconds: f64) -> (Matrix2<f64>, Matrix2<f64>) {
        let generator = self.generator(parameters);
        if self <= Self::Similarity {
            // Turns and growth commute, so that the way of one velocity tells that of all.
            let (sigma, omega) = (generator[(0, 0)], generator[(0, 1)]);
            let flow = SimilarityMotion { sigma, omega, b1: 1.0, b2: 0.0 }.flow(seconds).to_homogeneous();
            let (along, across) = (flow[(0, 2)], flow[(1, 2)]);
            return (flow.fixed_view::<2, 2>(0, 0).into_owned(), Matrix2::new(along, -across, across, along));
        }
        let [flow, mean] = linear_exponential(&(generator.fixed_view::<2, 2>(0, 0) * seconds));
        (flow, mean * seconds)
    }
}

impl std::fmt::Display for MotionModel {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Rigid => "rigid",
            Self::Similarity => "similarity",
            Self::Affine => "affine",
            Self::Projective => "projective",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_generator_is_the_sum_of_the_basis() {
        let parameters = [0.3, -0.7, 1.1, 0.2, -0.4, 0.9, 0.05, -0.06];
        for model in MotionModel::ALL {
            let parameters = &parameters[..model.parameter_count()];
            let sum = parameters.iter().zip(model.basis()).fold(Matrix3::zeros(), |sum, (theta, e)| sum + e * *theta);
            assert_eq!(model.generator(parameters), sum, "{model}");
        }
    }
}
