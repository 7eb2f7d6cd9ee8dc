//! The adaptive identifier of M. Unel and B. K. Ghosh, *Motion identification of planar free-form objects* (equations 19 to 22). It
//! identifies a motion of the plane from complex lines `x + l y + k` that move with the plane.
//!
//! The implicit polynomial of a closed curve is a sum of products of such lines (`freeform_decompose`). Under a motion of the plane every
//! line follows a Riccati equation (`freeform_riccati`) that is linear in the motion parameters. [`AdaptiveIdentifier`] takes the matched
//! conjugate pairs of lines of each frame and applies one of four laws ([`AdaptiveLaw`]). Motions are rigid, similarity or affine.
//!
//! With the feature `serde` an identifier can be saved and restored: `AdaptiveIdentifier::to_bytes` and `AdaptiveIdentifier::from_bytes`.
//!
//! ```
//! use freeform_decompose::Line;
//! use freeform_identify::{AdaptiveIdentifier, AdaptiveLaw, AdaptiveSettings};
//! use freeform_riccati::{RigidMotion, line_flow};
//! use nalgebra::Complex;
//!
//! // Two complex lines that move with a rigid motion, seen 100 times a second without noise.
//! let motion = RigidMotion { omega: 0.5, b1: -0.3, b2: 0.4 };
//! let lines = [(0.2, 0.9, -0.1, 0.3), (-0.6, 1.2, 0.4, -0.2)]
//!     .map(|(a, b, c, d)| Line { l: Complex::new(a, b), k: Complex::new(c, d) });
//! let settings = AdaptiveSettings { law: AdaptiveLaw::FilteredLeastSquares, ..AdaptiveSettings::default() };
//! let mut identifier = AdaptiveIdentifier::new(settings)?;
//! for frame in 0..200 {
//!     let time = f64::from(frame) / 100.0;
//!     let [a, b] = lines.map(|line| line_flow(&motion.generator(), &line, time).map(|(moved, _)| moved));
//!     identifier.step(time, &[a?, b?])?;
//! }
//! let omega = identifier.estimate().expect("more than one frame").values()[0];
//! assert!((omega - 0.5).abs() < 0.01);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
mod adaptive;
mod error;

pub use adaptive::{
    AdaptiveDiagnostics, AdaptiveIdentifier, AdaptiveLaw, AdaptiveSettings, PairChoice, Regressor, plant_matrices,
    quadratic_terms, solve_lyapunov,
};
pub use error::IdentifyError;
#[cfg(feature = "serde")]
pub use freeform_estimate::StateError;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;
