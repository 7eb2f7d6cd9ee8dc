//! Implicit polynomials as sums of products of complex lines.
//!
//! A polynomial of even degree n is a sum of line products, one for each of the degrees n, n - 2, ..., 2, and a constant
//! (equation 1 of M. Unel and B. K. Ghosh, *Motion identification of planar free-form objects*, for n = 4):
//!
//! `f = c_4 prod_{i=1..4} (x + l_4i y + k_4i) + c_2 prod_{i=1,2} (x + l_2i y + k_2i) + c_0`
//!
//! Lines of closed and bounded curves come in complex conjugate pairs. The pairs meet in real points that move with the
//! curve. The values of f at these points identify the pairs from frame to frame.
//!
//! ```
//! use freeform_curve_fit::{Degree, ImplicitPolynomial};
//! use freeform_decompose::{Correspondence, Decomposition, RelatedPoints};
//! use nalgebra::{Isometry2, Vector2};
//!
//! // (x^2 + 2 y^2) (2 x^2 + y^2) + x^2 y + x y^2 / 2 - x^2 / 5 + x y / 2 + x / 5 - 1
//! let coefficients = [-1.0, 0.2, 0.0, -0.2, 0.5, 0.0, 0.0, 1.0, 0.5, 0.0, 2.0, 0.0, 5.0, 0.0, 2.0];
//! let f = ImplicitPolynomial::new(Degree::Quartic, &coefficients)?;
//! let frame = Decomposition::of(&f)?;
//! for line in frame.conjugate_pairs(4) {
//!     println!("l = {:.3}, k = {:.3}", line.l, line.k);
//! }
//! assert_eq!(RelatedPoints::of(&frame).as_slice().len(), 3);
//!
//! // The next frame: the same curve, turned and shifted.
//! let motion = nalgebra::convert(Isometry2::new(Vector2::new(0.05, 0.02), 0.1));
//! let next = Decomposition::of(&f.moved(&motion)?)?;
//! let matched = Correspondence::between(&frame, &next, 1.0)?;
//! assert!(matched.agrees());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Nothing here allocates, except if the iteration for the roots fails and the companion matrix is used.
mod companion;
mod condition;
mod correspondence;
mod decomposition;
mod error;
mod invariants;
mod line;
mod line_product;
mod related_point;
mod roots;
mod rotation_chart;
#[cfg(feature = "serde")]
mod saved_decomposition;
mod uncertainty;

pub use condition::Condition;
pub use correspondence::{Correspondence, Criterion, MAX_PAIRS, ORDERING_MARGIN};
pub use decomposition::Decomposition;
pub use error::{CorrespondenceError, DecompositionError, RootError};
pub use invariants::AffineInvariants;
pub use line::Line;
pub use related_point::{RelatedPoint, RelatedPoints};
pub use roots::{Roots, binary_form_roots, companion_roots};
pub use rotation_chart::{from_rotation_chart, rotation_chart};
pub use uncertainty::CurveUncertainty;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;
