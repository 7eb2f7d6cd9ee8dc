use freeform_decompose::Line;
use nalgebra::{Complex, Vector4};

use crate::motion::AffineMotion;

/// One conjugate pair of lines in real variables, `l = eta1 +- j eta2`, `k = eta3 +- j eta4` (equation 13).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RealVariables {
    /// Real part of l.
    pub eta1: f64,
    /// Imaginary part of l.
    pub eta2: f64,
    /// Real part of k, a length.
    pub eta3: f64,
    /// Imaginary part of k, a length.
    pub eta4: f64,
}

impl RealVariables {
    /// Time derivatives of `(eta1, eta2, eta3, eta4)` per second: the Riccati equations in real variables (14 to 17).
    #[must_use]
    pub fn rate(&self, motion: &AffineMotion) -> Vector4<f64> {
        let Self { eta1, eta2, eta3, eta4 } = *self;
        let AffineMotion { a1, a2, a3, a4, b1, b2 } = *motion;
        Vector4::new(
            -a2 + (a1 - a4) * eta1 + a3 * (eta1 * eta1 - eta2 * eta2),
            (a1 - a4) * eta2 + 2.0 * a3 * eta1 * eta2,
            -b1 - b2 * eta1 + a1 * eta3 + a3 * (eta1 * eta3 - eta2 * eta4),
            -b2 * eta2 + a1 * eta4 + a3 * (eta1 * eta4 + eta2 * eta3),
        )
    }

    /// The state vector `(eta1, eta2, eta3, eta4)` of equation 19.
    #[must_use]
    pub fn state(&self) -> Vector4<f64> {
        Vector4::new(self.eta1, self.eta2, self.eta3, self.eta4)
    }

    /// Both lines of the pair, the one with `l = eta1 + j eta2` first.
    #[must_use]
    pub fn pair(&self) -> (Line, Line) {
        let line = Line::from(*self);
        (line, line.conjugate())
    }
}

impl From<Line> for RealVariables {
    fn from(line: Line) -> Self {
        Self { eta1: line.l.re, eta2: line.l.im, eta3: line.k.re, eta4: line.k.im }
    }
}

impl From<RealVariables> for Line {
    fn from(RealVariables { eta1, eta2, eta3, eta4 }: RealVariables) -> Self {
        Self { l: Complex::new(eta1, eta2), k: Complex::new(eta3, eta4) }
    }
}

impl From<Vector4<f64>> for RealVariables {
    fn from(state: Vector4<f64>) -> Self {
        Self { eta1: state.x, eta2: state.y, eta3: state.z, eta4: state.w }
    }
}
