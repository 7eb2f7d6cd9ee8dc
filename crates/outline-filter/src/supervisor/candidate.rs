//! A pose that a search has found, tried.
use nalgebra::Matrix3;

use crate::{
    measurement::NegativeLogLikelihood,
    track::{Outcome, Track},
};

/// The track in a pose that was tried.
#[derive(Debug, Clone)]
pub(super) struct Candidate {
    pub(super) track: Track,
    pub(super) outcome: Outcome,
    /// The pose that it was measured from.
    pub(super) found_in: Matrix3<f64>,
    /// Turn from the pose before, rad, anticlockwise where y points up.
    pub(super) turn: f64,
    /// Size of the change from the pose before.
    pub(super) change: f64,
    pub(super) likelihood: NegativeLogLikelihood,
    pub(super) verdict_of: VerdictOf,
}

/// What says whether a pose that was tried is accepted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum VerdictOf {
    Itself,
    /// Others, which show that the noise of the frame says nothing against it.
    Others,
}
