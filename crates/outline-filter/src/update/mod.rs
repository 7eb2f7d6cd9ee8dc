//! One frame taken into what is believed: solve for a proposal, judge it at a gate, commit it.
mod cells;
mod commit;
mod gate;
mod hold;
mod innovation;
mod normal_equations;
mod pose_measurement;
mod sensitivity;
mod solve;
mod unmodelled_displacement;
mod unmodelled_score;
mod weakest_agreement;

pub(crate) use commit::commit;
pub use gate::{FrameMeasurement, Rejection};
pub(crate) use gate::{Gate, without_leverage};
pub(crate) use hold::{hold, with_hold};
pub(crate) use innovation::PoseInnovation;
pub(crate) use normal_equations::accumulate;
pub(crate) use pose_measurement::{PoseMeasurement, left_by_offsets};
pub(crate) use sensitivity::Sensitivity;
pub(crate) use solve::{Linearisations, Proposal};
pub(crate) use unmodelled_displacement::{
    EDGES, FOURTH_OF_EDGES, GROWTH, LENS, PERSPECTIVE, READ_OUT, SHEAR, UNMODELLED, UnmodelledMatrix, UnmodelledVector,
    displacement_in_picture,
};
pub(crate) use unmodelled_score::UnmodelledScore;
