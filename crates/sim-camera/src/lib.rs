//! Simulated outlines of flat objects that move in front of a scaled orthographic camera.
//!
//! A [`Scene`] is a [`Shape`], a [`Motion`] and a [`Camera`]; a [`Simulator`] takes its [`Frame`]s as the [`Settings`]
//! say: points drawn anew in every frame, noise, a missing arc, outliers, wrong and dropped frames, all from one seed.
//!
//! ```
//! use freeform_riccati::RigidMotion;
//! use freeform_sim_camera::{BuiltInShape, Camera, Scene, SequenceLength, Settings, Simulator};
//!
//! // The paper's flight bird: b = (-3, 4) in space is (-0.3, 0.4) in the image at f/Z0 = 0.1.
//! let motion = RigidMotion { omega: std::f64::consts::FRAC_PI_2, b1: -3.0, b2: 4.0 };
//! let scene = Scene::new(BuiltInShape::Bird, motion, Camera::new(0.1)?);
//! let settings = Settings { length: SequenceLength::Seconds(1.0), noise: 0.005, ..Settings::default() };
//! let simulator = Simulator::new(scene, settings)?;
//!
//! let frames: Vec<_> = simulator.frames().collect();
//! assert_eq!(frames.len(), 30);
//! assert_eq!(frames[0].outline.point_count(), 400);
//! assert_eq!(simulator.image_motion().b2, 0.4);
//! # Ok::<(), freeform_sim_camera::SimulationError>(())
//! ```
mod arc_length;
mod camera;
mod corruption;
mod curve;
mod error;
mod experiments;
mod motion;
mod pictures;
mod raster;
mod sampling;
mod scene;
mod settings;
mod shape;
mod shapes;
mod simulator;
mod trajectory;

pub use camera::Camera;
pub use corruption::{HiddenArc, Occlusion};
pub use error::{ShapeError, SimulationError};
pub use experiments::PaperExperiment;
pub use motion::Motion;
pub use pictures::{BodyTruth, PictureScene, Rendering, SimulatedPicture, SimulatedPictures, UnknownScene};
pub use raster::Mask;
pub use sampling::Sampling;
pub use scene::Scene;
pub use settings::{SequenceLength, Settings};
pub use shape::Shape;
pub use shapes::BuiltInShape;
pub use simulator::{Corruption, Frame, Frames, Simulator};
pub use trajectory::{Dynamics, Trajectory};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;
