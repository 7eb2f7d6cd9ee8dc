//! The bounds of Cramer and Rao.
mod bound;
mod plane_bound;
