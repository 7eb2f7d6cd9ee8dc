//! What the program `freeform` measures and reproduces: baselines, Monte Carlo studies, and the figures of the paper, as data.
//! No arguments are read, nothing is printed and nothing is drawn here; progress is a callback.
//!
//! - [`monte_carlo`]: how far methods are from the truth and from the Cramer-Rao bound, over many simulated sequences
//! - [`stress`]: whether what is stated is right, on sequences that are not what an estimator expects
//! - [`baseline`]: the two estimators that one would otherwise write, which the motion filter is compared against
//! - [`paper`]: the figures and experiments of M. Unel and B. K. Ghosh, *Motion identification of planar free-form objects*
//! - [`figure`]: figures as panels of curves
//!
//! ```
//! use freeform_experiments::monte_carlo::{Method, Setting, Study};
//! use freeform_riccati::{MotionModel, RigidMotion};
//! use freeform_sim_camera::{BuiltInShape, Sampling};
//!
//! // How near to the bound does the motion filter come in a second of a turning bird with a fifth of its outline hidden?
//! let setting = Setting {
//!     name: "a hidden arc".to_owned(),
//!     model: MotionModel::Rigid,
//!     motion: RigidMotion { omega: 1.5, b1: -0.3, b2: 0.4 }.into(),
//!     plane: None,
//!     frames: 30,
//!     fps: 30.0,
//!     points: 200,
//!     noise: 0.005,
//!     occlusion: 0.2,
//!     outliers: 0.0,
//!     wrong_frames: 0.0,
//!     sampling: Sampling::Independent,
//! };
//! let study = Study {
//!     shapes: vec![BuiltInShape::Bird.shape()],
//!     settings: vec![setting],
//!     acquisitions: Vec::new(),
//!     methods: vec![Method::Filter],
//!     runs: 4,
//!     acquisition_runs: 0,
//!     seed: 1,
//! };
//! let report = study.run(&|| ())?;
//! let filter = &report.evaluations[0].methods[0].pooled;
//! assert_eq!(filter.lost, 0);
//! assert!(filter.ratio.is_some_and(|ratio| ratio < 3.0));
//! # Ok::<(), freeform_experiments::ExperimentError>(())
//! ```
pub mod baseline;
mod error;
pub mod monte_carlo;
pub mod paper;
pub mod stress;

pub use error::ExperimentError;
pub use freeform_drawing::figure;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;
