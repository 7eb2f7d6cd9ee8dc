//! Motion from all frames of a recording at once.
mod estimator;

pub use estimator::{BatchError, BatchEstimate, estimate_batch};
