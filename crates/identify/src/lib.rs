//! Identifies the motion of a planar curve from its moving lines.
//!
//! A closed curve given by an implicit polynomial is a sum of products of complex lines `x + l y + k`, and under a motion of
//! the plane every line follows a Riccati equation in which the motion parameters are linear. [`AdaptiveIdentifier`] finds
//! them from the conjugate pairs of lines frame by frame, by the adaptive law of M. Unel and B. K. Ghosh, *Motion
//! identification of planar free-form objects* (equations 19 to 22), by that law with the structure of its matrices
//! known, or by least squares on the filtered equations: see [`AdaptiveLaw`]. A [`MotionEstimate`] names the parameters that
//! the outlines tell nothing of.
//!
//! ```
//! use freeform_decompose::Line;
//! use freeform_identify::{AdaptiveIdentifier, AdaptiveLaw, AdaptiveSettings};
//! use freeform_riccati::{RigidMotion, line_flow};
//! use nalgebra::Complex;
//!
//! let motion = RigidMotion { omega: 1.5, b1: -0.3, b2: 0.4 };
//! let line = Line { l: Complex::new(0.4, 0.7), k: Complex::new(0.1, -0.2) };
//!
//! let settings = AdaptiveSettings { law: AdaptiveLaw::FilteredLeastSquares, ..AdaptiveSettings::default() };
//! let mut identifier = AdaptiveIdentifier::new(settings)?;
//! for frame in 0..60 {
//!     let time = f64::from(frame) / 30.0;
//!     let (moved, _) = line_flow(&motion.generator(), &line, time)?;
//!     identifier.step(time, &[moved])?;
//! }
//! let estimate = identifier.estimate().expect("more than one frame");
//! assert!((estimate.values()[0] - motion.omega).abs() < 0.01);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
mod adaptive;
pub mod baseline;
mod batch;
mod bound;
mod error;
mod estimate;
mod filter;
mod group_logarithm;
mod information;
mod motion_algebra;
mod motion_state;
mod observability;
mod point_velocity;
mod smoother;
mod whole_curve;

pub use adaptive::{
    AdaptiveIdentifier, AdaptiveLaw, AdaptiveSettings, PairChoice, Regressor, quadratic_terms, solve_lyapunov,
};
pub use batch::{BatchError, BatchEstimate, estimate_batch};
pub use bound::{BoundCovariance, BoundError, BoundaryPoint, CramerRaoBound};
pub use error::IdentifyError;
pub use estimate::{MotionEstimate, ParameterEstimate};
pub use filter::{
    Ambiguity, FilterError, FilterSettings, FilterStep, MapUpdate, MotionFilter, OutlineMap, Phase, ProcessNoise,
    Rejection,
};
pub use motion_state::{MotionState, PoseParameter};
pub use point_velocity::PointVelocity;
pub use smoother::{SmootherError, smooth};
pub use whole_curve::{CurveFilterSettings, CurveRejection, CurveStep, WholeCurveFilter};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;
