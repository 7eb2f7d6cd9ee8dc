//! Global registration: an object that is known as a track looked for in a frame, without a guess of how it has moved.
mod landmarks;
mod outlook;
mod registration;
mod symmetry;

pub(crate) use landmarks::Landmarks;
pub(crate) use registration::{RegisteredPose, Registration};
pub(crate) use symmetry::symmetry_order;
