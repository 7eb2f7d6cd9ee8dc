//! Finds how a flat free-form object moves, from its outlines alone.
//!
//! The input of every frame is a list of noisy points in order along the outline of the object. Correspondence between the points of
//! different frames is not needed.
//!
//! - [`outline_filter::MotionFilter`] estimates outline, pose and motion of one object, with standard deviations. Start here. Its
//!   [`state`](outline_filter::MotionFilter::state) holds pose and motion with their joint covariance.
//! - [`Tracker`] follows many objects by name. It gives an observation for each frame and a result for each object.
//! - [`Pipeline`] is the method of the paper (M. Unel, B. K. Ghosh, *Motion identification of planar free-form objects*). It fits an
//!   implicit polynomial curve to each outline, decomposes it into complex lines, matches the lines to those of the frame before, and
//!   identifies the motion from their Riccati dynamics.
//! - [`estimate::smooth`] and [`outline_filter::estimate_batch`] are for recorded frames. [`estimate::CramerRaoBound`] gives the smallest
//!   covariance that any unbiased estimator can reach.
//!
//! Each stage is a crate of its own, re-exported here.
//!
//! ```
//! use freeform_motion::{Pipeline, PipelineSettings};
//! use freeform_motion::sim_camera::{PaperExperiment, SequenceLength, Settings, Simulator};
//!
//! // The paper's flight bird, seen for 20 s at 30 frames/s by a camera with f/Z0 = 0.1.
//! let scene = PaperExperiment::FLIGHT_BIRD.scene(0.1)?;
//! let camera = scene.camera();
//! let settings = Settings { length: SequenceLength::Seconds(20.0), ..Settings::default() };
//! let mut pipeline = Pipeline::new(PipelineSettings::default())?;
//! for frame in Simulator::new(scene, settings)?.frames() {
//!     pipeline.push(frame.time, &frame.outline)?;
//! }
//! let motion = pipeline.estimate().expect("more than one frame").in_space(camera.scale());
//! let omega = motion.parameters().next().and_then(|p| p.value).expect("observable");
//! assert!((omega - std::f64::consts::FRAC_PI_2).abs() < 0.1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
mod adaptive_progress;
mod error_chain;
mod fitted_outline;
mod followed_pose;
mod frame_ranges;
mod matched_frame;
mod named_shape;
mod number;
mod picture_tracing;
mod pipeline;
mod pipeline_error;
mod pipeline_settings;
#[cfg(feature = "serde")]
mod pipeline_state;
mod plane_by_outline;
mod polygon;
mod rectification;
mod regular_map;
mod rejection;
mod settling;
mod standing_edge;
pub mod tracker;
mod truth;
mod velocity_unit;
mod warning;
mod wrong_family;

pub use adaptive_progress::AdaptiveProgress;
pub use error_chain::with_causes;
pub use fitted_outline::{CurveDeviations, CurveParts, FittedOutline};
pub use freeform_curve_fit as curve_fit;
pub use freeform_decompose as decompose;
pub use freeform_estimate as estimate;
pub use freeform_identify as identify;
pub use freeform_outline_filter as outline_filter;
pub use freeform_outline_io as outline_io;
pub use freeform_recognise as recognise;
pub use freeform_riccati as riccati;
pub use freeform_sim_camera as sim_camera;
pub use named_shape::{NamedShapeError, named_shape};
pub use number::{short, significant, with_deviation};
pub use picture_tracing::{PictureTracing, TracedContours, TracedGround};
pub use pipeline::{FrameResult, Pipeline};
pub use pipeline_error::PipelineError;
pub use pipeline_settings::PipelineSettings;
pub use plane_by_outline::{PlaneByOutline, PlaneByOutlineError, plane_by_outline};
pub use polygon::{outline_of_pixel_polygon, outline_of_polygon};
pub use rectification::{Rectification, RectifyError};
pub use tracker::{Tracker, TrackerSettings};
pub use truth::{SimulatedMotion, Truth};
pub use velocity_unit::VelocityUnit;
pub use warning::Warning;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;

#[cfg(doctest)]
#[doc = include_str!("../docs/reading-uncertainties.md")]
struct GuideDoctests;
