use freeform_decompose::Line;
use nalgebra::{Complex, Matrix3, Transform, Vector3};

use crate::{error::DynamicsError, exponential::exponential};

/// Time derivatives of a line under a motion, per second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineRate {
    /// `l'`, equations 9 and 11.
    pub l: Complex<f64>,
    /// `k'`, equations 10 and 12.
    pub k: Complex<f64>,
    /// `pbar' / pbar`, the rate of the factor that the chart divides out: `-(a1 + a3 l + c1 k)`.
    pub log_p: Complex<f64>,
}

/// Riccati equations of a line (9 to 12), extended to a generator with any last row `(c1, c2, c3)`:
/// `l' = -a2 - a4 l - c2 k + l (a1 + a3 l + c1 k)`, `k' = -b1 - b2 l - c3 k + k (a1 + a3 l + c1 k)`.
#[must_use]
pub fn line_rate(generator: &Matrix3<f64>, line: &Line) -> LineRate {
    let derivative = homogeneous_line(generator, line);
    let log_p = -derivative.x;
    LineRate { l: -derivative.y - line.l * log_p, k: -derivative.z - line.k * log_p, log_p }
}

/// The line after `seconds` of a constant motion, `L(t) = expm(-A' t) L(0)` (equations 5 and 6), back in the chart.
///
/// Also returns `s = pbar(t) / pbar(0)`, the factor that the chart divides out. The generator may have any last row.
///
/// # Errors
/// The line left the chart, or the motion is not finite.
pub fn line_flow(generator: &Matrix3<f64>, line: &Line, seconds: f64) -> Result<(Line, Complex<f64>), DynamicsError> {
    into_chart(&homogeneous_line(&exponential(&(generator * -seconds)), line))
}

/// The line moved by a map T of the plane, affine or projective: it vanishes at `T p` where the given line vanishes at `p`.
///
/// Also returns the factor `s` that the chart divides out: `x + l y + k = s w (x' + l' y' + k')` with `T (x, y, 1) = w (x',
/// y', 1)`. For an affine map it is the same as [`Line::moved`].
///
/// # Errors
/// The line left the chart, or the map is singular or not finite.
pub fn moved_line<C: nalgebra::TCategory>(
    line: &Line,
    map: &Transform<f64, C, 2>,
) -> Result<(Line, Complex<f64>), DynamicsError> {
    into_chart(&homogeneous_line(&inverse_of(map.matrix())?, line))
}

pub(crate) fn inverse_of(map: &Matrix3<f64>) -> Result<Matrix3<f64>, DynamicsError> {
    map.try_inverse()
        .filter(|inverse| inverse.iter().all(|e| e.is_finite()))
        .ok_or_else(|| DynamicsError::SingularMap { determinant: map.determinant() })
}

/// `M' (1, l, k)`.
fn homogeneous_line(matrix: &Matrix3<f64>, line: &Line) -> Vector3<Complex<f64>> {
    let entry = |c: usize| line.l * matrix[(1, c)] + line.k * matrix[(2, c)] + matrix[(0, c)];
    Vector3::new(entry(0), entry(1), entry(2))
}

fn into_chart(bar: &Vector3<Complex<f64>>) -> Result<(Line, Complex<f64>), DynamicsError> {
    let line = Line { l: bar.y / bar.x, k: bar.z / bar.x };
    if line.l.is_finite() && line.k.is_finite() {
        Ok((line, bar.x))
    } else {
        Err(DynamicsError::LineLeftChart { p_magnitude: bar.x.norm(), l_magnitude: bar.y.norm() })
    }
}
