//! An input as it is gone through.
use std::num::NonZero;
use std::rc::Rc;

use freeform_motion::Tracker;
use freeform_motion::tracker::{Followed, ReadAhead};

use crate::failure::{Failure, warn};
use crate::input::Input;
use crate::interrupt;
use crate::left_out::MissingWarnings;
use crate::progress::{Progress, would_stand_in_output};
use crate::seen::{Item, Missing, SeenIn};

/// Outlines from pictures read ahead, which are held with their pictures.
const OUTLINES_OF_PICTURES_AHEAD: NonZero<usize> = NonZero::new(32).expect("positive");

/// How an input is gone through.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Pace {
    /// Every frame is dealt with before the next one is read: what it gave is known as soon as it is complete.
    FrameByFrame,
    /// Many frames are read while those before are dealt with.
    Ahead,
}

impl Pace {
    fn read_ahead(self, has_pictures: bool) -> ReadAhead {
        match self {
            Self::FrameByFrame => ReadAhead::FRAME_BY_FRAME,
            Self::Ahead if has_pictures => ReadAhead { outlines: OUTLINES_OF_PICTURES_AHEAD, ..ReadAhead::default() },
            Self::Ahead => ReadAhead::default(),
        }
    }
}

/// What comes of reading on: a frame of an object, as far as it could be read, with the picture that it was seen in, if it was; or a
/// picture without an outline.
pub(crate) type Event = Followed<Option<Rc<SeenIn>>, Missing>;

/// Has a tracker take all frames of an input and hands on what each gave. Returns the error that ended the reading, if any; what came
/// before it has been taken.
pub(crate) fn follow(
    tracker: &mut Tracker,
    input: &mut Input,
    pace: Pace,
    quiet: bool,
    mut observe: impl FnMut(&Event) -> Result<(), Failure>,
) -> Result<Option<Failure>, Failure> {
    let is_in_the_way = pace == Pace::FrameByFrame && would_stand_in_output();
    let progress = Progress::of_frames(input.frame_count(), quiet || is_in_the_way);
    let ahead = pace.read_ahead(input.has_pictures());
    let mut reader = Reader { input, quiet, progress: &progress, warnings: MissingWarnings::default(), failure: None };
    let mut first_missing = None;
    tracker.follow_recording(&mut reader, ahead, |event| {
        observe(&event)?;
        if let Followed::Gap(missing) = event {
            first_missing.get_or_insert(missing);
        }
        progress.advance();
        Ok(())
    })?;
    // Nothing but pictures without an object: the first says why.
    let nothing = first_missing.filter(|_| tracker.objects().len() == 0).map(Missing::into_failure);
    Ok(reader.finish().or(nothing))
}

/// Reads an input, and says what is missing in it.
struct Reader<'a> {
    input: &'a mut Input,
    quiet: bool,
    progress: &'a Progress,
    warnings: MissingWarnings,
    failure: Option<Failure>,
}

impl Iterator for Reader<'_> {
    type Item = Item;

    /// What comes next; nothing from the end of the input, an error that ends it, or Ctrl-C on.
    fn next(&mut self) -> Option<Item> {
        // What came after Ctrl-C may be cut short.
        let item = match self.input.next().filter(|_| !interrupt::was_asked_for())? {
            Ok(item) => item,
            Err(failure) => {
                self.failure = Some(failure);
                return None;
            }
        };
        if let Item::Gap(missing) = &item {
            self.tell(missing);
        }
        Some(item)
    }
}

impl Reader<'_> {
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
    fn finish(self) -> Option<Failure> {
        let Self { progress, warnings, failure, .. } = self;
        warnings.finish().for_each(|warning| progress.pause(|| warn(&warning)));
        failure
    }
}
