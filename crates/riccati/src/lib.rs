//! Riccati dynamics of complex lines.
mod alpha_beta;
mod camera_scale;
mod error;
mod exponential;
mod flow;
mod integrate;
mod lift;
mod motion;
mod motion_model;
mod real_variables;
mod rotation_coordinate;
mod sensitivity;
mod transport;

pub use alpha_beta::{AlphaBeta, level_factor, level_rate};
pub use camera_scale::CameraScale;
pub use error::DynamicsError;
pub use flow::{LineRate, line_flow, line_rate, moved_line};
pub use integrate::{FlowIntegrator, IntegratedFlow};
pub use lift::Lift;
pub use motion::{AffineMotion, ProjectiveMotion, RigidMotion, SimilarityMotion};
pub use motion_model::MotionModel;
pub use real_variables::RealVariables;
pub use rotation_coordinate::RotationCoordinate;
pub use sensitivity::flow_sensitivity;
pub use transport::Transport;
