use nalgebra::{Affine2, Complex, Matrix3, Point2, Projective2, Vector2};

use crate::{
    exponential::{exponential, exponential_quotient},
    motion_model::MotionModel,
};

/// Constant rigid motion `x' = omega y + b1`, `y' = -omega x + b2` in the fixed image frame.
///
/// Positive omega turns clockwise in a y-up frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RigidMotion {
    /// Angular velocity in rad/s.
    pub omega: f64,
    /// Velocity in x at the origin, lengths per second.
    pub b1: f64,
    /// Velocity in y at the origin, lengths per second.
    pub b2: f64,
}

impl RigidMotion {
    /// The generator `A` of equation 4, per second.
    #[must_use]
    pub fn generator(&self) -> Matrix3<f64> {
        AffineMotion::from(*self).generator()
    }

    /// The map of the plane that the motion makes in `seconds`, in closed form and accurate for every omega.
    #[must_use]
    pub fn flow(&self, seconds: f64) -> Affine2<f64> {
        SimilarityMotion::from(*self).flow(seconds)
    }
}

/// Constant similarity motion `x' = sigma x + omega y + b1`, `y' = -omega x + sigma y + b2` in the fixed image frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SimilarityMotion {
    /// Rate of growth in 1/s: lengths scale with `exp(sigma t)`.
    pub sigma: f64,
    /// Angular velocity in rad/s, positive clockwise in a y-up frame.
    pub omega: f64,
    /// Velocity in x at the origin, lengths per second.
    pub b1: f64,
    /// Velocity in y at the origin, lengths per second.
    pub b2: f64,
}

impl SimilarityMotion {
    /// The generator `A` of equation 4, per second.
    #[must_use]
    pub fn generator(&self) -> Matrix3<f64> {
        AffineMotion::from(*self).generator()
    }

    /// The map of the plane that the motion makes in `seconds`, in closed form and accurate for every sigma and omega.
    #[must_use]
    pub fn flow(&self, seconds: f64) -> Affine2<f64> {
        // With q = x + j y the motion is q' = (sigma - j omega) q + b.
        let z = Complex::new(self.sigma, -self.omega) * seconds;
        let linear = z.exp();
        let shift = exponential_quotient(z) * Complex::new(self.b1, self.b2) * seconds;
        let (c, s) = (linear.re, linear.im);
        Affine2::from_matrix_unchecked(Matrix3::new(c, -s, shift.re, s, c, shift.im, 0.0, 0.0, 1.0))
    }
}

/// Constant affine motion `x' = a1 x + a2 y + b1`, `y' = a3 x + a4 y + b2` in the fixed image frame (equation 4).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AffineMotion {
    /// `dx'/dx` in 1/s.
    pub a1: f64,
    /// `dx'/dy` in 1/s.
    pub a2: f64,
    /// `dy'/dx` in 1/s.
    pub a3: f64,
    /// `dy'/dy` in 1/s.
    pub a4: f64,
    /// Velocity in x at the origin, lengths per second.
    pub b1: f64,
    /// Velocity in y at the origin, lengths per second.
    pub b2: f64,
}

impl AffineMotion {
    /// The generator `A` of equation 4, per second.
    #[must_use]
    pub fn generator(&self) -> Matrix3<f64> {
        Matrix3::new(self.a1, self.a2, self.b1, self.a3, self.a4, self.b2, 0.0, 0.0, 0.0)
    }

    /// The map of the plane that the motion makes in `seconds`, `expm(A seconds)`.
    #[must_use]
    pub fn flow(&self, seconds: f64) -> Affine2<f64> {
        Affine2::from_matrix_unchecked(exponential(&(self.generator() * seconds)))
    }
}

/// Constant projective motion: homogeneous points `P = (x, y, 1)` move by `P' = A P` with the last row `(c1, c2, 0)`, so
/// `x' = a1 x + a2 y + b1 - x (c1 x + c2 y)` and `y' = a3 x + a4 y + b2 - y (c1 x + c2 y)`.
///
/// A multiple of the identity moves no point; taking 0 for the last entry fixes that freedom.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ProjectiveMotion {
    /// Entry (1, 1) of the generator in 1/s.
    pub a1: f64,
    /// Entry (1, 2) of the generator in 1/s.
    pub a2: f64,
    /// Entry (2, 1) of the generator in 1/s.
    pub a3: f64,
    /// Entry (2, 2) of the generator in 1/s.
    pub a4: f64,
    /// Velocity in x at the origin, lengths per second.
    pub b1: f64,
    /// Velocity in y at the origin, lengths per second.
    pub b2: f64,
    /// Entry (3, 1) of the generator, per length and second.
    pub c1: f64,
    /// Entry (3, 2) of the generator, per length and second.
    pub c2: f64,
}

impl ProjectiveMotion {
    /// The generator `A`, per second.
    #[must_use]
    pub fn generator(&self) -> Matrix3<f64> {
        Matrix3::new(self.a1, self.a2, self.b1, self.a3, self.a4, self.b2, self.c1, self.c2, 0.0)
    }

    /// The motion with a generator, whose multiple of the identity is taken off.
    #[must_use]
    pub fn of_generator(generator: &Matrix3<f64>) -> Self {
        let [a1, a2, a3, a4, b1, b2, c1, c2] = MotionModel::Projective.parameters_of(generator);
        Self { a1, a2, a3, a4, b1, b2, c1, c2 }
    }

    /// The motion as an affine one; `None` unless c1 and c2 are 0.
    #[must_use]
    pub fn as_affine(&self) -> Option<AffineMotion> {
        let Self { a1, a2, a3, a4, b1, b2, c1, c2 } = *self;
        (c1 == 0.0 && c2 == 0.0).then_some(AffineMotion { a1, a2, a3, a4, b1, b2 })
    }

    /// Velocity of the point that is at `p`, lengths per second.
    #[must_use]
    pub fn velocity(&self, p: &Point2<f64>) -> Vector2<f64> {
        let Self { a1, a2, a3, a4, b1, b2, c1, c2 } = *self;
        let affine = Vector2::new(a1 * p.x + a2 * p.y + b1, a3 * p.x + a4 * p.y + b2);
        affine - p.coords * (c1 * p.x + c2 * p.y)
    }

    /// The map of the plane that the motion makes in `seconds`, `expm(A seconds)`.
    #[must_use]
    pub fn flow(&self, seconds: f64) -> Projective2<f64> {
        Projective2::from_matrix_unchecked(exponential(&(self.generator() * seconds)))
    }
}

impl From<RigidMotion> for SimilarityMotion {
    fn from(RigidMotion { omega, b1, b2 }: RigidMotion) -> Self {
        Self { sigma: 0.0, omega, b1, b2 }
    }
}

impl From<SimilarityMotion> for AffineMotion {
    fn from(SimilarityMotion { sigma, omega, b1, b2 }: SimilarityMotion) -> Self {
        Self { a1: sigma, a2: omega, a3: -omega, a4: sigma, b1, b2 }
    }
}

impl From<RigidMotion> for AffineMotion {
    fn from(motion: RigidMotion) -> Self {
        SimilarityMotion::from(motion).into()
    }
}

impl From<AffineMotion> for ProjectiveMotion {
    fn from(AffineMotion { a1, a2, a3, a4, b1, b2 }: AffineMotion) -> Self {
        Self { a1, a2, a3, a4, b1, b2, c1: 0.0, c2: 0.0 }
    }
}

impl From<SimilarityMotion> for ProjectiveMotion {
    fn from(motion: SimilarityMotion) -> Self {
        AffineMotion::from(motion).into()
    }
}

impl From<RigidMotion> for ProjectiveMotion {
    fn from(motion: RigidMotion) -> Self {
        AffineMotion::from(motion).into()
    }
}
