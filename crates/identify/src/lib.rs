//! Identifies the motion of a planar curve from its moving lines.
mod adaptive;
mod bound;
mod error;
mod estimate;
mod filter;
mod motion_algebra;

pub use adaptive::{
    AdaptiveIdentifier, AdaptiveLaw, AdaptiveSettings, PairChoice, Regressor, quadratic_terms, solve_lyapunov,
};
pub use bound::{BoundCovariance, BoundError, BoundaryPoint, CramerRaoBound};
pub use error::IdentifyError;
pub use estimate::{MotionEstimate, ParameterEstimate};
pub use filter::{FilterError, FilterSettings, FilterStep, MapUpdate, MotionFilter, OutlineMap, Phase, ProcessNoise};
