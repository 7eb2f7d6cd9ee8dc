//! One program for all of them, since each costs a link and its share of compiling.
mod all_but_round;
mod dependent_errors;
mod doubtful_starts;
mod doubtful_turns;
mod few_tell;
mod filter_changes;
mod filter_input;
mod filter_motion;
mod filter_observability;
mod filter_support;
mod first_frames;
mod gaps;
mod kept_errors;
mod known_outline;
mod long_bars;
mod lost_objects;
mod mask_rounding;
mod moving_poses;
mod plane;
mod point_deviations;
mod recorded;
mod recording;
#[cfg(feature = "serde")]
mod saved_state;
mod seen_aslant;
mod washers;
mod wrong_families;
