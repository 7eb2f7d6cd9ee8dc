//! Identifies the motion of a planar curve from its moving lines.
mod estimate;

pub use estimate::{MotionEstimate, ParameterEstimate};
