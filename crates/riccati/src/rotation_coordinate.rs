use nalgebra::Complex;

const J: Complex<f64> = Complex::new(0.0, 1.0);

/// The slope l of a complex line in the coordinate `w = (l - j) / (l + j)`, which a rotation of the plane turns at constant
/// rate: `w' = -2 j omega w`, whatever the translation.
///
/// The half plane `Im l > 0` becomes the disc `|w| < 1`, real lines its rim; the conjugate line has `1 / conj(w)`. |w| is
/// invariant under rigid motion and growth and says how much a pair can tell about rotation: nothing at w = 0, that is `l = j`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RotationCoordinate(pub Complex<f64>);

impl RotationCoordinate {
    /// Coordinate of the slope l. Infinite for `l = -j`.
    #[must_use]
    pub fn of_slope(l: Complex<f64>) -> Self {
        Self((l - J) / (l + J))
    }

    /// The slope, `l = j (1 + w) / (1 - w)`. Infinite for `w = 1`.
    #[must_use]
    pub fn slope(self) -> Complex<f64> {
        J * (self.0 + 1.0) / (-self.0 + 1.0)
    }

    /// The coordinate after `seconds` of a rotation with `omega` rad/s: `w(t) = w(0) exp(-2 j omega t)`.
    #[must_use]
    pub fn rotated(self, omega: f64, seconds: f64) -> Self {
        Self(self.0 * Complex::from_polar(1.0, -2.0 * omega * seconds))
    }

    /// |w|, invariant under rigid motion and growth.
    #[must_use]
    pub fn magnitude(self) -> f64 {
        self.0.norm()
    }
}
