//! The dynamics against the oracles of the theory: linear flows in homogeneous coordinates, an 8th-order integrator, and
//! curves moved as a whole.
mod alpha_beta;
mod decomposition;
mod homography;
mod integrate;
mod lift;
mod lines;
mod motions;
mod plane_in_space;
mod support;
