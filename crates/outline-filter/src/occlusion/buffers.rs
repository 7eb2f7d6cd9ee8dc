//! Lists that a look at a contour fills, kept so that looks take no memory once there is room for as many places as a contour has.
use super::{
    evidence::EvidenceBuffers,
    places::{Foot, Places, clear_with_room},
};
use crate::tuning::occlusion::MOST_PLACES;

/// What a look works on.
#[derive(Debug, Clone, Default)]
pub(super) struct LookBuffers {
    /// Contours that are compared with none any more.
    pub(super) contours: Vec<Places>,
    /// Values that a median is taken of.
    pub(super) values: Vec<f64>,
    /// Where the places of the contour are nearest to the earlier one.
    pub(super) feet: Vec<Foot>,
    pub(super) evidence: EvidenceBuffers,
}

impl LookBuffers {
    /// Makes room for all that a look needs.
    pub(super) fn make_room(&mut self) {
        let Self { contours, values, feet, evidence } = self;
        // One is looked at, or both are free where no pair has begun.
        contours.reserve_exact(2 - contours.len().min(2));
        clear_with_room(values, MOST_PLACES);
        clear_with_room(feet, MOST_PLACES);
        evidence.make_room();
    }
}
