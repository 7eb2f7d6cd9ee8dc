//! Frames of an input that are taken together.
use std::rc::Rc;

use freeform_motion::outline_io::OutlineFrame;

use crate::failure::{Failure, warn};
use crate::input::{Input, Item, SeenIn};
use crate::interrupt;
use crate::left_out::{Missing, MissingWarnings};
use crate::progress::{Progress, would_stand_in_output};

/// Points of all outlines read ahead at least: a quarter of a megabyte. Enough for the frames of a batch to be many times
/// the work of sharing them out; not more, since nothing goes on beside the reading of the first batch.
const LEAST_POINTS_AHEAD: usize = 1 << 14;
/// Points read ahead at most, as long as those before are dealt with: four megabytes.
const MOST_POINTS_AHEAD: usize = 1 << 18;
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

/// What was read: of one object in one frame, or of a picture that shows none.
pub(crate) enum Taken {
    /// An outline, and the picture that it was seen in, if it was.
    Outline(OutlineFrame, Option<Rc<SeenIn>>),
    /// An outline that is none, with the reason.
    Rejected { object: String, frame: u64, reason: String },
    /// A picture without an outline.
    Missing(Missing),
}

/// Reads an input batch by batch.
pub(crate) struct BatchReader<'a> {
    input: &'a mut Input,
    pace: Pace,
    quiet: bool,
    pub(crate) progress: Progress,
    warnings: MissingWarnings,
    failure: Option<Failure>,
}

impl<'a> BatchReader<'a> {
    pub(crate) fn new(input: &'a mut Input, pace: Pace, quiet: bool) -> Self {
        let is_in_the_way = pace == Pace::FrameByFrame && would_stand_in_output();
        let progress = Progress::of_frames(input.frame_count(), quiet || is_in_the_way);
        Self { input, pace, quiet, progress, warnings: MissingWarnings::default(), failure: None }
    }

    /// The next frames; none at the end of the input, at an error that ends it, and after Ctrl-C. Beyond what is read at
    /// least it goes on while there is time: as long as the frames before are still dealt with.
    pub(crate) fn batch(&mut self, is_time: impl Fn() -> bool) -> Vec<Taken> {
        let most = match self.pace {
            Pace::FrameByFrame => 1,
            Pace::Ahead if self.input.has_pictures() => PICTURES_AHEAD,
            Pace::Ahead => OUTLINES_AHEAD,
        };
        let mut batch = Vec::new();
        let mut points = 0;
        while batch.len() < most && self.failure.is_none() {
            if points >= MOST_POINTS_AHEAD || points >= LEAST_POINTS_AHEAD && !is_time() {
                break;
            }
            let Some(item) = self.input.next() else { break };
            // What came after Ctrl-C may be cut short.
            if interrupt::was_asked_for() {
                break;
            }
            match item {
                Ok(Item::Outline(frame, seen_in)) => {
                    points += frame.outline.point_count();
                    batch.push(Taken::Outline(frame, seen_in));
                }
                Ok(Item::Rejected { object, frame, reason }) => batch.push(Taken::Rejected { object, frame, reason }),
                Ok(Item::Missing(missing)) => {
                    self.tell(&missing);
                    batch.push(Taken::Missing(missing));
                }
                Err(failure) => self.failure = Some(failure),
            }
        }
        batch
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
