use freeform_curve_fit::{
    Degree, ImplicitPolynomial, MAX_COEFFICIENTS, PolynomialError, coefficient_count, monomial_index,
};
use nalgebra::{DMatrix, Matrix3, TCategory, Transform};

use crate::{coefficient_map::map_coefficients, error::DynamicsError, flow::inverse_of};

/// What a map T of the plane does to the coefficients of an implicit polynomial: they become `T_n a`, with a matrix that
/// depends on T alone, `T_n = expm(L t)` where T is the flow of a motion with the lift L.
///
/// `f'(T p) = f(p)` for an affine map and `w^n f'(p') = f(p)` with `T (p, 1) = w (p', 1)` for a projective one, as
/// [`ImplicitPolynomial::moved`] and [`ImplicitPolynomial::projected`]. Nothing here allocates except [`Transport::matrix`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transport {
    degree: Degree,
    /// Rows: the linear forms `(constant, x, y)` that the old x, y and homogenising variable are of the new ones.
    forms: [[f64; 3]; 3],
}

impl Transport {
    /// Transport of polynomials of a degree by an affine or projective map.
    ///
    /// # Errors
    /// The map is singular or not finite.
    pub fn new<C: TCategory>(degree: Degree, map: &Transform<f64, C, 2>) -> Result<Self, DynamicsError> {
        Ok(Self::from_inverse(degree, &inverse_of(map.matrix())?))
    }

    /// Transport by the map whose inverse is given: for a flow, the flow backwards in time.
    #[must_use]
    pub fn from_inverse(degree: Degree, inverse: &Matrix3<f64>) -> Self {
        Self { degree, forms: [0, 1, 2].map(|row| [inverse[(row, 2)], inverse[(row, 0)], inverse[(row, 1)]]) }
    }

    /// Writes the coefficients of the moved polynomial, in graded order.
    ///
    /// # Panics
    /// If `coefficients` or `out` does not have `(n + 1)(n + 2) / 2` entries.
    pub fn apply(&self, coefficients: &[f64], out: &mut [f64]) {
        let count = self.degree.coefficient_count();
        assert_eq!(coefficients.len(), count, "number of coefficients");
        assert_eq!(out.len(), count, "number of coefficients to write");
        out.fill(0.0);
        self.for_each_column(|index, column| {
            out.iter_mut().zip(column).for_each(|(sum, c)| *sum += coefficients[index] * c);
        });
    }

    /// Writes the matrix `T_n`, column after column.
    ///
    /// # Panics
    /// If `out` does not have the square of `(n + 1)(n + 2) / 2` entries.
    pub fn write_matrix(&self, out: &mut [f64]) {
        let count = self.degree.coefficient_count();
        assert_eq!(out.len(), count * count, "number of matrix entries");
        out.fill(0.0);
        self.for_each_column(|index, column| out[index * count..][..column.len()].copy_from_slice(column));
    }

    /// `T_n` as a dense matrix.
    #[must_use]
    pub fn matrix(&self) -> DMatrix<f64> {
        let count = self.degree.coefficient_count();
        let mut matrix = DMatrix::zeros(count, count);
        self.write_matrix(matrix.as_mut_slice());
        matrix
    }

    /// The moved polynomial.
    ///
    /// # Errors
    /// A polynomial of another degree, or coefficients that are not finite.
    pub fn polynomial(&self, polynomial: &ImplicitPolynomial) -> Result<ImplicitPolynomial, PolynomialError> {
        map_coefficients(self.degree, polynomial, |coefficients, out| self.apply(coefficients, out))
    }

    /// Visits the columns of the matrix: the monomial `x^i y^j` becomes `X^i Y^j W^(n - i - j)` with the linear forms X, Y,
    /// W. A column ends where the degree of that product does, so it may be shorter than the matrix.
    fn for_each_column(&self, mut visit: impl FnMut(usize, &[f64])) {
        let n = self.degree.value();
        let [x, y, w] = &self.forms;
        let mut y_power = [0.0; MAX_COEFFICIENTS];
        y_power[0] = 1.0;
        for j in 0..=n {
            let mut product = y_power;
            for d in j..=n {
                let index = monomial_index(d - j, j);
                match w {
                    [1.0, 0.0, 0.0] => visit(index, &product[..coefficient_count(d)]),
                    _ => {
                        let mut whole = product;
                        (d..n).for_each(|degree| multiply_by_linear_form(&mut whole, degree, w));
                        visit(index, &whole[..coefficient_count(n)]);
                    }
                }
                if d < n {
                    multiply_by_linear_form(&mut product, d, x);
                }
            }
            if j < n {
                multiply_by_linear_form(&mut y_power, j, y);
            }
        }
    }
}

/// Multiplies a polynomial of the given degree in place. Entries beyond its degree must be zero.
fn multiply_by_linear_form(polynomial: &mut [f64; MAX_COEFFICIENTS], degree: usize, [constant, x, y]: &[f64; 3]) {
    // From the highest part down, so that each part reads the next lower one before it is overwritten.
    for d in (1..=degree + 1).rev() {
        let (lower, part) = polynomial.split_at_mut(coefficient_count(d - 1));
        let lower = &lower[d * (d - 1) / 2..];
        part[..=d].iter_mut().for_each(|c| *c *= constant);
        part.iter_mut().zip(lower).for_each(|(c, l)| *c += x * l);
        part[1..].iter_mut().zip(lower).for_each(|(c, l)| *c += y * l);
    }
    polynomial[0] *= constant;
}
