//! The bounds of Cramer and Rao, and states.
mod body_frame;
mod bound;
mod plane_bound;
