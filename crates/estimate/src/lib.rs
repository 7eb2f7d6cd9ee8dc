//! Estimates of a motion of the plane, and what they share: parameters, states, smoothing, and the Cramer-Rao bound.
//!
//! - [`MotionEstimate`]: parameters with their standard deviations, or marked as not observable.
//! - [`MotionState`]: pose and motion at one time with their joint covariance; the velocity of any point of the object
//!   ([`PointVelocity`]).
//! - [`smooth`]: a fixed-interval smoother, which estimates every state from all frames of a recording; [`smooth_changing`] does so where the motion
//!   changes, by what was expected of each state ([`ExpectedState`]).
//! - [`ProcessNoise`]: how fast a motion may change.
//! - [`CramerRaoBound`]: the smallest covariance of any unbiased estimator.
//! - [`PlaneEstimate`] and [`PlaneBound`]: the same of a plane that moves in space.
//! - `StateFormat` and `StateError` (feature `serde`): what stands before a saved state, and why bytes are none.
//!
//! Motions are rigid, similarity, affine or projective (`freeform_riccati::MotionModel`), in the fixed image frame.
//!
//! ```
//! use freeform_estimate::MotionEstimate;
//! use freeform_riccati::MotionModel;
//!
//! // The angular velocity and the first component of the velocity are known, the second component is not.
//! let estimate = MotionEstimate::new(MotionModel::Rigid, &[1.5, 0.2, 0.0], Some(&[0.01, 0.002, 3.0])).with_unobservable(2);
//! let known: Vec<_> = estimate.parameters().filter(|p| p.value.is_some()).map(|p| p.name).collect();
//! assert_eq!(known, ["omega", "b1"]);
//! ```
mod bound;
mod changing_motion;
mod expected_derivative;
mod information;
mod motion_estimate;
mod motion_state;
mod observability;
mod plane_bound;
mod plane_estimate;
mod point_velocity;
mod process_noise;
mod smoother;
#[cfg(feature = "serde")]
mod state_format;
mod time;

pub use bound::{BoundCovariance, BoundError, BoundaryPoint, CramerRaoBound};
pub use changing_motion::{ExpectedState, smooth_changing};
pub use information::{InverseInformation, invert_information, scaled_inverse, scaled_solution};
pub use motion_estimate::{MotionEstimate, ParameterEstimate};
pub use motion_state::{MotionState, NormalisedState, PoseParameter};
pub use observability::is_worth;
pub use plane_bound::PlaneBound;
pub use plane_estimate::{NormalEstimate, PlaneEstimate};
pub use point_velocity::{PointVelocity, velocity_at};
pub use process_noise::ProcessNoise;
pub use smoother::{SmootherError, smooth};
#[cfg(feature = "serde")]
pub use state_format::{StateError, StateFormat};
pub use time::TimeNotIncreasing;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;
