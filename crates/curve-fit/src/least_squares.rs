use faer::{
    MatMut, MatRef, Par,
    dyn_stack::{MemBuffer, MemStack},
    linalg::{
        cholesky::llt::factor::{cholesky_in_place, cholesky_in_place_scratch},
        triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place},
    },
    prelude::default,
};
use nalgebra::DMatrix;

use crate::{
    degree::{MAX_COEFFICIENTS, coefficient_count},
    error::FitError,
    level_set_moments::LevelSetMoments,
    monomials::{exponents, monomial_index},
};

/// Beyond this condition number of the least-squares matrix its Gram matrix has lost half the digits that matter, and
/// the orthogonal factorisation takes over.
pub(crate) const GRAM_CONDITION_LIMIT: f64 = 1e5;

/// Beyond this condition number the coefficients are not determined.
const RANK_CONDITION_LIMIT: f64 = 1e12;

/// A least-squares problem reduced to triangular form, `min |L' a - y|^2`: what the Cholesky factorisation of the Gram
/// matrix and the QR factorisation of the tall matrix both end in.
#[derive(Debug, Clone)]
pub(crate) struct TriangularSystem {
    size: usize,
    /// Lower triangle by columns, `size` by `size` in front.
    lower: [f64; MAX_COEFFICIENTS * MAX_COEFFICIENTS],
    right: [f64; MAX_COEFFICIENTS],
    condition: f64,
    scratch: Scratch,
}

/// Workspace of the factorisation; a copy of a system gets one of its own.
struct Scratch(MemBuffer);

impl std::fmt::Debug for Scratch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Scratch")
    }
}

impl Scratch {
    fn new() -> Self {
        Self(MemBuffer::new(cholesky_in_place_scratch::<f64>(MAX_COEFFICIENTS, Par::Seq, default())))
    }
}

impl Clone for Scratch {
    fn clone(&self) -> Self {
        Self::new()
    }
}

impl TriangularSystem {
    pub(crate) fn new() -> Self {
        Self {
            size: 0,
            lower: [0.0; MAX_COEFFICIENTS * MAX_COEFFICIENTS],
            right: [0.0; MAX_COEFFICIENTS],
            condition: f64::INFINITY,
            scratch: Scratch::new(),
        }
    }

    /// From the sums over the three level sets, and a ridge to be added to the diagonal. Returns whether the Gram matrix
    /// was well-conditioned enough to be relied on.
    pub(crate) fn factor_gram(&mut self, degree: usize, level_sets: &LevelSetMoments, ridge: &[f64]) -> bool {
        let size = coefficient_count(degree);
        self.size = size;
        let LevelSetMoments { gram, projection, .. } = level_sets;
        let mut scale = [0.0; MAX_COEFFICIENTS];
        for (position, (i, j)) in exponents(degree).enumerate() {
            scale[position] = (gram[monomial_index(2 * i, 2 * j)] + ridge[position]).sqrt();
        }
        for (column, (k, l)) in exponents(degree).enumerate() {
            for (row, (i, j)) in exponents(degree).enumerate().skip(column) {
                let sum = gram[monomial_index(i + k, j + l)];
                self.lower[column * size + row] = sum / (scale[row] * scale[column]);
            }
            // The diagonal of the scaled matrix, with the ridge in it, is 1.
            self.lower[column * size + column] = 1.0;
            self.right[column] = projection[column] / scale[column];
        }
        let matrix = MatMut::from_column_major_slice_mut(&mut self.lower[..size * size], size, size);
        let stack = MemStack::new(&mut self.scratch.0);
        if cholesky_in_place(matrix, default(), Par::Seq, stack, default()).is_err() {
            self.condition = f64::INFINITY;
            return false;
        }
        self.condition = diagonal_condition((0..size).map(|i| self.lower[i * size + i]));
        let factor = MatRef::from_column_major_slice(&self.lower[..size * size], size, size);
        let right = MatMut::from_column_major_slice_mut(&mut self.right[..size], size, 1);
        solve_lower_triangular_in_place(factor, right, Par::Seq);
        for (column, values) in self.lower[..size * size].chunks_exact_mut(size).enumerate() {
            values[column..].iter_mut().zip(&scale[column..]).for_each(|(value, s)| *value *= s);
        }
        self.condition < GRAM_CONDITION_LIMIT
    }

    /// From the tall matrix itself (rows by `size`, by columns) and its right-hand side, by QR: the reference that the
    /// Gram route is tested against, and the fallback where that is too ill-conditioned. Allocates.
    ///
    /// # Errors
    /// The columns are linearly dependent.
    pub(crate) fn factor_rows(&mut self, rows: &DMatrix<f64>, right: &[f64]) -> Result<(), FitError> {
        let size = rows.ncols();
        let norms: Vec<f64> = rows.column_iter().map(|c| c.norm()).collect();
        let matrix = MatRef::from_column_major_slice(rows.as_slice(), rows.nrows(), size);
        let scaled = faer::Mat::from_fn(rows.nrows(), size, |i, j| matrix[(i, j)] / norms[j]);
        let qr = scaled.qr();
        let upper = qr.thin_R();
        self.size = size;
        self.condition = diagonal_condition((0..size).map(|i| upper[(i, i)].abs()));
        self.check_rank_of((0..size).map(|i| upper[(i, i)].abs()))?;
        let projected = qr.compute_thin_Q().transpose() * MatRef::from_column_major_slice(right, right.len(), 1);
        for i in 0..size {
            // A positive diagonal, as Cholesky gives.
            let sign = 1.0_f64.copysign(upper[(i, i)]);
            for j in i..size {
                self.lower[i * size + j] = sign * upper[(i, j)] * norms[j];
            }
            self.right[i] = sign * projected[(i, 0)];
        }
        Ok(())
    }

    fn check_rank_of(&self, diagonal: impl Iterator<Item = f64> + Clone) -> Result<(), FitError> {
        let largest = diagonal.clone().fold(0.0, f64::max);
        let rank = diagonal.filter(|&r| r * RANK_CONDITION_LIMIT > largest).count();
        if rank < self.size || !self.condition.is_finite() {
            return Err(FitError::RankDeficient { rank, needed: self.size, condition: self.condition });
        }
        Ok(())
    }

    /// Estimated condition number of the least-squares matrix with columns scaled to length 1: the ratio of the extreme
    /// diagonal entries of its triangular factor, a lower bound of the true one.
    pub(crate) fn condition(&self) -> f64 {
        self.condition
    }

    /// Entry of the triangular matrix `L'`: row, then column, `row <= column`.
    pub(crate) fn upper(&self, row: usize, column: usize) -> f64 {
        self.lower[row * self.size + column]
    }

    /// Right-hand side y.
    pub(crate) fn right(&self) -> &[f64] {
        &self.right[..self.size]
    }

    /// The unconstrained minimiser, `L' a = y`.
    pub(crate) fn solve(&self, out: &mut [f64]) {
        let size = self.size;
        out[..size].copy_from_slice(self.right());
        let lower = MatRef::from_column_major_slice(&self.lower[..size * size], size, size);
        let solution = MatMut::from_column_major_slice_mut(&mut out[..size], size, 1);
        solve_upper_triangular_in_place(lower.transpose(), solution, Par::Seq);
    }

    /// Inverse of the matrix of the normal equations, `(L L')^-1`. `None` where it is singular.
    pub(crate) fn inverse(&self) -> Option<DMatrix<f64>> {
        let size = self.size;
        let upper = DMatrix::from_fn(size, size, |i, j| if i <= j { self.upper(i, j) } else { 0.0 });
        let inverse = upper.solve_upper_triangular(&DMatrix::identity(size, size))?;
        Some(&inverse * inverse.transpose())
    }

    /// The minimiser over the coefficients before `fixed_from`, with those from there on given in `out`.
    pub(crate) fn solve_leading(&self, fixed_from: usize, out: &mut [f64]) {
        for row in (0..fixed_from).rev() {
            let known: f64 = (row + 1..self.size).map(|column| self.upper(row, column) * out[column]).sum();
            out[row] = (self.right[row] - known) / self.upper(row, row);
        }
    }
}

fn diagonal_condition(diagonal: impl Iterator<Item = f64>) -> f64 {
    let (smallest, largest) = diagonal.fold((f64::INFINITY, 0.0_f64), |(low, high), d| (low.min(d), high.max(d)));
    if smallest > 0.0 { largest / smallest } else { f64::INFINITY }
}
