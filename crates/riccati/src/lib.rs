//! Riccati dynamics of complex lines.
mod camera_scale;
mod error;
mod exponential;
mod motion;
mod motion_model;

pub use camera_scale::CameraScale;
pub use error::DynamicsError;
pub use motion::{AffineMotion, ProjectiveMotion, RigidMotion, SimilarityMotion};
pub use motion_model::MotionModel;
