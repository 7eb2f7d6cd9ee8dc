//! The paper's adaptive identifier (equations 19 to 22).
mod drem_law;
mod identifier;
#[cfg(test)]
mod independent_integration;
mod least_squares_law;
mod line_path;
mod lyapunov;
mod origin_shift;
mod pair_quality;
mod printed_law;
mod regressor;
mod running_law;
mod settings;
#[cfg(feature = "serde")]
mod state_bytes;
mod structured_law;

pub use identifier::AdaptiveIdentifier;
pub use lyapunov::solve_lyapunov;
pub use printed_law::plant_matrices;
pub use regressor::{Regressor, quadratic_terms};
pub use settings::{AdaptiveDiagnostics, AdaptiveLaw, AdaptiveSettings, PairChoice};
