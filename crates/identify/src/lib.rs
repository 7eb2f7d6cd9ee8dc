//! Identifies how a planar curve moves, from its outlines or from its moving lines, in three ways:
//!
//! - [`MotionFilter`]: outline, pose and motion together, frame by frame, with standard deviations, near the Cramer-Rao bound from the
//!   third frame on and robust to hidden arcs, outliers and wrong frames. Take it first.
//! - [`AdaptiveIdentifier`]: the adaptive law of M. Unel and B. K. Ghosh, *Motion identification of planar free-form objects*
//!   (equations 19 to 22), or others ([`AdaptiveLaw`]), on complex lines `x + l y + k`. A closed curve given by an implicit polynomial
//!   is a sum of products of such lines, and under a motion of the plane every line follows a Riccati equation in which the motion
//!   parameters are linear.
//! - [`estimate_batch`]: a constant motion from all frames of a recording at once; [`smooth`] gives all poses of one.
//!
//! Motions are rigid, similarity, affine or projective (`freeform_riccati::MotionModel`; the adaptive law: up to affine). A
//! [`MotionEstimate`] names the parameters that the outlines tell nothing of. [`CramerRaoBound`] is what no unbiased estimator can
//! better, [`baseline`] what the motion filter is compared against.
//!
//! ```
//! use freeform_curve_fit::Outline;
//! use freeform_identify::{FilterSettings, MotionFilter};
//! use nalgebra::{Point2, Rotation2};
//!
//! let mut filter = MotionFilter::new(FilterSettings::default())?;
//! for frame in 0..30 {
//!     let time = f64::from(frame) / 30.0;
//!     // Points in their order along an egg that goes round the origin, clockwise by 1.5 rad/s.
//!     let egg = (0..300).map(|i| {
//!         let t = std::f64::consts::TAU * f64::from(i) / 300.0;
//!         Rotation2::new(-1.5 * time) * Point2::new(1.0 + 0.5 * t.cos() + 0.05 * (2.0 * t).cos(), 0.35 * t.sin())
//!     });
//!     filter.step(time, &Outline::closed(egg.collect())?)?;
//! }
//! let estimate = filter.estimate().expect("more than one frame");
//! let omega = estimate.parameters().next().expect("omega, b1 and b2");
//! println!("{} = {:?} +- {:?} {}", omega.name, omega.value, omega.standard_deviation, omega.unit);
//! assert!(omega.value.is_some_and(|value| (value - 1.5).abs() < 0.01));
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
mod point_velocity;
mod smoother;

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

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;
