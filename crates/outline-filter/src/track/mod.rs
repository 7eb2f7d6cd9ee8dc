//! A track: one object with its map, what is believed of it, and the noise; frames are taken, and the map grows or is cut anew.
mod body_frame;
mod common_shift;
mod comparison;
mod cutting;
mod displacement;
mod estimate;
mod first_pose;
mod glance;
mod grown;
mod growth;
#[cfg(test)]
mod jacobians_tests;
mod known_outline;
mod middle;
mod outcome;
mod outline;
mod remapping;
mod rounding;
#[cfg(feature = "serde")]
mod saved;
mod shape_change;
#[cfg(test)]
mod side_by_side_tests;
#[cfg(test)]
mod sides_tests;
#[expect(clippy::module_inception, reason = "the module holds the type that the layer is about")]
mod track;
mod turn;
mod turn_profile;
mod unmodelled;
mod usual_agreement;

pub(crate) use body_frame::{of_pose, of_pose_alone};
pub(crate) use estimate::{TurnOfPose, TurnTold};
pub use known_outline::{KnownOutline, KnownPiece};
pub(crate) use outcome::{Comparison, Doubt, Outcome, Rise};
pub(crate) use remapping::PlacedFrame;
#[cfg(feature = "serde")]
pub(crate) use saved::SavedCells;
pub(crate) use track::Track;
pub(crate) use turn::{turn_between, wrapped};
