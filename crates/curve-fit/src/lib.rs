//! Implicit polynomial curves fitted to noisy outlines.
mod degree;
mod error;
mod monomials;
mod outline;
mod polynomial;

pub use degree::{Degree, MAX_COEFFICIENTS, coefficient_count};
pub use error::{OutlineError, PolynomialError};
pub use monomials::{evaluate_monomials, exponents, monomial_index};
pub use outline::{ClosedOutline, OpenArc, OpenOutline, Outline, Piece};
pub use polynomial::ImplicitPolynomial;
