use nalgebra::{Affine2, Complex, Point2, Vector3};

/// Complex line `x + l y + k = 0` in the chart where the coefficient of x is 1 (equation 1).
///
/// `l` is a pure number, `k` a length in the unit of the outline. A line of a closed and bounded curve has a complex `l`.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Line {
    /// Coefficient of y.
    pub l: Complex<f64>,
    /// Constant term.
    pub k: Complex<f64>,
}

impl Line {
    /// What unused places of a fixed-size collection hold.
    pub(crate) const ZERO: Self = Self { l: Complex::ZERO, k: Complex::ZERO };

    /// Value `x + l y + k` at a point.
    #[must_use]
    pub fn evaluate(&self, p: &Point2<f64>) -> Complex<f64> {
        self.l * p.y + self.k + p.x
    }

    /// The complex conjugate line.
    #[must_use]
    pub fn conjugate(&self) -> Self {
        Self { l: self.l.conj(), k: self.k.conj() }
    }

    /// Homogeneous coordinates `(1, l, k)` (equation 3 with p = 1).
    #[must_use]
    pub fn homogeneous(&self) -> Vector3<Complex<f64>> {
        Vector3::new(Complex::new(1.0, 0.0), self.l, self.k)
    }

    /// The line moved by an affine map T: it vanishes at `T p` where this one vanishes at `p`. Also returns the factor
    /// `s` that the chart divides out, `x + l y + k = s (x' + l' y' + k')` at corresponding points; it is what the
    /// coefficients alpha and beta pick up (equations 5 to 8).
    ///
    /// `None` where the map is singular or sends the line to one without x (the chart's infinity; only real lines can get
    /// there exactly).
    #[must_use]
    pub fn moved(&self, map: &Affine2<f64>) -> Option<(Self, Complex<f64>)> {
        let inverse = map.matrix().try_inverse()?;
        let column = |c: usize| self.l * inverse[(1, c)] + self.k * inverse[(2, c)] + inverse[(0, c)];
        let (s, l, k) = (column(0), column(1), column(2));
        let moved = Self { l: l / s, k: k / s };
        (moved.l.is_finite() && moved.k.is_finite()).then_some((moved, s))
    }
}
