//! The motion filter: phases, restarts, hypotheses and changes of the motion. The only state machine.
mod acquisition;
mod ambiguity;
mod between_frames;
mod candidate;
mod clock;
mod counts;
mod error;
mod expected_outline;
mod expected_state;
mod filter_step;
mod gates;
mod initialisation;
mod motion_change;
mod motion_filter;
mod passing_over;
mod remapper;
mod repeated_frames;
mod search_budget;
mod search_memory;
mod settings;
mod sparse_frames;
mod standing_edges;
mod starts;
#[cfg(feature = "serde")]
mod state_bytes;
mod stated;
mod statement;
mod symmetry_angle;
mod taken_ahead;
mod tracking;
mod turn_hypotheses;
mod turn_hypothesis;
mod turns_alike;
mod unseen;
mod window;

pub use ambiguity::Ambiguity;
pub use error::FilterError;
pub use expected_outline::ExpectedOutline;
pub use filter_step::FilterStep;
pub use motion_filter::{MotionFilter, Phase};
pub use settings::FilterSettings;
#[cfg(feature = "serde")]
pub use state_bytes::state_format;
pub use statement::Unstated;
