//! What every estimator of a motion of the plane speaks.
//!
//! - [`MotionEstimate`]: parameters with their standard deviations, those that nothing is known of named as such.
//! - [`MotionState`]: pose and motion at one time with their joint covariance; [`PointVelocity`] of any point of the object; [`smooth`]
//!   gives every state what all frames of a recording say of it.
//! - [`ProcessNoise`]: how fast a motion may change.
//! - [`CramerRaoBound`]: what no unbiased estimator can better.
//!
//! Motions are rigid, similarity, affine or projective (`freeform_riccati::MotionModel`), in the fixed image frame.
//!
//! ```
//! use freeform_estimate::MotionEstimate;
//! use freeform_riccati::MotionModel;
//!
//! // An angular velocity that is known, and a velocity of which only one component is.
//! let estimate = MotionEstimate::new(MotionModel::Rigid, &[1.5, 0.2, 0.0], Some(&[0.01, 0.002, 3.0])).with_unobservable(2);
//! let known: Vec<_> = estimate.parameters().filter(|p| p.value.is_some()).map(|p| p.name).collect();
//! assert_eq!(known, ["omega", "b1"]);
//! ```
mod bound;
mod information;
mod motion_estimate;
mod motion_state;
mod observability;
mod point_velocity;
mod process_noise;
mod smoother;
mod time;

pub use bound::{BoundCovariance, BoundError, BoundaryPoint, CramerRaoBound};
pub use information::{InverseInformation, invert_information, scaled_inverse, scaled_solution};
pub use motion_estimate::{MotionEstimate, ParameterEstimate};
pub use motion_state::{MotionState, NormalisedState, PoseParameter};
pub use observability::is_worth;
pub use point_velocity::{PointVelocity, velocity_at};
pub use process_noise::ProcessNoise;
pub use smoother::{SmootherError, smooth};
pub use time::TimeNotIncreasing;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;
