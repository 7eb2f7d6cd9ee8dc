use nalgebra::Complex;

/// Square root of -1, the paper's j.
const J: Complex<f64> = Complex::I;

/// The rotation chart `w = (l - j) / (l + j)` of the coefficient l of a line.
///
/// Turning the image by phi counter-clockwise turns w by `2 phi` counter-clockwise, `w' = w exp(2 j phi)`, so `|w|` is a
/// rotation invariant: 0 for `l = j` (the pair contains no information on rotation), 1 for a real line. Lines with a positive
/// imaginary part of l lie within `|w| < 1`. Infinite at `l = -j`.
#[must_use]
pub fn rotation_chart(l: Complex<f64>) -> Complex<f64> {
    (l - J) / (l + J)
}

/// The l with the given w, `l = j (1 + w) / (1 - w)`: the inverse of [`rotation_chart`]. Infinite at `w = 1`.
#[must_use]
pub fn from_rotation_chart(w: Complex<f64>) -> Complex<f64> {
    J * (w + 1.0) / (-w + 1.0)
}
