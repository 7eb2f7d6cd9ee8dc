use crate::tuning::supervisor::{FOLLOWED_FRAME, FRAMES_OF_SEARCH, MOST_SEARCHES};

/// What there is at most, in frames.
const FULL: usize = MOST_SEARCHES * FRAMES_OF_SEARCH;

/// How many frames may still be searched for the object. A search costs as much as many frames that are followed, so that whoever shows
/// another thing in every frame must not have them all searched.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct SearchBudget {
    /// A search takes [`FRAMES_OF_SEARCH`] of them.
    frames: usize,
}

impl Default for SearchBudget {
    fn default() -> Self {
        Self { frames: FULL }
    }
}

impl SearchBudget {
    /// A frame has passed, and was followed, or not.
    pub(super) fn add_frame(&mut self, is_followed: bool) {
        let frames = if is_followed { FOLLOWED_FRAME } else { 1 };
        self.frames = (self.frames + frames).min(FULL);
    }

    /// Whether so many searches can be had.
    pub(super) fn has(self, searches: usize) -> bool {
        self.frames >= searches * FRAMES_OF_SEARCH
    }

    /// A search has been made.
    pub(super) fn spend(&mut self) {
        self.frames = self.frames.saturating_sub(FRAMES_OF_SEARCH);
    }

    /// Whether there is no more in it than there can be.
    #[cfg(feature = "serde")]
    pub(super) fn is_valid(self) -> bool {
        self.frames <= FULL
    }
}
