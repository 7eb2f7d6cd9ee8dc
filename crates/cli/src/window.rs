//! What has been read and not been handed on.
use std::collections::VecDeque;
use std::rc::Rc;

use crate::input::SeenIn;
use crate::left_out::Missing;
use crate::reader::Pace;

/// Points of all outlines read ahead at most: four megabytes. Enough to have work while an object is waited for.
const POINTS_AHEAD: usize = 1 << 18;
/// Outlines read ahead, however small.
const OUTLINES_AHEAD: usize = 4096;
/// Outlines from pictures read ahead, which are held with their pictures.
const OUTLINES_OF_PICTURES_AHEAD: usize = 32;

/// What was read: of one object in one frame, or of a picture that shows none.
pub(crate) enum Pending {
    /// An outline of the object at this position with so many points, and the picture that it was seen in, if it was.
    Outline { position: usize, points: usize, seen_in: Option<Rc<SeenIn>> },
    /// An outline that is none, with the reason.
    Rejected { position: usize, object: String, frame: u64, reason: String },
    /// A picture without an outline.
    Missing(Missing),
}

/// What has been read and not been handed on, in the order of the input.
pub(crate) struct Window {
    pending: VecDeque<Pending>,
    most: usize,
    points: usize,
}

impl Window {
    /// With nothing read.
    pub(crate) fn new(pace: Pace, has_pictures: bool) -> Self {
        let most = match pace {
            Pace::FrameByFrame => 1,
            Pace::Ahead if has_pictures => OUTLINES_OF_PICTURES_AHEAD,
            Pace::Ahead => OUTLINES_AHEAD,
        };
        Self { pending: VecDeque::new(), most, points: 0 }
    }

    /// Whether more may be read.
    pub(crate) fn has_room(&self) -> bool {
        self.pending.len() < self.most && self.points < POINTS_AHEAD
    }

    /// Takes what was read last.
    pub(crate) fn push(&mut self, pending: Pending) {
        self.points += pending.points();
        self.pending.push_back(pending);
    }

    /// What comes first.
    pub(crate) fn first(&self) -> Option<&Pending> {
        self.pending.front()
    }

    /// Gives what comes first away.
    pub(crate) fn pop(&mut self) -> Option<Pending> {
        let first = self.pending.pop_front()?;
        self.points -= first.points();
        Some(first)
    }
}

impl Pending {
    fn points(&self) -> usize {
        match self {
            Self::Outline { points, .. } => *points,
            Self::Rejected { .. } | Self::Missing(_) => 0,
        }
    }
}
