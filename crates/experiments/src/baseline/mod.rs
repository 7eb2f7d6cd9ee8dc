//! What the motion filter is compared against: the two estimators that one would otherwise write.
//!
//! Both find the pose of every frame relative to the first one, and then fit a constant motion to the poses by least squares on
//! its exact flow, the initial pose being free. They differ in how they find the pose:
//!
//! - [`AreaMomentEstimator`]: centroid and principal axis of the area that the outline encloses; no correspondence, no
//!   iteration, no start needed. An outline with a missing arc encloses another area, and that is its weakness.
//! - [`RegistrationEstimator`]: iterated closest points, from the points of a frame to the lines through the points of the
//!   first frame (Chen and Medioni, *Object modelling by registration of multiple range images*, 1992), with Tukey weights,
//!   started from the pose of the frame before.
//!
//! They are made as strong as their idea allows, so that a comparison is worth something: frames that do not fit are
//! rejected or weighted down, points far from their neighbours are taken out of the outlines that areas and lines are made of,
//! poses enter the fit with their information, matches to the ends of open arcs are left out. Unlike the filter they keep
//! every pose, and their memory grows with the number of frames.
//!
//! ```
//! use freeform_curve_fit::Outline;
//! use freeform_experiments::baseline::AreaMomentEstimator;
//! use freeform_riccati::MotionModel;
//! use nalgebra::{Point2, Rotation2};
//!
//! // An egg that goes round the origin anticlockwise at 0.5 rad/s.
//! let egg = |i: i32| {
//!     let t = std::f64::consts::TAU * f64::from(i) / 300.0;
//!     Point2::new(1.0 + 0.5 * t.cos() + 0.05 * (2.0 * t).cos(), 0.35 * t.sin())
//! };
//! let mut estimator = AreaMomentEstimator::new(MotionModel::Rigid)?;
//! for frame in 0..10 {
//!     let time = f64::from(frame) / 30.0;
//!     let pose = Rotation2::new(0.5 * time);
//!     estimator.step(time, &Outline::closed((0..300).map(|i| pose * egg(i)).collect())?)?;
//! }
//! let estimate = estimator.estimate().expect("ten frames");
//! assert!((estimate.values()[0] + 0.5).abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
mod area_moments;
mod error;
mod flow_fit;
mod moment_estimator;
mod outlier_removal;
mod pose_history;
mod reference;
mod registration;

pub use error::BaselineError;
pub use moment_estimator::AreaMomentEstimator;
pub use registration::RegistrationEstimator;
