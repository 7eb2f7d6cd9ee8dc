//! Solutions and inverses of positive definite matrices over a state, scaled to unit diagonal on the way, so that entries of different units do
//! no harm.
use nalgebra::{Cholesky, Const, SMatrix, SVector};

use super::arrowhead::{StateMatrix, StateVector};

/// Solution of `m x = b` for a positive definite matrix over the `2 k` entries of a state, scaled to unit diagonal on the way.
pub(crate) fn scaled_solution(m: &StateMatrix, b: &StateVector, k: usize) -> Option<StateVector> {
    match k {
        3 => scaled_solution_sized::<6>(m, b),
        4 => scaled_solution_sized::<8>(m, b),
        6 => scaled_solution_sized::<12>(m, b),
        _ => scaled_solution_sized::<16>(m, b),
    }
}

/// Inverse of a positive definite matrix over the `2 k` entries of a state, scaled to unit diagonal on the way; unit diagonal beyond them.
pub(crate) fn scaled_inverse(m: &StateMatrix, k: usize) -> Option<StateMatrix> {
    match k {
        3 => scaled_inverse_sized::<6>(m),
        4 => scaled_inverse_sized::<8>(m),
        6 => scaled_inverse_sized::<12>(m),
        _ => scaled_inverse_sized::<16>(m),
    }
}

fn scaled_solution_sized<const S: usize>(m: &StateMatrix, b: &StateVector) -> Option<StateVector> {
    let (scale, factor) = scaled_cholesky::<S>(m)?;
    let x = factor.solve(&b.fixed_rows::<S>(0).component_mul(&scale)).component_mul(&scale);
    let mut solution = StateVector::zeros();
    solution.fixed_rows_mut::<S>(0).copy_from(&x);
    Some(solution)
}

fn scaled_inverse_sized<const S: usize>(m: &StateMatrix) -> Option<StateMatrix> {
    let (scale, factor) = scaled_cholesky::<S>(m)?;
    let inverse = factor.inverse();
    let mut whole = StateMatrix::identity();
    whole.fixed_view_mut::<S, S>(0, 0).copy_from(&SMatrix::from_fn(|i, j| inverse[(i, j)] * scale[i] * scale[j]));
    Some(whole)
}

/// Factor of a positive definite matrix that was scaled on both sides to unit diagonal, and the scale.
fn scaled_cholesky<const S: usize>(m: &StateMatrix) -> Option<(SVector<f64, S>, Cholesky<f64, Const<S>>)> {
    let scale = SVector::<f64, S>::from_fn(|i, _| if m[(i, i)] > 0.0 { 1.0 / m[(i, i)].sqrt() } else { 1.0 });
    let scaled = SMatrix::<f64, S, S>::from_fn(|i, j| m[(i, j)] * scale[i] * scale[j]);
    // Directions that nothing is known of may come out a rounding below zero.
    Some((scale, (scaled + SMatrix::identity() * 1e-14).cholesky()?))
}
