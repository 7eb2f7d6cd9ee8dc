use freeform_curve_fit::{Degree, ImplicitPolynomial, PolynomialError, exponents, monomial_index};
use nalgebra::{DMatrix, Matrix3};

use crate::coefficient_map::map_coefficients;

/// The motion of a whole curve: its coefficient vector moves by `a' = L a`, the lift of `P' = A P`.
///
/// It is the whole curve's form of equations 5 to 8, with no roots, chart or pairing, for every degree and every 3x3
/// generator. L is linear in A, so `L = sum theta_j L_j` with the lifts `L_j` of the basis matrices of a
/// [`MotionModel`](crate::MotionModel). With F the homogeneous form of f, `F(T P)` is carried along unchanged, hence
/// `F' = -grad F . (A P)`. A last row `(c1, c2, c3)` acts on the coefficients as
/// [`ImplicitPolynomial::projected`] does: `w^n f'(p') = f(p)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lift {
    degree: Degree,
    generator: Matrix3<f64>,
}

impl Lift {
    /// Lift of a generator to polynomials of a degree.
    #[must_use]
    pub const fn new(degree: Degree, generator: Matrix3<f64>) -> Self {
        Self { degree, generator }
    }

    /// Writes `L a`, in graded order, without allocating.
    ///
    /// # Panics
    /// If `coefficients` or `out` does not have `(n + 1)(n + 2) / 2` entries.
    pub fn apply(&self, coefficients: &[f64], out: &mut [f64]) {
        let count = self.degree.coefficient_count();
        assert_eq!(coefficients.len(), count, "number of coefficients");
        assert_eq!(out.len(), count, "number of coefficients to write");
        out.fill(0.0);
        self.for_each_entry(|row, column, value| out[row] += value * coefficients[column]);
    }

    /// L as a dense matrix, `a' = L a`.
    #[must_use]
    pub fn matrix(&self) -> DMatrix<f64> {
        let count = self.degree.coefficient_count();
        let mut matrix = DMatrix::zeros(count, count);
        self.for_each_entry(|row, column, value| matrix[(row, column)] += value);
        matrix
    }

    /// The derivative of a moving polynomial with respect to time, `a' = L a`, per second.
    ///
    /// # Errors
    /// A polynomial of another degree, or a derivative that is not finite.
    pub fn rate(&self, polynomial: &ImplicitPolynomial) -> Result<ImplicitPolynomial, PolynomialError> {
        map_coefficients(self.degree, polynomial, |coefficients, out| self.apply(coefficients, out))
    }

    /// Visits the contributions to L as `(row, column, value)`. Each monomial changes into at most seven.
    fn for_each_entry(&self, mut visit: impl FnMut(usize, usize, f64)) {
        let n = self.degree.value();
        let a = &self.generator;
        let affine = a.row(2).iter().all(|&e| e == 0.0);
        for (column, (i, j)) in exponents(n).enumerate() {
            let k = n - i - j;
            let (fi, fj, fk) = (i as f64, j as f64, k as f64);
            // d/dx of the monomial times the x-velocity, then y, then the homogenising variable.
            visit(column, column, -(fi * a[(0, 0)] + fj * a[(1, 1)] + fk * a[(2, 2)]));
            if i > 0 {
                visit(monomial_index(i - 1, j + 1), column, -fi * a[(0, 1)]);
                visit(monomial_index(i - 1, j), column, -fi * a[(0, 2)]);
            }
            if j > 0 {
                visit(monomial_index(i + 1, j - 1), column, -fj * a[(1, 0)]);
                visit(monomial_index(i, j - 1), column, -fj * a[(1, 2)]);
            }
            if k > 0 && !affine {
                visit(monomial_index(i + 1, j), column, -fk * a[(2, 0)]);
                visit(monomial_index(i, j + 1), column, -fk * a[(2, 1)]);
            }
        }
    }
}
