use pulp::{Arch, Simd, WithSimd};

use crate::{
    degree::Degree, monomials::monomial_index, normalisation::Normalisation, outline::Outline,
    polynomial::ImplicitPolynomial,
};

/// How far points lie from a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Residuals {
    /// Root mean square of f over the points, in the units of the level sets (-1, 0, 1).
    pub algebraic: f64,
    /// Root mean square of the first-order distance `|f| / |grad f|` (Taubin 1991), in the length unit of the points.
    pub geometric: f64,
}

impl Residuals {
    /// Residuals of the points `(xs[i], ys[i])` from the curve `f = 0`. Zero for no points.
    #[must_use]
    pub fn of(f: &ImplicitPolynomial, xs: &[f64], ys: &[f64]) -> Self {
        let sums = Arch::new().dispatch(ResidualKernel { f, xs, ys });
        let count = xs.len().max(1) as f64;
        Self { algebraic: (sums.0 / count).sqrt(), geometric: (sums.1 / count).sqrt() }
    }
}

impl Residuals {
    /// Root mean square first-order distance of the points of an outline from the curve `f = 0` of the working coordinates of a
    /// normalisation, in image units, whatever its stretch.
    pub(crate) fn geometric_in_image(f: &ImplicitPolynomial, normalisation: &Normalisation, outline: &Outline) -> f64 {
        let image_from_working = normalisation.image_from_working();
        let linear = image_from_working.matrix().fixed_view::<2, 2>(0, 0).into_owned();
        let Some(inverse) = linear.try_inverse() else { return f64::NAN };
        let squares = outline.points().map(|p| {
            let (value, gradient, _) = f.value_and_derivatives(&normalisation.to_working(p));
            // As in the other residuals, a point where the gradient vanishes is kept from dividing by zero.
            value * value / (inverse.tr_mul(&gradient).norm_squared() + 1e-100)
        });
        (squares.sum::<f64>() / outline.point_count() as f64).sqrt()
    }
}

/// Sums of `f^2` and `f^2 / |grad f|^2`.
struct ResidualKernel<'a> {
    f: &'a ImplicitPolynomial,
    xs: &'a [f64],
    ys: &'a [f64],
}

impl WithSimd for ResidualKernel<'_> {
    type Output = (f64, f64);

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> (f64, f64) {
        match self.f.degree() {
            Degree::Conic => sum_residuals::<S, 2>(simd, &self),
            Degree::Quartic => sum_residuals::<S, 4>(simd, &self),
            Degree::Sextic => sum_residuals::<S, 6>(simd, &self),
            Degree::Octic => sum_residuals::<S, 8>(simd, &self),
        }
    }
}

#[inline(always)]
fn sum_residuals<S: Simd, const N: usize>(simd: S, kernel: &ResidualKernel<'_>) -> (f64, f64) {
    let zero = simd.splat_f64s(0.0);
    let (mut algebraic, mut geometric) = (zero, zero);
    let (xs, x_rest) = S::as_simd_f64s(kernel.xs);
    let (ys, y_rest) = S::as_simd_f64s(kernel.ys);
    for (&x, &y) in xs.iter().zip(ys) {
        let (f, squared_gradient) = evaluate::<S, N>(simd, kernel.f, x, y);
        let squared = simd.mul_f64s(f, f);
        algebraic = simd.add_f64s(algebraic, squared);
        geometric = simd.add_f64s(geometric, simd.div_f64s(squared, squared_gradient));
    }
    let mut sums = (simd.reduce_sum_f64s(algebraic), simd.reduce_sum_f64s(geometric));
    for (&x, &y) in x_rest.iter().zip(y_rest) {
        let (f, squared_gradient) = evaluate::<pulp::Scalar, N>(pulp::Scalar, kernel.f, x, y);
        sums.0 += f * f;
        sums.1 += f * f / squared_gradient;
    }
    sums
}

/// f and `|grad f|^2` by Horner's rule in y over Horner's rule in x.
#[inline(always)]
fn evaluate<S: Simd, const N: usize>(simd: S, f: &ImplicitPolynomial, x: S::f64s, y: S::f64s) -> (S::f64s, S::f64s) {
    let coefficients = f.coefficients();
    // Keeps a point where the gradient vanishes from dividing by zero; far below any gradient of a fit.
    let tiny = simd.splat_f64s(1e-100);
    let zero = simd.splat_f64s(0.0);
    let (mut value, mut by_x, mut by_y) = (zero, zero, zero);
    for j in (0..=N).rev() {
        let (mut row, mut row_by_x) = (zero, zero);
        for i in (0..=(N - j)).rev() {
            row_by_x = simd.mul_add_e_f64s(row_by_x, x, row);
            row = simd.mul_add_e_f64s(row, x, simd.splat_f64s(coefficients[monomial_index(i, j)]));
        }
        by_y = simd.mul_add_e_f64s(by_y, y, value);
        value = simd.mul_add_e_f64s(value, y, row);
        by_x = simd.mul_add_e_f64s(by_x, y, row_by_x);
    }
    (value, simd.mul_add_e_f64s(by_x, by_x, simd.mul_add_e_f64s(by_y, by_y, tiny)))
}

#[cfg(test)]
mod tests {
    use nalgebra::Point2;

    use super::*;

    #[test]
    fn the_vectorised_residuals_agree_with_point_by_point_evaluation() {
        for degree in Degree::ALL {
            let coefficients: Vec<f64> =
                (0..degree.coefficient_count()).map(|k| (1.3 * k as f64 + 0.4).sin()).collect();
            let f = ImplicitPolynomial::new(degree, &coefficients).expect("finite");
            for count in [1_usize, 3, 4, 19, 64] {
                let xs: Vec<f64> = (0..count).map(|i| (0.7 * i as f64).sin()).collect();
                let ys: Vec<f64> = (0..count).map(|i| (0.3 * i as f64).cos()).collect();
                let (mut algebraic, mut geometric) = (0.0, 0.0);
                for (&x, &y) in xs.iter().zip(&ys) {
                    let (value, gradient, _) = f.value_and_derivatives(&Point2::new(x, y));
                    algebraic += value * value / count as f64;
                    geometric += value * value / gradient.norm_squared() / count as f64;
                }
                let residuals = Residuals::of(&f, &xs, &ys);
                assert!((residuals.algebraic - algebraic.sqrt()).abs() < 1e-12);
                assert!((residuals.geometric - geometric.sqrt()).abs() < 1e-9 * (1.0 + geometric.sqrt()));
            }
        }
    }
}
