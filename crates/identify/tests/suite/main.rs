//! One program for all of them, since each costs a link and its share of compiling.
mod adaptive_convergence;
mod adaptive_input;
mod adaptive_support;
#[cfg(feature = "serde")]
mod saved_state;
