//! One program for all of them, since each costs a link and its share of compiling.
mod affine_normalisation;
mod conic_solver;
mod degenerate_input;
mod equivariance;
mod fitted_curve;
mod hostile_geometry;
mod support;
