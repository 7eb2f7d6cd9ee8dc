//! The least-squares leading form that is at least a floor on the unit circle, by an interior-point method.
//!
//! A binary form of degree 2m is non-negative if and only if it is a sum of squares, `h = v' Y v` with Y positive
//! semidefinite and `v_k = sqrt(m over k) x^(m-k) y^k`. With this v, `|v|^2 = (x^2 + y^2)^m`, so rotation acts on Y by
//! orthogonal matrices, and `h - floor (x^2 + y^2)^m` being a sum of squares says exactly that h >= floor on the circle.
//! What is left is a least-squares problem over a small positive semidefinite matrix, solved by a primal-dual
//! predictor-corrector interior-point method with the direction of Helmberg, Rendl, Vanderbei, Wolkowicz (1996) and Kojima, Shindoh, Hara
//! (1997).
use nalgebra::{SMatrix, SVector};

use crate::{error::FitError, least_squares::TriangularSystem, ridge::binomial};

/// The solution is the point of the central path with this duality gap, in a problem scaled to size 1. Ending on the
/// path, a smooth function of the data, rather than near its end makes the fit move with the data to rounding.
const FINAL_GAP: f64 = 1e-13;
/// Full Newton steps towards that point before it is taken as reached.
const FINAL_STEPS: usize = 2;
/// Where rounding allows no more progress, this is still accepted: every point of the path is bounded, and the fit is
/// then this close to optimal. Measured where the constraint is hard: below 1e-12 for quartics, 1e-10 for sextics, 1e-6
/// for octics, whose monomials are nearly dependent.
const ACCEPTED_GAP: f64 = 1e-5;
const MINIMAL_STEP: f64 = 1e-7;
const MAX_ITERATIONS: usize = 80;
/// Steps stop short of the boundary of the positive semidefinite cone by this fraction.
const FRACTION_TO_BOUNDARY: f64 = 0.97;
const BACKTRACKING: f64 = 0.85;

/// `min |A y - b|^2 / 2` over positive semidefinite Y of ROWS = m + 1 rows. The UNKNOWNS = ROWS (ROWS + 1) / 2 entries
/// of y are the upper triangle of Y by rows, those off the diagonal times sqrt 2, so that inner products of vectors and
/// of matrices are the same. FORM = 2m + 1 coefficients.
pub(crate) struct GramProblem<const ROWS: usize, const UNKNOWNS: usize, const FORM: usize> {
    /// The form from y.
    form_from_gram: SMatrix<f64, FORM, UNKNOWNS>,
    /// `floor (x^2 + y^2)^m`.
    floor_form: SVector<f64, FORM>,
    /// `A'A`.
    normal: SMatrix<f64, UNKNOWNS, UNKNOWNS>,
    /// `A'b`.
    projection: SVector<f64, UNKNOWNS>,
    /// Factor between y and the scaled unknowns.
    unit: f64,
}

/// Changes of the primal and the dual matrix, the gap they aim at, and how much of them may be taken.
struct Step<const ROWS: usize> {
    primal: SMatrix<f64, ROWS, ROWS>,
    dual: SMatrix<f64, ROWS, ROWS>,
    target: f64,
    length: f64,
}

impl<const ROWS: usize, const UNKNOWNS: usize, const FORM: usize> GramProblem<ROWS, UNKNOWNS, FORM> {
    /// Writes the best leading form that is at least `floor` on the circle to `form`; it starts at coefficient `first`.
    pub(crate) fn solve_floor(
        system: &TriangularSystem,
        first: usize,
        floor: f64,
        form: &mut [f64],
    ) -> Result<(), FitError> {
        Self::new(system, first, floor).solve(form)
    }

    fn new(system: &TriangularSystem, first: usize, floor: f64) -> Self {
        let m = ROWS - 1;
        let mut form_from_gram = SMatrix::zeros();
        for (column, (k, l)) in upper_triangle::<ROWS>().enumerate() {
            let twice = if k == l { 1.0 } else { std::f64::consts::SQRT_2 };
            form_from_gram[(k + l, column)] = twice * (binomial(m, k) * binomial(m, l)).sqrt();
        }
        let mut floor_form = SVector::zeros();
        (0..=m).for_each(|k| floor_form[2 * k] = floor * binomial(m, k));
        let weight =
            SMatrix::<f64, FORM, FORM>::from_fn(|i, j| if i <= j { system.upper(first + i, first + j) } else { 0.0 });
        let right = SVector::<f64, FORM>::from_fn(|i, _| system.right()[first + i]);
        let matrix = weight * form_from_gram;
        let target = right - weight * floor_form;
        // Units in which the matrix and the solution are about 1.
        let norm = matrix.norm();
        let unit = target.norm() / norm;
        let matrix = matrix / norm;
        let projection = matrix.transpose() * target / target.norm();
        Self { form_from_gram, floor_form, normal: matrix.transpose() * matrix, projection, unit }
    }

    fn solve(&self, form: &mut [f64]) -> Result<(), FitError> {
        let mut primal = SMatrix::<f64, ROWS, ROWS>::identity();
        let mut dual = SMatrix::<f64, ROWS, ROWS>::identity();
        let mut full_steps = 0;
        for iteration in 0.. {
            let gap = primal.dot(&dual) / ROWS as f64;
            let length = match self.step(&primal, &dual, gap) {
                Some(step) if iteration < MAX_ITERATIONS => {
                    primal += step.length * step.primal;
                    dual += step.length * step.dual;
                    let arrived = step.target <= FINAL_GAP && step.length == 1.0;
                    full_steps = if arrived { full_steps + 1 } else { 0 };
                    step.length
                }
                _ => 0.0,
            };
            if full_steps == FINAL_STEPS {
                break;
            }
            if length < MINIMAL_STEP {
                // Rounding leaves nothing more to gain.
                let residual = (self.normal * Self::vector(&primal) - self.projection - Self::vector(&dual)).norm();
                if gap > ACCEPTED_GAP || residual > ACCEPTED_GAP {
                    return Err(FitError::NoConvergence { iterations: iteration });
                }
                break;
            }
        }
        let solution = self.floor_form + self.unit * (self.form_from_gram * Self::vector(&primal));
        form.copy_from_slice(solution.as_slice());
        Ok(())
    }

    /// One step along the central path, predicted and corrected (Mehrotra 1992). Towards the point where the product of
    /// the two matrices is `target` times identity it solves `dZ + sym(Y^-1 dY Z) = target Y^-1 - Z` and
    /// `A'A (y + dy) - A'b = z + dz`.
    fn step(&self, primal: &SMatrix<f64, ROWS, ROWS>, dual: &SMatrix<f64, ROWS, ROWS>, gap: f64) -> Option<Step<ROWS>> {
        let y = Self::vector(primal);
        let inverse = primal.cholesky()?.inverse();
        let factor = (self.normal + Self::scaling(&inverse, dual)).cholesky()?;
        let gradient = self.normal * y - self.projection;
        let directions = |right: &SVector<f64, UNKNOWNS>| {
            let step = factor.solve(&(right - gradient));
            (Self::matrix(&step), Self::matrix(&(self.normal * (y + step) - self.projection)) - dual)
        };
        // Straight to the end of the path, to see how far that leads; the rest of the way is curved by the product of
        // the two changes.
        let (primal_ahead, dual_ahead) = directions(&SVector::zeros());
        let ahead = step_length(primal, &primal_ahead).min(step_length(dual, &dual_ahead));
        let gap_ahead = (primal + ahead * primal_ahead).dot(&(dual + ahead * dual_ahead)) / ROWS as f64;
        let target = (gap * (gap_ahead / gap).powi(3)).clamp(FINAL_GAP, gap.max(FINAL_GAP));
        let product = inverse * primal_ahead * dual_ahead;
        let curved = 0.5 * (product + product.transpose());
        let (primal_step, dual_step) = directions(&(target * Self::vector(&inverse) - Self::vector(&curved)));
        let length = step_length(primal, &primal_step).min(step_length(dual, &dual_step));
        Some(Step { primal: primal_step, dual: dual_step, target, length })
    }

    /// The operator `D -> (Y^-1 D Z + Z D Y^-1) / 2` on vectors.
    fn scaling(
        inverse: &SMatrix<f64, ROWS, ROWS>,
        dual: &SMatrix<f64, ROWS, ROWS>,
    ) -> SMatrix<f64, UNKNOWNS, UNKNOWNS> {
        let mut operator = SMatrix::zeros();
        for (column, (p, q)) in upper_triangle::<ROWS>().enumerate() {
            for (row, (k, l)) in upper_triangle::<ROWS>().enumerate().skip(column) {
                let product = |i: usize, j: usize, r: usize, s: usize| inverse[(i, r)] * dual[(s, j)];
                let all = product(k, l, p, q) + product(k, l, q, p) + product(l, k, p, q) + product(l, k, q, p);
                let weight = |i, j| if i == j { std::f64::consts::FRAC_1_SQRT_2 } else { 1.0 };
                operator[(row, column)] = 0.5 * weight(k, l) * weight(p, q) * all;
                operator[(column, row)] = operator[(row, column)];
            }
        }
        operator
    }

    fn vector(matrix: &SMatrix<f64, ROWS, ROWS>) -> SVector<f64, UNKNOWNS> {
        let mut vector = SVector::<f64, UNKNOWNS>::zeros();
        for (slot, (k, l)) in vector.iter_mut().zip(upper_triangle::<ROWS>()) {
            *slot = if k == l { matrix[(k, k)] } else { std::f64::consts::SQRT_2 * matrix[(k, l)] };
        }
        vector
    }

    fn matrix(vector: &SVector<f64, UNKNOWNS>) -> SMatrix<f64, ROWS, ROWS> {
        let mut matrix = SMatrix::zeros();
        for (&value, (k, l)) in vector.iter().zip(upper_triangle::<ROWS>()) {
            let value = if k == l { value } else { std::f64::consts::FRAC_1_SQRT_2 * value };
            (matrix[(k, l)], matrix[(l, k)]) = (value, value);
        }
        matrix
    }
}

fn upper_triangle<const ROWS: usize>() -> impl Iterator<Item = (usize, usize)> {
    (0..ROWS).flat_map(|k| (k..ROWS).map(move |l| (k, l)))
}

/// A step, at most 1, after which the matrix is still positive definite, with some room.
fn step_length<const ROWS: usize>(from: &SMatrix<f64, ROWS, ROWS>, step: &SMatrix<f64, ROWS, ROWS>) -> f64 {
    let mut length = 1.0;
    while length > 0.1 * MINIMAL_STEP && !is_positive_definite(from + (length / FRACTION_TO_BOUNDARY) * step) {
        length *= BACKTRACKING;
    }
    length
}

/// Whether all pivots of a symmetric elimination are positive: a Cholesky factorisation without its square roots.
fn is_positive_definite<const ROWS: usize>(mut matrix: SMatrix<f64, ROWS, ROWS>) -> bool {
    for k in 0..ROWS {
        let pivot = matrix[(k, k)];
        if pivot.is_nan() || pivot <= 0.0 {
            return false;
        }
        for j in k + 1..ROWS {
            let factor = matrix[(j, k)] / pivot;
            for i in j..ROWS {
                matrix[(i, j)] -= factor * matrix[(i, k)];
            }
        }
    }
    true
}
