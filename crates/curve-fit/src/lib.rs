//! Implicit polynomial curves fitted to noisy outlines.
//!
//! An outline consists of ordered points, without correspondence to other outlines. A [`Fitter`] fits an implicit
//! polynomial `f(x, y) = sum a_ij x^i y^j` of even degree 2 to 8 to it, negative inside and positive outside. The 3L method uses
//! three level sets: the points at 0, and the points moved along their normals at -1 and +1. The fit can be globally
//! stabilised, or closed and bounded by construction. The fit is equivariant under similarities (turns, shifts and changes of
//! scale): the fit of the moved outline is the moved fit. Under an affine map that stretches or shears, which changes
//! distances along normals, it is equivariant with [`Normalise::Affine`] only.
//!
//! ```
//! use freeform_curve_fit::{FitSettings, Fitter, Outline};
//! use nalgebra::Point2;
//!
//! // An ellipse with half axes 2 and 1, seen through 200 points.
//! let angle = |i: i32| std::f64::consts::TAU * f64::from(i) / 200.0;
//! let points = (0..200).map(|i| Point2::new(2.0 * angle(i).cos(), angle(i).sin())).collect();
//! let outline = Outline::closed(points)?;
//!
//! let mut fitter = Fitter::new(FitSettings::default())?;
//! let fit = fitter.fit(&outline)?;
//! assert!(fit.is_bounded());
//! assert!(fit.diagnostics().geometric_residual < 0.02);
//!
//! let f = fit.polynomial();
//! assert!(f.evaluate(&Point2::origin()) < 0.0);
//! assert!(f.evaluate(&Point2::new(2.0, 1.0)) > 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
mod active_set;
mod area_moments;
mod bounded;
mod bounded_polynomial;
mod covariance;
mod degree;
mod deviations;
mod error;
mod fit;
mod fitter;
mod image_rows;
mod interior_point;
pub mod isoline;
mod leading_form;
mod least_squares;
mod level_set_moments;
mod moment_sums;
mod moments;
mod monomials;
mod normalisation;
mod normals;
mod open_outline;
mod outline;
mod pixel_grid;
mod points;
mod polynomial;
mod principal_axis;
mod rectangle;
mod resampling;
mod residuals;
mod ridge;
mod settings;
mod side;
mod smoothing;
mod stray_parts;
mod vectors;
mod windows;

pub use area_moments::AreaMoments;
pub use bounded_polynomial::BoundedPolynomial;
pub use covariance::FitCovariance;
pub use degree::{Degree, MAX_COEFFICIENTS, coefficient_count};
pub use error::{FitError, OutlineError, PolynomialError, SettingsError};
pub use fit::{Factorisation, Fit, FitDiagnostics};
pub use fitter::Fitter;
pub use leading_form::CircleRange;
pub use moments::Moments;
pub use monomials::{evaluate_monomials, exponents, monomial_index};
pub use normalisation::Normalisation;
pub use normals::{NormalRegression, outward_normals};
pub use open_outline::{OpenArc, OpenOutline};
pub use outline::{ClosedOutline, Outline, Piece};
pub use pixel_grid::PixelGrid;
pub use polynomial::ImplicitPolynomial;
pub use principal_axis::principal_angle;
pub use rectangle::Rectangle;
pub use resampling::evenly_spaced;
pub use residuals::Residuals;
pub use ridge::rotation_invariant_ridge;
pub use settings::{FitSettings, Method, Normalise};
pub use side::share_along_side;
pub use stray_parts::stray_parts;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;
