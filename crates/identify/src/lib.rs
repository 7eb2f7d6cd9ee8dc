//! Identifies the motion of a planar curve from its moving lines.
mod adaptive;
mod error;
mod estimate;

pub use adaptive::{
    AdaptiveIdentifier, AdaptiveLaw, AdaptiveSettings, PairChoice, Regressor, quadratic_terms, solve_lyapunov,
};
pub use error::IdentifyError;
pub use estimate::{MotionEstimate, ParameterEstimate};
