//! The motion filter. It estimates outline, pose and motion of a flat object together from its outlines, frame by frame, with standard
//! deviations. Its errors are near the Cramer-Rao bound from the third frame on. It is robust to hidden arcs, outliers and wrong frames.
//!
//! To begin with: the overview in `docs/motion-filter.md` of the repository says what happens to a frame, and where to change what. The rest of that
//! document derives the equations, each with its code and test. The glossary at its end has the words of the code beside those of the field.
//!
//! The layers, from top to bottom. Each layer uses only the layers below it, which the test `documents.rs` of the repository checks:
//!
//! | layer | holds |
//! |---|---|
//! | `plane` | a plane that moves in space: a least sum of squares over all frames, beside a filter that follows the picture |
//! | `supervisor` | phases, restarts, hypotheses, changes of the motion: the only state machine |
//! | `search` | global registration: related points, turns |
//! | `track` | one object: the steps of a frame; growth and remapping of the map |
//! | `dynamics` | hypotheses of how the motion goes on, side by side |
//! | `update` | solve for a `Proposal`, test it at the `Gate`, commit it |
//! | `occlusion` | straight edges of other things, found from outlines and left out |
//! | `measurement` | frame, association, point-to-line residuals and Jacobians, noise |
//! | `prediction` | step, process noise, shape process noise |
//! | `map` | cells, contour, nearest-cell field, null directions |
//! | `belief` | pose, motion, offsets, arrowhead information matrix |
//! | `tuning` | every constant once, with its reason: of the outline, of a frame, of searches, of motion, of the plane |
//!
//! With the feature `serde` a filter can be saved and restored: `MotionFilter::to_bytes` and `MotionFilter::from_bytes`.
//!
//! [`MotionFilter`] processes frames one by one, as from a camera. [`estimate_batch`] estimates a constant motion from all frames of a
//! recording together.
//!
//! ```
//! use freeform_curve_fit::Outline;
//! use freeform_outline_filter::{FilterSettings, MotionFilter};
//! use nalgebra::{Point2, Rotation2};
//!
//! let mut filter = MotionFilter::new(FilterSettings::default())?;
//! for frame in 0..30 {
//!     let time = f64::from(frame) / 30.0;
//!     // Points in order along an egg that turns clockwise about the origin at 1.5 rad/s.
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
mod batch;
mod belief;
#[cfg(test)]
mod dense_filter;
#[cfg(test)]
mod drawn_curves;
mod dynamics;
mod map;
mod measurement;
mod occlusion;
mod plane;
mod prediction;
mod search;
mod supervisor;
mod track;
mod tuning;
mod update;
mod vectors;

pub use batch::{BatchError, BatchEstimate, estimate_batch};
pub use dynamics::{Dynamics, DynamicsWeights, UnknownDynamics, WrongFamily};
pub use occlusion::StandingEdge;
pub use plane::{PlaneAmbiguity, PlaneFilter, PlaneSolution, PlaneUnknown};
pub use supervisor::{
    Ambiguity, ExpectedOutline, FilterError, FilterSettings, FilterStep, MotionFilter, Phase, Unstated,
};
pub use track::{KnownOutline, KnownPiece};
pub use update::{FrameMeasurement, Rejection};
#[cfg(feature = "serde")]
pub use {freeform_estimate::StateError, supervisor::state_format};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;
