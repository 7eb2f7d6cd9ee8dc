//! One program for all of them, since each costs a link and its share of compiling.
mod arbitrary_input;
mod checks;
mod common;
mod documents;
mod drawn_shapes;
mod hostile_geometry;
mod lost;
mod masks;
mod observability;
mod paper_experiments;
mod parts_that_move;
#[cfg(feature = "serde")]
mod pipeline_state;
mod projective;
mod rectification;
#[cfg(feature = "serde")]
mod resting;
mod robustness;
mod rolling_wheel;
mod seeking;
#[cfg(feature = "serde")]
mod serialised;
mod soak;
mod tracker;
#[cfg(feature = "serde")]
mod tracker_state;
mod trajectories;
mod warnings;
