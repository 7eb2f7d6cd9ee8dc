//! Global registration: an object that is known as a track looked for in a frame, without a guess of how it has moved.
mod groupwise;
mod landmarks;
mod linearised;
mod near_symmetry;
mod nearby;
mod outlook;
mod refinement;
mod registration;
mod symmetry;

pub(crate) use groupwise::{Aligned, TimedPoints, aligned};
pub(crate) use landmarks::Landmarks;
pub(crate) use nearby::displacement_nearby;
pub(crate) use refinement::RegisteredPose;
pub(crate) use registration::{Extent, Registration};
pub(crate) use symmetry::{TurnCentre, symmetry_order};
