//! An object looked for near where it was expected.
use freeform_riccati::{MAX_PARAMETERS, MotionModel, logarithm};
use nalgebra::SVector;

use super::refinement::{Steps, few_of, refined};
use crate::{measurement::Frame, track::Track, tuning::noise::LARGEST};

/// How far from its predicted pose the object lies in a loaded frame which does not show it there, by few of its points: an error of the pose like
/// those of the belief, without what the outline does not show. `None` where a search from that pose does not lead to the object.
pub(crate) fn displacement_nearby(track: &Track, frame: &Frame) -> Option<SVector<f64, MAX_PARAMETERS>> {
    let few = few_of(&frame.points);
    let predicted = track.body_pose();
    let begun = refined(track, &few, MotionModel::Rigid, predicted, Steps::FIRST);
    let found = refined(track, &few, MotionModel::Rigid, &begun.pose, Steps::FURTHER);
    if found.spread > track.most_noise_tolerated().min(LARGEST) {
        return None;
    }
    let change = logarithm(&(found.pose * predicted.try_inverse()?))?;
    let mut displacement = track.model().parameters_of(&change);
    track.null_directions().iter().for_each(|null| null.subtract_from(&mut displacement));
    Some(SVector::from(displacement))
}
