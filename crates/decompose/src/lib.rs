//! Implicit polynomials as sums of products of complex lines.
mod line;

pub use line::{Decomposition, Line};
