//! Identifies the motion of a planar curve from its moving lines.
mod bound;
mod estimate;
mod filter;
mod motion_algebra;

pub use bound::{BoundCovariance, BoundError, BoundaryPoint, CramerRaoBound};
pub use estimate::{MotionEstimate, ParameterEstimate};
pub use filter::{FilterError, FilterSettings, FilterStep, MapUpdate, MotionFilter, OutlineMap, Phase, ProcessNoise};
