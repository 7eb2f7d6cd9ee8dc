//! Turns that bring an outline onto itself.
use freeform_curve_fit::Outline;
use nalgebra::Matrix3;

use crate::{measurement::Frame, track::Track, tuning::symmetry as tuning};

/// Order of the symmetry of an outline: the largest n for which the known outline turned by the n-th part of a circle explains a frame
/// as well as it does in its pose, and half of that turn does not; 1 where there is none, and where the outline is as good as round.
pub(crate) fn symmetry_order(track: &Track, outline: &Outline, pose: &Matrix3<f64>, frame: &mut Frame) -> usize {
    if track.turn_is_unseen() {
        return 1;
    }
    let poses: Vec<_> = std::iter::once(*pose)
        .chain((2..=tuning::LARGEST_ORDER).map(|n| track.turned(pose, std::f64::consts::TAU / n as f64)))
        .collect();
    let likelihoods = track.compared_with_first(outline, &poses, frame);
    let as_good = |n: &usize| likelihoods[n - 1].is_within(tuning::AS_GOOD, &likelihoods[0]);
    let found: Vec<usize> = (2..=tuning::LARGEST_ORDER).rev().filter(as_good).collect();
    // Turns that are too small for the frame to show are no symmetry: half of one of a symmetry is seen.
    let halves: Vec<_> = std::iter::once(*pose)
        .chain(found.iter().map(|n| track.turned(pose, std::f64::consts::PI / *n as f64)))
        .collect();
    let likelihoods = track.compared_with_first(outline, &halves, frame);
    let seen = |at: &usize| !likelihoods[at + 1].is_within(tuning::HALF_IS_WORSE, &likelihoods[0]);
    (0..found.len()).find(seen).map_or(1, |at| found[at])
}
