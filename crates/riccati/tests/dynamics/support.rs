use differential_equations::prelude::*;
use freeform_decompose::Line;
use freeform_riccati::{AffineMotion, MotionModel};
use nalgebra::{Affine2, Complex, Matrix3};
use proptest::prelude::*;

struct System<F>(F);

impl<const N: usize, F: Fn(f64, &[f64; N]) -> [f64; N]> ODE<f64, [f64; N]> for System<F> {
    fn diff(&self, t: f64, y: &[f64; N], dydt: &mut [f64; N]) {
        *dydt = self.0(t, y);
    }
}

/// Solution at `to` of `y' = rate(t, y)` by the Runge-Kutta method of order 8 of Dormand and Prince.
pub(crate) fn dop853<const N: usize>(
    rate: impl Fn(f64, &[f64; N]) -> [f64; N],
    start: [f64; N],
    from: f64,
    to: f64,
) -> [f64; N] {
    let system = System(rate);
    let method = ExplicitRungeKutta::dop853().rtol(1e-14).atol(1e-14);
    let solution = IVP::ode(&system, from, to, start).method(method).solve().expect("a smooth problem");
    *solution.y.last().expect("at least the start")
}

/// A line of a well-conditioned closed curve of about unit size.
pub(crate) fn line() -> impl Strategy<Value = Line> {
    (-1.5..1.5, 0.3..2.0, -1.0..1.0, -1.0..1.0, any::<bool>()).prop_map(|(l1, l2, k1, k2, conjugate)| {
        let line = Line { l: Complex::new(l1, l2), k: Complex::new(k1, k2) };
        if conjugate { line.conjugate() } else { line }
    })
}

pub(crate) fn affine_motion() -> impl Strategy<Value = AffineMotion> {
    prop::array::uniform6(-0.8..0.8).prop_map(|[a1, a2, a3, a4, b1, b2]| AffineMotion { a1, a2, a3, a4, b1, b2 })
}

/// A full 3x3 generator with a small last row, so that a unit-size object stays in front of the camera.
pub(crate) fn generator() -> impl Strategy<Value = Matrix3<f64>> {
    (affine_motion(), prop::array::uniform3(-0.25..0.25)).prop_map(|(motion, [c1, c2, c3])| {
        let mut generator = motion.generator();
        generator.set_row(2, &nalgebra::RowVector3::new(c1, c2, c3));
        generator
    })
}

/// A model and parameters for it.
pub(crate) fn model_and_parameters() -> impl Strategy<Value = (MotionModel, Vec<f64>)> {
    (prop::sample::select(&MotionModel::ALL[..]), prop::array::uniform8(-0.8..0.8)).prop_map(|(model, mut values)| {
        values[6] *= 0.3;
        values[7] *= 0.3;
        (model, values[..model.parameter_count()].to_vec())
    })
}

/// An affine map that is far from singular.
pub(crate) fn affine_map() -> impl Strategy<Value = Affine2<f64>> {
    (affine_motion(), 0.1..1.0).prop_map(|(motion, seconds)| motion.flow(seconds))
}

pub(crate) fn distance(a: Complex<f64>, b: Complex<f64>) -> f64 {
    (a - b).norm() / b.norm().max(1.0)
}

/// Largest difference of two lists of numbers relative to the largest entry of the second.
pub(crate) fn relative_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let scale = b.iter().fold(0.0_f64, |m, e| m.max(e.abs()));
    a.iter().zip(b).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs())) / scale
}
