use freeform_curve_fit::{Degree, ImplicitPolynomial, MAX_COEFFICIENTS, PolynomialError};

/// The polynomial whose coefficients a linear map makes of those of another one of the same degree. `apply` gets the old
/// coefficients and fills the new ones.
pub(crate) fn map_coefficients(
    degree: Degree,
    polynomial: &ImplicitPolynomial,
    apply: impl FnOnce(&[f64], &mut [f64]),
) -> Result<ImplicitPolynomial, PolynomialError> {
    let mut out = [0.0; MAX_COEFFICIENTS];
    let out = &mut out[..degree.coefficient_count()];
    if polynomial.degree() != degree {
        let (found, needed) = (polynomial.coefficients().len(), out.len());
        return Err(PolynomialError::WrongCoefficientCount { degree: degree.value(), found, needed });
    }
    apply(polynomial.coefficients(), out);
    ImplicitPolynomial::new(degree, out)
}
