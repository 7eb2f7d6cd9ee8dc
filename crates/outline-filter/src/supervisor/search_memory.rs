//! What searches for the object go by.
use freeform_curve_fit::Outline;

use super::{search_budget::SearchBudget, sparse_frames::SparseFrames};
use crate::search::Landmarks;

/// What searches for the object go by.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct SearchMemory {
    /// Of the first outline, in its image coordinates.
    pub(super) landmarks: Option<Landmarks>,
    /// Order of the symmetry of the outline, as the frame that it was searched for in last shows it; 1 where there is none.
    pub(super) symmetry: usize,
    /// Searches that may still be made.
    pub(super) budget: SearchBudget,
    /// Frames in which the object has not been found since the first, while it has been found in none; in units of time.
    pub(super) unfound: Vec<(f64, Outline)>,
    /// The first frames of an outline of few points.
    pub(super) sparse: SparseFrames,
}

impl SearchMemory {
    /// Begins with the first outline of a track, of which nothing else is known.
    pub(super) fn begin(&mut self, first: &Outline) {
        (self.landmarks, self.symmetry) = (Landmarks::of(first), 1);
        self.unfound.clear();
    }
}

impl Default for SearchMemory {
    fn default() -> Self {
        Self {
            landmarks: None,
            symmetry: 1,
            budget: SearchBudget::default(),
            unfound: Vec::new(),
            sparse: SparseFrames::default(),
        }
    }
}
