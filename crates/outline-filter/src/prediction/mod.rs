//! What is believed moved on in time, and what is forgotten on the way.
mod pose_change;
mod process_noise;
mod shape_noise;
mod step;

pub(crate) use pose_change::{
    ByKind, PoseMatrix, TimeOfChange, adjoint_matrix, centred_change, kind_index, moved_covariance,
};
pub(crate) use shape_noise::ShapeNoise;
pub(crate) use step::ErrorTransition;
