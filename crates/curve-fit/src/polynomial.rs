use nalgebra::{Affine2, Matrix2, Matrix3, Point2, Projective2, Vector2};

use crate::{
    degree::{Degree, MAX_COEFFICIENTS, coefficient_count},
    error::PolynomialError,
    monomials::{evaluate_monomials, exponents, monomial_index},
};

/// Implicit polynomial `f(x, y) = sum a_ij x^i y^j`, `0 <= i + j <= n`, of even degree n.
///
/// Its curve is the level set `f = 0`. A fitted polynomial is negative inside and positive outside. Coefficients stand
/// in graded order: `1; x, y; x^2, xy, y^2; ...` (see [`monomial_index`](crate::monomial_index)).
#[derive(Clone, Copy, PartialEq)]
pub struct ImplicitPolynomial {
    degree: Degree,
    coefficients: [f64; MAX_COEFFICIENTS],
}

impl ImplicitPolynomial {
    /// From coefficients in graded order.
    ///
    /// # Errors
    /// A number of coefficients other than `(n + 1)(n + 2) / 2`, or one that is not finite.
    pub fn new(degree: Degree, coefficients: &[f64]) -> Result<Self, PolynomialError> {
        let needed = degree.coefficient_count();
        if coefficients.len() != needed {
            let (degree, found) = (degree.value(), coefficients.len());
            return Err(PolynomialError::WrongCoefficientCount { degree, found, needed });
        }
        if let Some(index) = coefficients.iter().position(|a| !a.is_finite()) {
            return Err(PolynomialError::NotFinite { index });
        }
        let mut padded = [0.0; MAX_COEFFICIENTS];
        padded[..needed].copy_from_slice(coefficients);
        Ok(Self { degree, coefficients: padded })
    }

    /// From finite coefficients that already stand in a padded array.
    pub(crate) fn from_array(degree: Degree, coefficients: [f64; MAX_COEFFICIENTS]) -> Self {
        Self { degree, coefficients }
    }

    /// Degree n.
    #[must_use]
    pub const fn degree(&self) -> Degree {
        self.degree
    }

    /// Coefficients in graded order, `(n + 1)(n + 2) / 2` of them.
    #[must_use]
    pub fn coefficients(&self) -> &[f64] {
        &self.coefficients[..self.degree.coefficient_count()]
    }

    /// Coefficient `a_ij` of `x^i y^j`, 0 beyond the degree.
    #[must_use]
    pub fn coefficient(&self, i: usize, j: usize) -> f64 {
        if i + j > self.degree.value() { 0.0 } else { self.coefficients[monomial_index(i, j)] }
    }

    /// Coefficients of the homogeneous part of degree d, those of `x^d, x^(d-1) y, ..., y^d`.
    ///
    /// # Panics
    /// If `d` is beyond the degree.
    #[must_use]
    pub fn homogeneous_part(&self, d: usize) -> &[f64] {
        &self.coefficients()[d * (d + 1) / 2..coefficient_count(d)]
    }

    /// Coefficients of the homogeneous part of degree n, the leading form: `n + 1` of them.
    #[must_use]
    pub fn leading_form(&self) -> &[f64] {
        self.homogeneous_part(self.degree.value())
    }

    /// Value f(p).
    #[must_use]
    pub fn evaluate(&self, p: &Point2<f64>) -> f64 {
        let mut monomials = [0.0; MAX_COEFFICIENTS];
        evaluate_monomials(self.degree.value(), p.x, p.y, &mut monomials);
        self.coefficients().iter().zip(&monomials).map(|(a, m)| a * m).sum()
    }

    /// Gradient `(df/dx, df/dy)` at p.
    #[must_use]
    pub fn gradient(&self, p: &Point2<f64>) -> Vector2<f64> {
        self.value_and_derivatives(p).1
    }

    /// Matrix of second derivatives at p.
    #[must_use]
    pub fn hessian(&self, p: &Point2<f64>) -> Matrix2<f64> {
        self.value_and_derivatives(p).2
    }

    /// Value, gradient and Hessian at p in one pass.
    #[must_use]
    pub fn value_and_derivatives(&self, p: &Point2<f64>) -> (f64, Vector2<f64>, Matrix2<f64>) {
        let n = self.degree.value();
        let mut monomials = [0.0; MAX_COEFFICIENTS];
        evaluate_monomials(n, p.x, p.y, &mut monomials);
        let at = |i: usize, j: usize| monomials[monomial_index(i, j)];
        let (mut value, mut gradient, mut hessian) = (0.0, Vector2::zeros(), Matrix2::zeros());
        for ((i, j), &a) in exponents(n).zip(self.coefficients()) {
            let (fi, fj) = (i as f64, j as f64);
            value += a * at(i, j);
            if i > 0 {
                gradient.x += a * fi * at(i - 1, j);
            }
            if j > 0 {
                gradient.y += a * fj * at(i, j - 1);
            }
            if i > 1 {
                hessian[(0, 0)] += a * fi * (fi - 1.0) * at(i - 2, j);
            }
            if i > 0 && j > 0 {
                hessian[(0, 1)] += a * fi * fj * at(i - 1, j - 1);
            }
            if j > 1 {
                hessian[(1, 1)] += a * fj * (fj - 1.0) * at(i, j - 2);
            }
        }
        hessian[(1, 0)] = hessian[(0, 1)];
        (value, gradient, hessian)
    }

    /// The polynomial times a number. A positive factor keeps the curve and its inside.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let mut result = *self;
        result.coefficients.iter_mut().for_each(|a| *a *= factor);
        result
    }

    /// The polynomial whose curve is this one moved by an affine map T: `f'(T p) = f(p)`, exactly.
    ///
    /// # Errors
    /// T is singular.
    pub fn moved(&self, map: &Affine2<f64>) -> Result<Self, PolynomialError> {
        self.substituted(map.matrix())
    }

    /// The polynomial whose curve is this one moved by a projective map T. With `T (p, 1) = w (p', 1)` it satisfies
    /// `w^n f'(p') = f(p)`; w^n is positive, so the inside stays inside where T is defined.
    ///
    /// # Errors
    /// T is singular.
    pub fn projected(&self, map: &Projective2<f64>) -> Result<Self, PolynomialError> {
        self.substituted(map.matrix())
    }

    /// Puts the rows of the inverse of `map`, as linear forms, in place of x, y and the homogenising variable.
    fn substituted(&self, map: &Matrix3<f64>) -> Result<Self, PolynomialError> {
        let singular = || PolynomialError::SingularMap { determinant: map.determinant() };
        let inverse = map.try_inverse().ok_or_else(singular)?;
        let n = self.degree.value();
        let powers = [0, 1, 2].map(|row| {
            let linear = [inverse[(row, 2)], inverse[(row, 0)], inverse[(row, 1)]];
            powers_of_linear_form(&linear, n)
        });
        let mut result = [0.0; MAX_COEFFICIENTS];
        for ((i, j), &a) in exponents(n).zip(self.coefficients()) {
            let k = n - i - j;
            let xy = multiply(&powers[0][i], i, &powers[1][j], j);
            let term = multiply(&xy, i + j, &powers[2][k], k);
            result.iter_mut().zip(&term).for_each(|(sum, t)| *sum += a * t);
        }
        Self::new(self.degree, &result[..self.degree.coefficient_count()])
    }
}

impl std::fmt::Debug for ImplicitPolynomial {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ImplicitPolynomial")
            .field("degree", &self.degree)
            .field("coefficients", &self.coefficients())
            .finish()
    }
}

type Padded = [f64; MAX_COEFFICIENTS];

fn powers_of_linear_form(linear: &[f64; 3], n: usize) -> [Padded; 9] {
    let mut powers = [[0.0; MAX_COEFFICIENTS]; 9];
    powers[0][0] = 1.0;
    for k in 1..=n {
        powers[k] = multiply(&powers[k - 1], k - 1, linear, 1);
    }
    powers
}

/// Product of two bivariate polynomials in graded order.
fn multiply(a: &[f64], degree_a: usize, b: &[f64], degree_b: usize) -> Padded {
    let mut product = [0.0; MAX_COEFFICIENTS];
    for ((i, j), &ca) in exponents(degree_a).zip(a) {
        for ((k, l), &cb) in exponents(degree_b).zip(b) {
            product[monomial_index(i + k, j + l)] += ca * cb;
        }
    }
    product
}
