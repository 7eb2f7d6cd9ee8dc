use nalgebra::Point2;

use crate::{
    bounded_polynomial::BoundedPolynomial, degree::MAX_COEFFICIENTS, image_rows::ImageRows, isoline,
    normalisation::Normalisation, polynomial::ImplicitPolynomial, rectangle::Rectangle,
};

/// Cells along the longer side of the rectangle that a curve is looked for in.
const CURVE_CELLS: usize = 160;

/// Which factorisation a fit came from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Factorisation {
    /// Cholesky of the Gram matrix, from the moment sums.
    Gram,
    /// QR of the tall matrix, taken where the Gram matrix is too ill-conditioned.
    Orthogonal,
}

/// What a fit says of itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FitDiagnostics {
    /// Minimum of the leading form on the unit circle of the working coordinates over its root mean square there: the curve is
    /// closed and bounded if it is positive, certainly not if it is negative; 1 for a circular leading form.
    pub boundedness_margin: f64,
    /// Whether the boundedness constraint changed the solution.
    pub constraint_active: bool,
    /// Estimated condition number of the least-squares matrix with columns scaled to length 1.
    pub condition: f64,
    /// Root mean square of f over the points, where the outer level sets are at -1 and +1.
    pub algebraic_residual: f64,
    /// Root mean square first-order distance of the points from the curve (Taubin 1991), in image units.
    pub geometric_residual: f64,
    /// Number of points of the outline.
    pub point_count: usize,
    /// How the least-squares problem was solved.
    pub factorisation: Factorisation,
}

/// A polynomial fitted to one outline, in working coordinates, with where those are and how good it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fit {
    pub(crate) normalisation: Normalisation,
    pub(crate) working: ImplicitPolynomial,
    pub(crate) diagnostics: FitDiagnostics,
}

impl Fit {
    /// The polynomial in image coordinates. Exact, but far from the origin (beyond some hundred times the size of the
    /// object) its coefficients alone no longer carry the shape: use [`working`](Self::working) there.
    ///
    /// # Panics
    /// Never: a fit whose stretch takes its coefficients beyond any number cannot be made.
    #[must_use]
    pub fn polynomial(&self) -> ImplicitPolynomial {
        // Substituting (p - centre) / radius directly costs a few hundred operations; a general map far more.
        let scale = 1.0 / self.normalisation.radius;
        let shift = -scale * self.normalisation.centre.coords;
        if !self.normalisation.is_affine() {
            return substitute_scaled_shift(&self.working, scale, &Point2::from(shift));
        }
        let unstretched = self.working.moved(&self.normalisation.stretching()).expect("finite when it was fitted");
        substitute_scaled_shift(&unstretched, scale, &Point2::from(shift))
    }

    /// The polynomial in working coordinates, where the data has mean 0 and RMS radius 1 (about that in
    /// [`Fitter::fit_in`](crate::Fitter::fit_in)) and f is about the signed distance from the outline over the level-set offset.
    #[must_use]
    pub fn working(&self) -> &ImplicitPolynomial {
        &self.working
    }

    /// The polynomial in working coordinates, if its curve is closed and bounded.
    #[must_use]
    pub fn bounded_working(&self) -> Option<BoundedPolynomial> {
        BoundedPolynomial::with_margin(self.working, self.diagnostics.boundedness_margin)
    }

    /// Where the working coordinates are.
    #[must_use]
    pub fn normalisation(&self) -> &Normalisation {
        &self.normalisation
    }

    /// How good the fit is.
    #[must_use]
    pub fn diagnostics(&self) -> &FitDiagnostics {
        &self.diagnostics
    }

    /// Whether the curve is closed and bounded.
    #[must_use]
    pub fn is_bounded(&self) -> bool {
        self.diagnostics.boundedness_margin > 0.0
    }

    /// The curve `f = 0` within a rectangle of the image, as lines to be drawn: its open and closed parts, closed ones with
    /// their first point repeated, as [`isoline::of_function`] finds them on 160 cells along the longer side.
    #[must_use]
    pub fn curve_within(&self, rectangle: &Rectangle) -> Vec<Vec<Point2<f64>>> {
        let f = |p: &Point2<f64>| self.working.evaluate(&self.normalisation.to_working(p));
        let rows = ImageRows::of(&self.working, &self.normalisation);
        isoline::of_rows(|xs, y, values| rows.evaluate(xs, y, values), f, rectangle, CURVE_CELLS)
    }
}

/// `f(scale p + shift)` by Taylor shifts, first in x, then in y.
fn substitute_scaled_shift(f: &ImplicitPolynomial, scale: f64, shift: &Point2<f64>) -> ImplicitPolynomial {
    let n = f.degree().value();
    let mut table = [[0.0; 9]; 9];
    for (i, row) in table.iter_mut().enumerate().take(n + 1) {
        for (j, entry) in row.iter_mut().enumerate().take(n + 1 - i) {
            *entry = f.coefficient(i, j);
        }
        taylor_shift(&mut row[..=n - i], shift.y);
    }
    for j in 0..=n {
        let mut column = [0.0; 9];
        (0..=n - j).for_each(|i| column[i] = table[i][j]);
        taylor_shift(&mut column[..=n - j], shift.x);
        (0..=n - j).for_each(|i| table[i][j] = column[i]);
    }
    let mut coefficients = [0.0; MAX_COEFFICIENTS];
    for ((i, j), a) in crate::monomials::exponents(n).zip(&mut coefficients) {
        *a = table[i][j] * scale.powi((i + j) as i32);
    }
    ImplicitPolynomial::from_array(f.degree(), coefficients)
}

/// Coefficients of `p(t + shift)` from those of `p(t)`, lowest first, by repeated synthetic division.
fn taylor_shift(coefficients: &mut [f64], shift: f64) {
    let n = coefficients.len();
    for start in 0..n {
        for k in (start..n - 1).rev() {
            coefficients[k] += shift * coefficients[k + 1];
        }
    }
}
