//! An object looked for near where it was expected.
use freeform_riccati::{MAX_PARAMETERS, MotionModel, logarithm, map_point};
use nalgebra::{Matrix3, Point2, SVector, Translation2, Vector2};

use super::refinement::{Steps, few_of, refined};
use crate::{measurement::Frame, track::Track, tuning::noise::LARGEST};

/// How far from its predicted pose the object lies in a loaded frame which does not show it there, by few of its points: an error of the pose like
/// those of the belief, without what the outline does not show. The search begins in that pose, and, where that does not lead to the object, with the
/// middle of the outline in that of the points. `None` where neither does.
pub(crate) fn displacement_nearby(track: &Track, frame: &Frame) -> Option<SVector<f64, MAX_PARAMETERS>> {
    let few = few_of(&frame.points);
    let predicted = track.body_pose();
    let lies = map_point(predicted, &middle(track.map().cells().iter().map(|cell| cell.centre)));
    let apart = middle(few.iter().copied()) - lies;
    let starts = [*predicted, Translation2::from(apart).to_homogeneous() * predicted];
    let found = starts.iter().find_map(|start| refined_nearby(track, &few, start))?;
    let change = logarithm(&(found * predicted.try_inverse()?))?;
    let mut displacement = track.model().parameters_of(&change);
    track.null_directions().iter().for_each(|null| null.subtract_from(&mut displacement));
    Some(SVector::from(displacement))
}

/// The pose that a search from another leads to; `None` where that does not explain the points.
fn refined_nearby(track: &Track, few: &[Point2<f64>], start: &Matrix3<f64>) -> Option<Matrix3<f64>> {
    let begun = refined(track, few, MotionModel::Rigid, start, Steps::FIRST);
    let found = refined(track, few, MotionModel::Rigid, &begun.pose, Steps::FURTHER);
    (found.spread <= track.most_noise_tolerated().min(LARGEST)).then_some(found.pose)
}

fn middle(points: impl ExactSizeIterator<Item = Point2<f64>>) -> Point2<f64> {
    let count = points.len().max(1) as f64;
    (points.map(|p| p.coords).sum::<Vector2<f64>>() / count).into()
}
