//! Lists that a look at a contour fills, kept so that looks take no memory once there is room for as many places as a contour has.
use nalgebra::Point2;

use super::{
    evidence::Stayed,
    places::{Foot, Places},
    registration::RegistrationBuffers,
};
use crate::tuning::occlusion::{MOST_PLACES, MOST_STRAIGHT};

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

/// What straight parts are looked for and judged with.
#[derive(Debug, Clone, Default)]
pub(super) struct EvidenceBuffers {
    /// Of a run, or of all that has moved.
    pub(super) points: Vec<Point2<f64>>,
    pub(super) parts: Vec<Stayed>,
    /// Those of them that are not of the object.
    pub(super) shown: Vec<Stayed>,
    pub(super) left_out: LeftOut,
    pub(super) registration: RegistrationBuffers,
}

/// Which places of a contour, and of the earlier one, are left out.
#[derive(Debug, Clone, Default)]
pub(super) struct LeftOut {
    pub(super) now: Vec<bool>,
    pub(super) before: Vec<bool>,
}

impl LookBuffers {
    /// Makes room for all that a look needs.
    pub(super) fn make_room(&mut self) {
        let Self { contours, values, feet, evidence } = self;
        let EvidenceBuffers { points, parts, shown, left_out, registration } = evidence;
        // One is looked at, or both are free where no pair has begun.
        contours.reserve_exact(2 - contours.len().min(2));
        room(values, MOST_PLACES);
        room(feet, MOST_PLACES);
        room(points, MOST_PLACES);
        room(parts, MOST_STRAIGHT);
        room(shown, MOST_STRAIGHT);
        room(&mut left_out.now, MOST_PLACES);
        room(&mut left_out.before, MOST_PLACES);
        registration.make_room();
    }
}

/// Empties a list and makes room in it for so many values.
pub(super) fn room<T>(list: &mut Vec<T>, most: usize) {
    list.clear();
    list.reserve_exact(most);
}
