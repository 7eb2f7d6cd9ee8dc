//! Frames of an input that are taken together.
use std::rc::Rc;

use freeform_motion::outline_io::OutlineFrame;

use crate::failure::{Failure, warn};
use crate::input::{Input, Item, SeenIn};
use crate::interrupt;
use crate::progress::Progress;

/// Points of all outlines read ahead: some megabytes.
const POINTS_AHEAD: usize = 1 << 18;
/// Outlines read ahead, however small.
const OUTLINES_AHEAD: usize = 4096;
/// Pictures read ahead, which are held with their outlines.
const PICTURES_AHEAD: usize = 16;

/// How an input is gone through.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Pace {
    /// Every frame is dealt with before the next one is read: what it gave is known as soon as it is complete.
    FrameByFrame,
    /// Many frames are read while those before are dealt with.
    Ahead,
}

/// What was read of one object in one frame.
pub(crate) enum Taken {
    /// An outline, and the picture that it was seen in, if it was.
    Outline(OutlineFrame, Option<Rc<SeenIn>>),
    /// An outline that is none, with the reason.
    Rejected { object: String, frame: u64, reason: String },
}

/// Reads an input batch by batch.
pub(crate) struct BatchReader<'a> {
    input: &'a mut Input,
    pace: Pace,
    quiet: bool,
    pub(crate) progress: Progress,
    /// Why the first picture without an outline has none, and whether it is damaged.
    first_missing: Option<(String, bool)>,
    failure: Option<Failure>,
}

impl<'a> BatchReader<'a> {
    pub(crate) fn new(input: &'a mut Input, pace: Pace, quiet: bool) -> Self {
        let progress = Progress::of_frames(input.frame_count(), quiet);
        Self { input, pace, quiet, progress, first_missing: None, failure: None }
    }

    /// The next frames; none at the end of the input, at an error that ends it, and after Ctrl-C.
    pub(crate) fn batch(&mut self) -> Vec<Taken> {
        let (most, mut points_left) = match self.pace {
            Pace::FrameByFrame => (1, 1),
            Pace::Ahead if self.input.has_pictures() => (PICTURES_AHEAD, POINTS_AHEAD),
            Pace::Ahead => (OUTLINES_AHEAD, POINTS_AHEAD),
        };
        let mut batch = Vec::new();
        while batch.len() < most && points_left > 0 && self.failure.is_none() {
            let Some(item) = self.input.next() else { break };
            // What came after Ctrl-C may be cut short.
            if interrupt::was_asked_for() {
                break;
            }
            match item {
                Ok(Item::Outline(frame, seen_in)) => {
                    points_left = points_left.saturating_sub(frame.outline.point_count());
                    batch.push(Taken::Outline(frame, seen_in));
                }
                Ok(Item::Rejected { object, frame, reason }) => batch.push(Taken::Rejected { object, frame, reason }),
                Ok(Item::Missing { reason, is_damage }) => self.miss(reason, is_damage),
                Err(failure) => self.failure = Some(failure),
            }
        }
        batch
    }

    fn miss(&mut self, reason: String, is_damage: bool) {
        // The reason of a single picture is told in the end.
        if !self.quiet && self.input.frame_count() != Some(1) {
            self.progress.pause(|| warn(&reason));
        }
        self.progress.advance();
        self.first_missing.get_or_insert((reason, is_damage));
    }

    /// Why the reading ended before its time, or found nothing.
    pub(crate) fn end(self, nothing_found: bool) -> Option<Failure> {
        self.failure.or(match self.first_missing {
            // Nothing but pictures without an object: the first says why.
            Some((reason, true)) if nothing_found => Some(Failure::unusable(reason)),
            Some((reason, false)) if nothing_found => Some(Failure::no_result(reason)),
            _ => None,
        })
    }
}
