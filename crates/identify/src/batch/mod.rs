//! Motion from all frames of a recording at once.
mod estimator;
mod outline_cells;

pub use estimator::{BatchError, BatchEstimate, estimate_batch};
