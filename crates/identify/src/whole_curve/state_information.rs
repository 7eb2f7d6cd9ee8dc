//! Information matrix over the coefficients of the curve, the pose and the motion.
use faer::{
    MatMut, MatRef, Par,
    dyn_stack::{MemBuffer, MemStack},
    linalg::{
        cholesky::llt::factor::{cholesky_in_place, cholesky_in_place_scratch},
        triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place},
    },
    prelude::default,
};
use freeform_curve_fit::MAX_COEFFICIENTS;
use nalgebra::{DMatrix, SMatrix};

use crate::{
    estimate::MAX_PARAMETERS,
    motion_algebra::{CoordinateMatrix, Coordinates},
};

/// Coefficients, pose and motion of the largest degree and model.
pub(super) const MAX_STATE: usize = MAX_COEFFICIENTS + 2 * MAX_PARAMETERS;
/// Added to the unit diagonal of a scaled matrix before it is factored: the rounding of its entries.
const ROUNDING: f64 = 1e-13;

/// A frame linearised about a curve in a pose: `G`, `G A` and `A' G A`, A being the rate of change of the coefficients with the
/// pose.
#[derive(Debug, Clone)]
pub(super) struct Linearised {
    /// Columns of `G A`.
    pub(super) slopes: [[f64; MAX_COEFFICIENTS]; MAX_PARAMETERS],
    /// `A' G A`.
    pub(super) pose: CoordinateMatrix,
}

/// Symmetric, in the order coefficients, pose, motion; all buffers are kept.
#[derive(Debug, Clone)]
pub(super) struct StateInformation {
    pub(super) coefficients: usize,
    pub(super) k: usize,
    /// By columns.
    pub(super) matrix: Vec<f64>,
    /// The same with the frame at hand.
    joined: Vec<f64>,
    factor: Vec<f64>,
    scratch: Scratch,
}

/// Workspace of the factorisation; a copy gets one of its own.
struct Scratch(MemBuffer);

impl std::fmt::Debug for Scratch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Scratch")
    }
}

impl Clone for Scratch {
    fn clone(&self) -> Self {
        Self::new()
    }
}

impl Scratch {
    fn new() -> Self {
        Self(MemBuffer::new(cholesky_in_place_scratch::<f64>(MAX_STATE, Par::Seq, default())))
    }
}

impl StateInformation {
    pub(super) fn new(coefficients: usize, k: usize) -> Self {
        let size = (coefficients + 2 * k).pow(2);
        Self {
            coefficients,
            k,
            matrix: vec![0.0; size],
            joined: vec![0.0; size],
            factor: vec![0.0; size],
            scratch: Scratch::new(),
        }
    }

    pub(super) fn size(&self) -> usize {
        self.coefficients + 2 * self.k
    }

    pub(super) fn add_to_diagonal(&mut self, index: usize, value: f64) {
        let size = self.size();
        self.matrix[index * size + index] += value;
    }

    /// Moves on by one step in which an error of the motion becomes one of the pose, `pose <- pose + C motion`.
    pub(super) fn predict(&mut self, by_motion: &CoordinateMatrix) {
        let (size, k, pose) = (self.size(), self.k, self.coefficients);
        let motion = pose + k;
        for column in self.matrix.chunks_exact_mut(size) {
            for j in 0..k {
                column[motion + j] -= (0..k).map(|i| by_motion[i][j] * column[pose + i]).sum::<f64>();
            }
        }
        for j in 0..k {
            for i in 0..k {
                let (before, after) = self.matrix.split_at_mut(motion * size);
                let from = &before[(pose + i) * size..][..size];
                let to = &mut after[j * size..][..size];
                to.iter_mut().zip(from).for_each(|(t, f)| *t -= by_motion[i][j] * f);
            }
        }
    }

    /// Lets the motion have changed at random, by variances given in the units that the information is the inverse of.
    pub(super) fn add_process_noise(&mut self, variances: &Coordinates) {
        let (size, k) = (self.size(), self.k);
        let motion = self.coefficients + k;
        // L - L_m (1 + Q L_mm)^-1 Q L_m'.
        let block = |i: usize, j: usize| self.matrix[(motion + j) * size + motion + i];
        let inner = SMatrix::<f64, MAX_PARAMETERS, MAX_PARAMETERS>::from_fn(|i, j| {
            let unit = f64::from(u8::from(i == j));
            if i < k && j < k { unit + variances[i] * block(i, j) } else { unit }
        });
        let noise = SMatrix::<f64, MAX_PARAMETERS, MAX_PARAMETERS>::from_diagonal(&(*variances).into());
        let Some(middle) = inner.lu().solve(&noise) else { return };
        let mut columns = [[0.0; MAX_STATE]; MAX_PARAMETERS];
        for (j, column) in columns.iter_mut().enumerate().take(k) {
            column[..size].copy_from_slice(&self.matrix[(motion + j) * size..][..size]);
        }
        let mut weighted = [[0.0; MAX_STATE]; MAX_PARAMETERS];
        for i in 0..k {
            for j in 0..k {
                let m = 0.5 * (middle[(i, j)] + middle[(j, i)]);
                weighted[i][..size].iter_mut().zip(&columns[j]).for_each(|(w, c)| *w += m * c);
            }
        }
        for (c, column) in self.matrix.chunks_exact_mut(size).enumerate() {
            for j in 0..k {
                let factor = weighted[j][c];
                column.iter_mut().zip(&columns[j]).for_each(|(entry, l)| *entry -= factor * l);
            }
        }
    }

    /// Adds a frame to a copy of the information, and solves for the step from `shift`, which has been taken already, that the frame
    /// asks for by its score of the coefficients and of the pose. `None` where the matrix is not positive definite.
    pub(super) fn solve(
        &mut self,
        gram: &[f64],
        frame: &Linearised,
        scores: (&[f64], &Coordinates),
        shift: &[f64; MAX_STATE],
    ) -> Option<[f64; MAX_STATE]> {
        let (size, n, k) = (self.size(), self.coefficients, self.k);
        let mut right = [0.0; MAX_STATE];
        right[..n].copy_from_slice(scores.0);
        right[n..n + k].copy_from_slice(&scores.1[..k]);
        for (column, shift) in self.matrix.chunks_exact(size).zip(shift) {
            right.iter_mut().zip(column).for_each(|(r, entry)| *r -= entry * shift);
        }
        self.joined.copy_from_slice(&self.matrix);
        for (column, added) in self.joined.chunks_exact_mut(size).zip(gram.chunks_exact(n)) {
            column.iter_mut().zip(added).for_each(|(entry, g)| *entry += g);
        }
        for j in 0..k {
            let column = &mut self.joined[(n + j) * size..][..size];
            column.iter_mut().zip(&frame.slopes[j][..n]).for_each(|(entry, s)| *entry += s);
            (0..k).for_each(|i| column[n + i] += frame.pose[i][j]);
            for (c, s) in frame.slopes[j].iter().enumerate().take(n) {
                self.joined[c * size + n + j] += s;
            }
        }
        let mut scale = [0.0; MAX_STATE];
        for (i, s) in scale.iter_mut().enumerate().take(size) {
            let diagonal = self.joined[i * size + i];
            *s = if diagonal > 0.0 { 1.0 / diagonal.sqrt() } else { 1.0 };
        }
        for (c, (out, column)) in self.factor.chunks_exact_mut(size).zip(self.joined.chunks_exact(size)).enumerate() {
            for (r, (out, entry)) in out.iter_mut().zip(column).enumerate() {
                *out = entry * scale[r] * scale[c];
            }
            out[c] = 1.0 + ROUNDING;
        }
        let matrix = MatMut::from_column_major_slice_mut(&mut self.factor, size, size);
        cholesky_in_place(matrix, default(), Par::Seq, MemStack::new(&mut self.scratch.0), default()).ok()?;
        right.iter_mut().zip(&scale).for_each(|(r, s)| *r *= s);
        let factor = MatRef::from_column_major_slice(&self.factor, size, size);
        let solution = MatMut::from_column_major_slice_mut(&mut right[..size], size, 1);
        solve_lower_triangular_in_place(factor, solution, Par::Seq);
        let solution = MatMut::from_column_major_slice_mut(&mut right[..size], size, 1);
        solve_upper_triangular_in_place(factor.transpose(), solution, Par::Seq);
        right.iter_mut().zip(&scale).for_each(|(r, s)| *r *= s);
        right[..size].iter().all(|e| e.is_finite()).then_some(right)
    }

    /// Keeps the frame of the last [`solve`](Self::solve).
    pub(super) fn keep(&mut self) {
        std::mem::swap(&mut self.matrix, &mut self.joined);
    }

    /// Forgets pose and motion, and keeps what is known of the coefficients without them. Allocates.
    pub(super) fn forget_motion(&mut self, prior: f64) {
        let (size, n) = (self.size(), self.coefficients);
        let whole = DMatrix::from_column_slice(size, size, &self.matrix);
        let m = 2 * self.k;
        let corner = whole.view((n, n), (m, m)).into_owned();
        let coupling = whole.view((n, 0), (m, n)).into_owned();
        self.matrix.fill(0.0);
        let rest = match corner.cholesky() {
            Some(factor) => whole.view((0, 0), (n, n)) - coupling.transpose() * factor.solve(&coupling),
            None => whole.view((0, 0), (n, n)).into_owned(),
        };
        for c in 0..n {
            for r in 0..n {
                self.matrix[c * size + r] = 0.5 * (rest[(r, c)] + rest[(c, r)]);
            }
        }
        (n..size).for_each(|i| self.add_to_diagonal(i, prior));
    }
}
