//! Tracks that have been saved.
use std::sync::Arc;

use freeform_estimate::StateFormat;
use freeform_riccati::MotionModel;

use super::Track;
use crate::measurement::Reference;

/// Whether the cells of a saved track have been measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SavedCells {
    Measured,
    Drafted,
}

impl Track {
    /// Builds what is not saved; false where what was saved is no track with such a unit of time, in seconds.
    pub(crate) fn restore(&mut self, unit: f64, saved: SavedCells) -> bool {
        let cells = self.map.cells().len();
        let with_sensitivity = if saved == SavedCells::Measured { cells } else { 0 };
        let Reference { origin, radius, time_unit, stated } = self.reference;
        origin.iter().all(|coordinate| coordinate.is_finite())
            && radius.is_normal()
            && radius > 0.0
            && stated > 0.0
            && time_unit == unit
            && self.frames < StateFormat::MOST_COUNTED
            && self.frames_before_cells <= self.frames
            && self.belief.is_valid(cells)
            && (cells == 0 || self.map.may_be_stretched() == (self.belief.model > MotionModel::Similarity))
            && self.noise.is_valid(cells)
            && self.shape.is_valid(cells)
            && self.early_shape.is_valid(cells)
            && self.usual.is_valid()
            && self.turn_profile.is_valid()
            && self.body_frame.is_valid()
            && self.sensitivity.is_valid(with_sensitivity)
            && self.family.is_valid()
            && self.first_pose.is_valid()
            && Arc::make_mut(&mut self.map).restore(self.belief.model)
    }
}
