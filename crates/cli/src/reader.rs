//! An input as it is gone through.
use std::num::NonZero;
use std::thread::available_parallelism;

use crate::failure::{Failure, warn};
use crate::input::{Input, Item};
use crate::interrupt;
use crate::left_out::{Missing, MissingWarnings};
use crate::progress::{Progress, would_stand_in_output};

/// How an input is gone through.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Pace {
    /// Every frame is dealt with before the next one is read: what it gave is known as soon as it is complete.
    FrameByFrame,
    /// Many frames are read while those before are dealt with.
    Ahead,
}

impl Pace {
    /// How many threads there may be work for, this one among them.
    pub(crate) fn threads(self) -> usize {
        match self {
            Self::FrameByFrame => 1,
            Self::Ahead => available_parallelism().map_or(1, NonZero::get),
        }
    }
}

/// Reads an input, and says what is missing in it.
pub(crate) struct Reader<'a> {
    input: &'a mut Input,
    quiet: bool,
    has_ended: bool,
    pub(crate) progress: Progress,
    warnings: MissingWarnings,
    failure: Option<Failure>,
}

impl<'a> Reader<'a> {
    pub(crate) fn new(input: &'a mut Input, pace: Pace, quiet: bool) -> Self {
        let is_in_the_way = pace == Pace::FrameByFrame && would_stand_in_output();
        let progress = Progress::of_frames(input.frame_count(), quiet || is_in_the_way);
        Self { input, quiet, has_ended: false, progress, warnings: MissingWarnings::default(), failure: None }
    }

    /// What comes next; nothing any more from the end of the input, an error that ends it, or Ctrl-C on.
    pub(crate) fn next(&mut self) -> Option<Item> {
        if self.has_ended {
            return None;
        }
        // What came after Ctrl-C may be cut short.
        let item = match self.input.next().filter(|_| !interrupt::was_asked_for()) {
            Some(Ok(item)) => Some(item),
            Some(Err(failure)) => {
                self.failure = Some(failure);
                None
            }
            None => None,
        };
        if let Some(Item::Missing(missing)) = &item {
            self.tell(missing);
        }
        self.has_ended = item.is_none();
        item
    }

    fn tell(&mut self, missing: &Missing) {
        // The reason of a single picture is told in the end.
        if self.quiet || self.input.frame_count() == Some(1) {
            return;
        }
        if let Some(warning) = self.warnings.take(missing) {
            self.progress.pause(|| warn(&warning));
        }
    }

    /// Says what has been left for the end of the reading, and why that came before its time, if it did.
    pub(crate) fn finish(self) -> Option<Failure> {
        let Self { progress, warnings, failure, .. } = self;
        warnings.finish().for_each(|warning| progress.pause(|| warn(&warning)));
        failure
    }
}
