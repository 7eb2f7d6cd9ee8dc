//! What is believed of an object: pose, motion and offsets of its outline, with the information on them.
mod arrowhead;
mod known_offsets;
mod offset_information;
mod outer_products;
mod scaled;
mod state;

pub(crate) use arrowhead::{Arrowhead, STATE, StateMatrix, StateVector, moved_marginal};
pub(crate) use known_offsets::KnownOffsets;
pub(crate) use offset_information::OffsetInformation;
pub(crate) use outer_products::sum_of_outer_products;
pub(crate) use scaled::{scaled_inverse, scaled_solution};
pub(crate) use state::{Belief, EarlierPoses};
