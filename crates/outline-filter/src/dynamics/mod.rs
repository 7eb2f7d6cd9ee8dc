//! How the motion changes: hypotheses of dynamics side by side, weighted by their likelihoods (an interacting multiple model: H. Blom and
//! Y. Bar-Shalom, The interacting multiple model algorithm for systems with Markovian switching coefficients, 1988).
//!
//! The hypotheses share the measurement of a frame: what it tells of the pose, with the offsets of the outline eliminated. They carry no
//! outline of their own.
mod accelerations;
mod arrival;
mod beginning;
mod centred;
mod centroid_shift;
mod combination;
mod common_error;
mod commuting;
mod correction;
mod course;
mod dynamics_filter;
mod family;
mod family_fit;
#[cfg(test)]
mod followed_poses_tests;
mod hypothesis;
mod innovations;
mod interacting;
mod mixing;
mod null_motions;
mod perspective;
mod placing;
mod pooled;
mod possible_faults;
mod probabilities;
mod setting;
mod steady_change;
mod step;
mod to_and_fro;
mod transitions;
mod turned_chains;
mod turned_motion;
mod unmodelled_estimate;
mod usual_step;
mod weighed_changes;
mod wrong_family;

pub(crate) use centred::{CentredDeviations, CentredPose, Summary, centred_order, centred_velocity};
pub(crate) use combination::Purpose;
pub(crate) use dynamics_filter::DynamicsFilter;
pub(crate) use family::FamilyTests;
pub(crate) use perspective::is_beyond_linear;
pub use setting::{Dynamics, DynamicsWeights, UnknownDynamics};
pub(crate) use unmodelled_estimate::UnmodelledEstimate;
pub use wrong_family::WrongFamily;
