use nalgebra::{Cholesky, Const, DMatrix, DVector, DefaultAllocator, Dim, OMatrix, OVector, allocator::Allocator};

/// Eigenvalues of the information, scaled to unit diagonal, below this fraction of the largest count as no information.
const RANK_TOLERANCE: f64 = 1e-10;
/// Added to a unit diagonal before it is factored.
const ROUNDING: f64 = 1e-14;
/// Share of a parameter in a direction without information from which on the parameter counts as unknown.
const TOUCHED: f64 = 1e-4;

/// What is left of an information matrix when it is inverted.
#[derive(Debug, Clone, PartialEq)]
pub struct InverseInformation {
    /// The covariance, as if directions without information were known.
    pub covariance: DMatrix<f64>,
    /// Whether each parameter is observable: no direction without information touches it.
    pub observable: Vec<bool>,
    /// Number of directions that carry information.
    pub rank: usize,
}

/// Inverts a symmetric positive semidefinite matrix, whose entries must be finite. Scaled to unit diagonal first, so that the units
/// of the parameters do not matter.
#[must_use]
pub fn invert_information(information: &DMatrix<f64>) -> InverseInformation {
    let size = information.nrows();
    let scale = unit_scale(information);
    let scaled = DMatrix::from_fn(size, size, |i, j| information[(i, j)] * scale[i] * scale[j]);
    let eigen = scaled.symmetric_eigen();
    let smallest = RANK_TOLERANCE * eigen.eigenvalues.amax().max(f64::MIN_POSITIVE);
    let mut inverse = DMatrix::zeros(size, size);
    let mut observable = vec![true; size];
    let mut rank = 0;
    for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        if *value > smallest {
            rank += 1;
            inverse.ger(1.0 / value, &vector, &vector, 1.0);
        } else {
            (0..size).filter(|i| vector[*i].abs() > TOUCHED).for_each(|i| observable[i] = false);
        }
    }
    let covariance = DMatrix::from_fn(size, size, |i, j| inverse[(i, j)] * scale[i] * scale[j]);
    InverseInformation { covariance, observable, rank }
}

/// Inverse of a positive definite matrix; see [`scaled_solution`]. `None` where it is not positive definite.
#[must_use]
pub fn scaled_inverse<D: Dim>(matrix: &OMatrix<f64, D, D>) -> Option<OMatrix<f64, D, D>>
where
    DefaultAllocator: Allocator<D, D> + Allocator<D>,
{
    let (scale, factor) = scaled_cholesky(matrix)?;
    let inverse = factor.inverse();
    let (rows, columns) = inverse.shape_generic();
    Some(OMatrix::from_fn_generic(rows, columns, |i, j| inverse[(i, j)] * scale[i] * scale[j]))
}

/// Solution x of `matrix x = right`, one column for each column of `right`, for a positive definite matrix, which is scaled to unit diagonal on
/// the way, so that entries of different units, or known to very different precision, do no harm. `None` where it is not positive definite.
#[must_use]
pub fn scaled_solution<D: Dim, C: Dim>(
    matrix: &OMatrix<f64, D, D>,
    right: &OMatrix<f64, D, C>,
) -> Option<OMatrix<f64, D, C>>
where
    DefaultAllocator: Allocator<D, D> + Allocator<D> + Allocator<D, C>,
{
    let (scale, factor) = scaled_cholesky(matrix)?;
    let scaled = |m: OMatrix<f64, D, C>| {
        let (rows, columns) = m.shape_generic();
        OMatrix::from_fn_generic(rows, columns, |i, j| m[(i, j)] * scale[i])
    };
    Some(scaled(factor.solve(&scaled(right.clone()))))
}

/// Factor of a matrix that was scaled on both sides to unit diagonal, and the scale.
fn scaled_cholesky<D: Dim>(matrix: &OMatrix<f64, D, D>) -> Option<(OVector<f64, D>, Cholesky<f64, D>)>
where
    DefaultAllocator: Allocator<D, D> + Allocator<D>,
{
    let (rows, columns) = matrix.shape_generic();
    let scale = OVector::from_fn_generic(rows, Const::<1>, |i, _| {
        let entry = matrix[(i, i)];
        if entry > 0.0 { 1.0 / entry.sqrt() } else { 1.0 }
    });
    let mut scaled = OMatrix::from_fn_generic(rows, columns, |i, j| matrix[(i, j)] * scale[i] * scale[j]);
    // Directions that nothing is known of may come out a rounding below zero.
    (0..rows.value()).for_each(|i| scaled[(i, i)] += ROUNDING);
    Some((scale, scaled.cholesky()?))
}

/// What brings the diagonal of a matrix to 1, from both sides.
fn unit_scale(information: &DMatrix<f64>) -> DVector<f64> {
    let inverse_root = |value: f64| if value > 0.0 { value.sqrt().recip() } else { 1.0 };
    information.diagonal().map(inverse_root)
}
