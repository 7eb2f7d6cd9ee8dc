//! An object looked for near where it was expected.
use freeform_riccati::{MAX_PARAMETERS, MotionModel};
use nalgebra::{Matrix3, Point2, SVector};

use super::refinement::{RegisteredPose, Steps, few_of, middles, refined};
use crate::{
    measurement::Frame,
    track::{Track, turn_between},
    tuning::{noise::LARGEST, registration::TIE},
};

/// How far from its predicted pose the object lies in a loaded frame which does not show it there, by few of its points: an error of the pose like
/// those of the belief, without what the outline does not show. The search begins in that pose, and with the middle of the outline in that of the
/// points: from where it was expected the sides of a bar are found, and its ends are not. `None` where neither leads to the object.
pub(crate) fn displacement_nearby(track: &Track, frame: &Frame) -> Option<SVector<f64, MAX_PARAMETERS>> {
    let few = few_of(&frame.points);
    let predicted = track.body_pose();
    let [lies, shown] = middles(track, &few);
    let starts = [*predicted, turn_between(0.0, &lies, &shown) * predicted];
    let [from_expected, from_middle] = starts.map(|start| refined_nearby(track, &few, &start));
    let is_better = |middle: &RegisteredPose| from_expected.is_none_or(|found| TIE * middle.score < found.score);
    let found = from_middle.filter(is_better).or(from_expected)?;
    track.error_to(&found.pose)
}

/// The pose that a search from another leads to; `None` where that does not explain the points.
fn refined_nearby(track: &Track, few: &[Point2<f64>], start: &Matrix3<f64>) -> Option<RegisteredPose> {
    let begun = refined(track, few, MotionModel::Rigid, start, Steps::FIRST);
    let found = refined(track, few, MotionModel::Rigid, &begun.pose, Steps::FURTHER);
    (found.spread <= track.most_noise_tolerated().min(LARGEST)).then_some(found)
}
