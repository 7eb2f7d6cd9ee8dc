//! One implicit polynomial for all frames, and the motion that carries it from one to the next.
mod curve_step;
mod filter;
mod findings;
mod frame_update;
mod level_sums;
mod registration;
mod score_covariance;
mod settings;
mod state_information;

pub use curve_step::{CurveRejection, CurveStep};
pub use filter::WholeCurveFilter;
pub use settings::CurveFilterSettings;
