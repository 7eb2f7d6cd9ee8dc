use freeform_decompose::Line;
use freeform_riccati::RealVariables;
use nalgebra::{Complex, Vector3, Vector4};

/// A conjugate pair between two frames.
///
/// The adaptive laws run in continuous time, outlines come in frames. In homogeneous coordinates a line moves linearly
/// (equation 5) and slowly, where `l` and `k` may swing far out and back within a few frames, so the line is
/// interpolated there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LinePath {
    from: Vector3<Complex<f64>>,
    to: Vector3<Complex<f64>>,
}

impl LinePath {
    pub(crate) fn between(earlier: &Line, later: &Line) -> Self {
        let from = earlier.homogeneous();
        // Homogeneous coordinates are free in one complex factor. A rotation keeps p^2 + l^2, which fixes it up to sign.
        let invariant = |line: &Line| line.l * line.l + 1.0;
        let factor = (invariant(earlier) / invariant(later)).sqrt();
        let factor = if factor.is_finite() { factor } else { Complex::new(1.0, 0.0) };
        let to = later.homogeneous() * factor;
        let nearer = |v: Vector3<Complex<f64>>| (v.xy() - from.xy()).norm_squared();
        Self { from, to: if nearer(to) <= nearer(-to) { to } else { -to } }
    }

    /// The state X of equation 19 at a fraction of the way, 0 to 1.
    pub(crate) fn state(&self, fraction: f64) -> Vector4<f64> {
        let at = |i: usize| self.from[i] * (1.0 - fraction) + self.to[i] * fraction;
        RealVariables::from(Line { l: at(1) / at(0), k: at(2) / at(0) }).state()
    }

    /// How far the direction of the line moves relative to itself: the angle in radians for a rotation.
    pub(crate) fn turn(&self) -> f64 {
        (self.to.xy() - self.from.xy()).norm() / self.from.xy().norm()
    }
}
