//! Every constant of the motion filter, once, with its reason and, where there is one, its source.
//!
//! Lengths are in RMS radii of the first outline unless a line says otherwise; "deviations" are standard deviations.
mod frame;
mod motion;
pub(crate) mod occlusion;
mod outline;
pub(crate) mod plane;
mod search;

pub(crate) use frame::{deviations, lattice, likelihood, measurement, noise, update};
#[cfg(feature = "serde")]
pub(crate) use motion::saved_state;
pub(crate) use motion::{batch, dynamics, family, innovations, motion_change, statement, steady_change, supervisor};
pub(crate) use outline::{contour, map, null_space, redrawing, shape_change, shape_noise, symmetry, usual_agreement};
pub(crate) use search::{groupwise, registration, remapping, turn_hypotheses, turn_profile};
