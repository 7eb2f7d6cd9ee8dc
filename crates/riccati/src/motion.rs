use nalgebra::{Affine2, Matrix3};

/// Constant rigid motion `x' = omega y + b1`, `y' = -omega x + b2` in the fixed image frame.
///
/// Positive omega turns clockwise in a y-up frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RigidMotion {
    /// Angular velocity in rad/s.
    pub omega: f64,
    /// Velocity in x at the origin, lengths per second.
    pub b1: f64,
    /// Velocity in y at the origin, lengths per second.
    pub b2: f64,
}

/// Constant affine motion `x' = a1 x + a2 y + b1`, `y' = a3 x + a4 y + b2` in the fixed image frame (equation 4).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
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
        Affine2::from_matrix_unchecked((self.generator() * seconds).exp())
    }
}

impl From<RigidMotion> for AffineMotion {
    fn from(motion: RigidMotion) -> Self {
        Self { a1: 0.0, a2: motion.omega, a3: -motion.omega, a4: 0.0, b1: motion.b1, b2: motion.b2 }
    }
}
