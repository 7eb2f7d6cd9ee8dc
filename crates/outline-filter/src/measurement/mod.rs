//! Points of one frame against the map: which cell each belongs to, its distance from it, how that changes with the pose, and how much it counts.
mod association;
mod columns;
mod correlation;
mod frame;
mod hidden;
mod lattice;
#[cfg(test)]
mod lattice_tests;
mod likelihood;
#[cfg(test)]
mod likelihood_tests;
mod linearisation;
mod noise;
mod normal_consistency;
mod part_in_view;
mod point_deviations;
mod side_by_side;
mod variance_inflation;

pub(crate) use association::{NO_CELL, Pass, View};
pub(crate) use columns::{CellJacobians, CellLine, CellSums, Columns, Jacobians, PointOnCell};
pub(crate) use correlation::{ShownCorrelation, TakenOff, correlation_of};
pub(crate) use frame::{Frame, Piece, Reference};
pub(crate) use hidden::{Lies, hide_points};
pub(crate) use lattice::{PixelLattice, PlaceOnLattice};
pub(crate) use likelihood::{FirstPose, NegativeLogLikelihood};
pub(crate) use linearisation::Measurement;
pub(crate) use noise::{Counted, NoiseModel, Rounding, Tolerance, spread};
pub(crate) use point_deviations::{PointDeviations, weighted_median};
