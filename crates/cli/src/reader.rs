//! An input as it is gone through.
use std::num::NonZero;
use std::rc::Rc;

use freeform_motion::Tracker;
use freeform_motion::tracker::{Attendance, Followed, ObjectResult, ReadAhead, Recorded, Sighting};

use crate::failure::{Failure, warn};
use crate::input::Input;
use crate::interrupt;
use crate::left_out::MissingWarnings;
use crate::progress::{Progress, would_stand_in_output};
use crate::seen::{Item, Missing, SeenIn};

/// Outlines from pictures read ahead, which are held with their pictures.
const OUTLINES_OF_PICTURES_AHEAD: NonZero<usize> = NonZero::new(32).expect("positive");

/// What comes of reading on: a frame of an object, as far as it could be read, with the picture that it was seen in, if it was; or a
/// picture without an outline.
pub(crate) type Event = Followed<Option<Rc<SeenIn>>, Missing>;

/// An object of a stream that has left.
pub(crate) struct Left {
    pub(crate) seen: Sighting,
    pub(crate) result: ObjectResult,
}

/// Has a tracker take all frames of an input, many of which are read while those before are dealt with, and hands on what each gave.
/// Returns the error that ended the reading, if any; what came before it has been taken.
pub(crate) fn follow(
    tracker: &mut Tracker,
    input: &mut Input,
    quiet: bool,
    mut observe: impl FnMut(&Event) -> Result<(), Failure>,
) -> Result<Option<Failure>, Failure> {
    let progress = Progress::of_frames(input.frame_count(), quiet);
    let ahead = match input.has_pictures() {
        true => ReadAhead { outlines: OUTLINES_OF_PICTURES_AHEAD, ..ReadAhead::default() },
        false => ReadAhead::default(),
    };
    let mut reader = Reader::new(input, quiet, &progress);
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

/// As [`follow`], but deals with every frame before the next one is read, so that what it gave is known as soon as it is complete,
/// and closes objects that have left, which are handed on too.
pub(crate) fn follow_stream(
    tracker: &mut Tracker,
    input: &mut Input,
    quiet: bool,
    mut observe: impl FnMut(Result<&Event, &Left>) -> Result<(), Failure>,
) -> Result<Option<Failure>, Failure> {
    let progress = Progress::of_frames(input.frame_count(), quiet || would_stand_in_output());
    let mut reader = Reader::new(input, quiet, &progress);
    let (mut first_missing, mut is_any_seen) = (None, false);
    let mut present = Attendance::default();
    for item in reader.by_ref() {
        let (event, left) = match item {
            Recorded::Gap(missing) => (Followed::Gap(missing), Vec::new()),
            Recorded::Outline(frame, seen_in) => {
                let left = present.take(&frame.object, frame.frame, Some(frame.time));
                (Followed::Object(tracker.push(&frame), Some((frame, seen_in))), left)
            }
            Recorded::NoOutline { object, frame, reason } => {
                let left = present.take(&object, frame, None);
                (Followed::Object(tracker.reject(&object, frame, reason), None), left)
            }
        };
        for seen in left {
            if let Some(result) = tracker.close(&seen.object) {
                observe(Err(&Left { seen, result }))?;
            }
        }
        observe(Ok(&event))?;
        match event {
            Followed::Gap(missing) => {
                first_missing.get_or_insert(missing);
            }
            Followed::Object(..) => is_any_seen = true,
        }
        progress.advance();
    }
    let nothing = first_missing.filter(|_| !is_any_seen).map(Missing::into_failure);
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

impl<'a> Reader<'a> {
    fn new(input: &'a mut Input, quiet: bool, progress: &'a Progress) -> Self {
        if !quiet {
            progress.pause(|| input.tell());
        }
        Self { input, quiet, progress, warnings: MissingWarnings::default(), failure: None }
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
    fn finish(self) -> Option<Failure> {
        let Self { input, quiet, progress, warnings, failure } = self;
        if !quiet {
            progress.pause(|| input.tell_in_the_end());
        }
        warnings.finish().for_each(|warning| progress.pause(|| warn(&warning)));
        failure
    }
}
