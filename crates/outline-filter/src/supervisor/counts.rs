//! How many frames became what, in a recording and of a track.

/// How many frames became what.
#[derive(Debug, Clone, Copy, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Counts {
    pub(super) accepted_in_recording: usize,
    pub(super) rejected_in_recording: usize,
    pub(super) rejected_in_a_row: usize,
    /// Frames since the last one that was used of which an edge left too little.
    pub(super) hidden_in_a_row: usize,
    /// Frames since the present track was begun, the one that it was begun with included.
    pub(super) accepted_by_track: usize,
    pub(super) rejected_by_track: usize,
    pub(super) restarts: usize,
    /// Times that the map was begun anew with a frame that showed more than those before: the turn at last, or the whole of what had been a part.
    pub(super) begun_with_more: usize,
    /// Times that a frame agreed with the turn that the motion had led to and with another, which was taken.
    pub(super) turned_elsewhere: usize,
    /// Times that the map was begun anew with a frame whose points along an edge were left out.
    pub(super) begun_without_edge: usize,
    /// Starts in a row after which the object was not found again.
    pub(super) fruitless_starts: usize,
}

impl Counts {
    /// The object was found in a frame.
    pub(super) fn add_accepted(&mut self) {
        self.accepted_in_recording += 1;
        self.accepted_by_track += 1;
        (self.rejected_in_a_row, self.hidden_in_a_row, self.fruitless_starts) = (0, 0, 0);
    }

    /// The object was not found in a frame.
    pub(super) fn add_rejected(&mut self) {
        self.rejected_in_recording += 1;
        self.rejected_by_track += 1;
        self.rejected_in_a_row += 1;
    }

    /// A new track was begun with a frame.
    pub(super) fn begin_track(&mut self) {
        (self.accepted_by_track, self.rejected_by_track) = (1, 0);
    }

    /// A new track was begun with so many frames, all of which it has taken.
    pub(super) fn begin_with(&mut self, frames: usize) {
        (self.accepted_by_track, self.rejected_by_track) = (frames, 0);
        (self.rejected_in_a_row, self.hidden_in_a_row, self.fruitless_starts) = (0, 0, 0);
    }

    /// Times that poses got another reference, in a recording.
    pub(super) fn segment(&self) -> usize {
        self.restarts + self.begun_with_more + self.turned_elsewhere + self.begun_without_edge
    }
}
