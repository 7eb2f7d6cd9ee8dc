//! Solutions and inverses over the `2 k` entries of a state; unit diagonal beyond them.
use nalgebra::SMatrix;

use super::arrowhead::{STATE, StateMatrix};

/// Solution of `m x = b`, column by column, for a positive definite matrix over the entries of a state.
pub(crate) fn scaled_solution<const C: usize>(
    m: &StateMatrix,
    b: &SMatrix<f64, STATE, C>,
    k: usize,
) -> Option<SMatrix<f64, STATE, C>> {
    match k {
        3 => solution_sized::<6, C>(m, b),
        4 => solution_sized::<8, C>(m, b),
        6 => solution_sized::<12, C>(m, b),
        _ => solution_sized::<16, C>(m, b),
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

fn solution_sized<const S: usize, const C: usize>(
    m: &StateMatrix,
    b: &SMatrix<f64, STATE, C>,
) -> Option<SMatrix<f64, STATE, C>> {
    let m: SMatrix<f64, S, S> = m.fixed_view::<S, S>(0, 0).into_owned();
    let x = freeform_estimate::scaled_solution(&m, &b.fixed_rows::<S>(0).into_owned())?;
    let mut solution = SMatrix::<f64, STATE, C>::zeros();
    solution.fixed_rows_mut::<S>(0).copy_from(&x);
    Some(solution)
}

fn inverse_sized<const S: usize>(m: &StateMatrix) -> Option<StateMatrix> {
    let m: SMatrix<f64, S, S> = m.fixed_view::<S, S>(0, 0).into_owned();
    let mut whole = StateMatrix::identity();
    whole.fixed_view_mut::<S, S>(0, 0).copy_from(&freeform_estimate::scaled_inverse(&m)?);
    Some(whole)
}
