//! Riccati dynamics of complex lines.
mod motion;

pub use motion::{AffineMotion, RigidMotion};
