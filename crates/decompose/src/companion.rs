use faer::Mat;
use nalgebra::Complex;

use crate::roots::{MAX_DEGREE, ScaledForm, check_form};
use crate::{error::RootError, roots::Roots};

/// Roots of a binary form as eigenvalues of the companion matrix of the scaled polynomial. The result agrees with
/// [`binary_form_roots`](crate::binary_form_roots), which is tested against this function and falls back on it. This function
/// is slower and allocates.
///
/// # Errors
/// As [`binary_form_roots`](crate::binary_form_roots).
pub fn companion_roots(coefficients: &[f64]) -> Result<Roots, RootError> {
    check_form(coefficients)?;
    let form = ScaledForm::of(coefficients)?;
    let Some(values) = companion_eigenvalues(&form) else {
        return Err(RootError::NoConvergence { degree: form.degree(), iterations: 0, residual: f64::NAN });
    };
    Ok(Roots::paired(&form, values))
}

/// Eigenvalues of the companion matrix, `None` where their iteration fails.
pub(crate) fn companion_eigenvalues(form: &ScaledForm) -> Option<[Complex<f64>; MAX_DEGREE]> {
    let (n, b) = (form.degree(), form.coefficients());
    let companion = Mat::from_fn(n, n, |row, column| match (row, column) {
        (0, _) => -b[column + 1],
        (r, c) if r == c + 1 => 1.0,
        _ => 0.0,
    });
    let eigenvalues = companion.eigenvalues().ok()?;
    let mut values = [Complex::ZERO; MAX_DEGREE];
    for (value, eigenvalue) in values.iter_mut().zip(eigenvalues) {
        *value = Complex::new(eigenvalue.re, eigenvalue.im);
    }
    values.iter().all(|z| z.is_finite()).then_some(values)
}
