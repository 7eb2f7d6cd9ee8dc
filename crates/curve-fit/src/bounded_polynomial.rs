use crate::{error::PolynomialError, leading_form::CircleRange, polynomial::ImplicitPolynomial};

/// An implicit polynomial whose leading form is positive: its curve is closed and bounded, all lines of its leading
/// form are complex, and it is positive far away.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundedPolynomial {
    polynomial: ImplicitPolynomial,
    margin: f64,
}

impl BoundedPolynomial {
    pub(crate) fn with_margin(polynomial: ImplicitPolynomial, margin: f64) -> Option<Self> {
        (margin > 0.0).then_some(Self { polynomial, margin })
    }

    /// The polynomial itself.
    #[must_use]
    pub fn polynomial(&self) -> &ImplicitPolynomial {
        &self.polynomial
    }

    /// Minimum of the leading form on the unit circle over its root mean square there, in (0, 1].
    #[must_use]
    pub fn margin(&self) -> f64 {
        self.margin
    }
}

impl TryFrom<ImplicitPolynomial> for BoundedPolynomial {
    type Error = PolynomialError;

    fn try_from(polynomial: ImplicitPolynomial) -> Result<Self, PolynomialError> {
        let margin = CircleRange::of(polynomial.leading_form()).margin();
        Self::with_margin(polynomial, margin).ok_or(PolynomialError::NotBounded { margin })
    }
}
