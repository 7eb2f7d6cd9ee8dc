//! Solutions and inverses over the `2 k` entries of a state; unit diagonal beyond them.
use nalgebra::SMatrix;

use super::arrowhead::{StateMatrix, StateVector};

/// Solution of `m x = b` for a positive definite matrix over the entries of a state.
pub(crate) fn scaled_solution(m: &StateMatrix, b: &StateVector, k: usize) -> Option<StateVector> {
    match k {
        3 => solution_sized::<6>(m, b),
        4 => solution_sized::<8>(m, b),
        6 => solution_sized::<12>(m, b),
        _ => solution_sized::<16>(m, b),
    }
}

/// Inverse of a positive definite matrix over the entries of a state.
pub(crate) fn scaled_inverse(m: &StateMatrix, k: usize) -> Option<StateMatrix> {
    match k {
        3 => inverse_sized::<6>(m),
        4 => inverse_sized::<8>(m),
        6 => inverse_sized::<12>(m),
        _ => inverse_sized::<16>(m),
    }
}

fn solution_sized<const S: usize>(m: &StateMatrix, b: &StateVector) -> Option<StateVector> {
    let m: SMatrix<f64, S, S> = m.fixed_view::<S, S>(0, 0).into_owned();
    let x = freeform_estimate::scaled_solution(&m, &b.fixed_rows::<S>(0).into_owned())?;
    let mut solution = StateVector::zeros();
    solution.fixed_rows_mut::<S>(0).copy_from(&x);
    Some(solution)
}

fn inverse_sized<const S: usize>(m: &StateMatrix) -> Option<StateMatrix> {
    let m: SMatrix<f64, S, S> = m.fixed_view::<S, S>(0, 0).into_owned();
    let mut whole = StateMatrix::identity();
    whole.fixed_view_mut::<S, S>(0, 0).copy_from(&freeform_estimate::scaled_inverse(&m)?);
    Some(whole)
}
