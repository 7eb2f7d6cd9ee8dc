use faer::Mat;
use nalgebra::Complex;

/// Eigenvalues of the companion matrix of `u^n + b_1 u^(n-1) + ... + b_n`, given as `[1, b_1, ..., b_n]`, written to the first n of
/// `values`. Whether their iteration found them all.
pub(crate) fn companion_eigenvalues(b: &[f64], values: &mut [Complex<f64>]) -> bool {
    let n = b.len() - 1;
    let companion = Mat::from_fn(n, n, |row, column| match (row, column) {
        (0, _) => -b[column + 1],
        (r, c) if r == c + 1 => 1.0,
        _ => 0.0,
    });
    let Ok(eigenvalues) = companion.eigenvalues() else { return false };
    for (value, eigenvalue) in values.iter_mut().zip(eigenvalues) {
        *value = Complex::new(eigenvalue.re, eigenvalue.im);
    }
    values.iter().all(|z| z.is_finite())
}
