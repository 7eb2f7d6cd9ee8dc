//! An input as it is gone through.
use freeform_motion::Tracker;
use freeform_motion::outline_io::{SourcePicture, readable};
use freeform_motion::tracker::{Attendance, EdgeSeeker, Followed, ReadAhead, Recorded};

use crate::failure::{Failure, note, warn};
use crate::input::Input;
use crate::interrupt;
use crate::left_out::MissingWarnings;
use crate::picture_input::Purpose;
use crate::progress::{Progress, Verbosity, would_stand_in_output};
use crate::seen::{Item, Left, Missing};

/// What comes of reading on: a frame of an object, as far as it could be read, with the picture that it was seen in, if it was; or a
/// picture without an outline.
pub(crate) type Event = Followed<Option<SourcePicture>, Missing>;

/// Has a tracker take all frames of an input, and hands on what each gave. Many rows of a file are read while those before are dealt with; a
/// picture is dealt with before the next one is read, as what is known of an object helps to find it there.
/// Returns the error that ended the reading, if any; what came before it has been taken.
pub(crate) fn follow(
    tracker: &mut Tracker,
    input: &mut Input,
    verbosity: Verbosity,
    mut observe: impl FnMut(&Event) -> Result<(), Failure>,
) -> Result<Option<Failure>, Failure> {
    let progress = Progress::of_frames(input.frame_count(), verbosity.is_quiet());
    let has_pictures = input.has_pictures();
    let mut reader = Reader::new(input, verbosity, &progress);
    let mut first_missing = None;
    let mut hand_on = |event: Event| {
        observe(&event)?;
        if let Followed::Gap(missing) = event {
            first_missing.get_or_insert(missing);
        }
        progress.advance();
        Ok(())
    };
    if has_pictures {
        while let Some(item) = reader.next() {
            let events = reader.events_of(tracker, item);
            events.into_iter().try_for_each(&mut hand_on)?;
        }
    } else {
        tracker.follow_recording(&mut reader, ReadAhead::default(), hand_on)?;
    }
    // Nothing but pictures without an object: the first says why.
    let nothing = first_missing.filter(|_| tracker.objects().len() == 0).map(Missing::into_failure);
    Ok(reader.finish().or(nothing))
}

/// As [`follow`], but deals with every frame before the next one is read, so that what it gave is known as soon as it is complete,
/// and closes objects that have left, which are handed on too.
pub(crate) fn follow_stream(
    tracker: &mut Tracker,
    input: &mut Input,
    verbosity: Verbosity,
    mut observe: impl FnMut(Result<&Event, &Left>) -> Result<(), Failure>,
) -> Result<Option<Failure>, Failure> {
    let progress = Progress::of_frames(input.frame_count(), verbosity.is_quiet() || would_stand_in_output());
    let mut reader = Reader::new(input, verbosity, &progress);
    let (mut first_missing, mut is_any_seen) = (None, false);
    let mut present = Attendance::default();
    while let Some(item) = reader.next() {
        // Before a name comes again that is that of a new object by now.
        let left = match &item {
            Recorded::Gap(_) => Vec::new(),
            Recorded::Outline(frame, _) => present.take(&frame.object, frame.frame, Some(frame.time)),
            Recorded::NoOutline { object, frame, .. } => present.take(object, *frame, None),
        };
        for seen in left {
            reader.seeker.forget(&seen.object);
            if let Some(result) = tracker.close(&seen.object) {
                observe(Err(&Left { seen, result }))?;
            }
        }
        for event in reader.events_of(tracker, item) {
            observe(Ok(&event))?;
            match event {
                Followed::Gap(missing) => {
                    first_missing.get_or_insert(missing);
                }
                Followed::Object(..) => is_any_seen = true,
            }
            progress.advance();
        }
    }
    let nothing = first_missing.filter(|_| !is_any_seen).map(Missing::into_failure);
    Ok(reader.finish().or(nothing))
}

/// Reads an input, and says what is missing in it.
struct Reader<'a> {
    input: &'a mut Input,
    verbosity: Verbosity,
    progress: &'a Progress,
    warnings: MissingWarnings,
    failure: Option<Failure>,
    seeker: EdgeSeeker,
}

impl Iterator for Reader<'_> {
    type Item = Item;

    /// What comes next; nothing from the end of the input, an error that ends it, or Ctrl-C on.
    fn next(&mut self) -> Option<Item> {
        // What came after Ctrl-C may be cut short.
        let item = self.input.next().filter(|_| !interrupt::was_asked_for())?;
        if !self.verbosity.is_quiet() {
            self.progress.warn_of(&self.input.news());
        }
        match item {
            Ok(item) => Some(item),
            Err(failure) => {
                self.failure = Some(failure);
                None
            }
        }
    }
}

impl<'a> Reader<'a> {
    fn new(input: &'a mut Input, verbosity: Verbosity, progress: &'a Progress) -> Self {
        if !verbosity.is_quiet() {
            progress.pause(|| input.tell());
        }
        let (warnings, seeker) = (MissingWarnings::default(), EdgeSeeker::default());
        Self { input, verbosity, progress, warnings, failure: None, seeker }
    }

    /// What an item gives, and, after the last one of a picture, the objects that were not in it but are found by their edges.
    fn events_of(&mut self, tracker: &mut Tracker, item: Item) -> Vec<Event> {
        if self.input.has_labels() {
            return vec![self.event_of_label(tracker, item)];
        }
        let event = self.seeker.push(tracker, item);
        let seen_in = match &event {
            Followed::Object(_, Some((_, seen_in))) => seen_in.clone(),
            Followed::Object(_, None) => None,
            Followed::Gap(missing) => missing.seen_in.clone(),
        };
        let mut events = match seen_in.filter(|_| self.input.is_picture_over()) {
            Some(seen_in) => self.seeker.seek_others(tracker, &seen_in),
            None => Vec::new(),
        };
        let found = events.iter().filter_map(|event| match event {
            Followed::Object(observation, _) => Some((observation.object.as_str(), observation.frame)),
            Followed::Gap(_) => None,
        });
        found.for_each(|(object, frame)| self.input.keep(object, frame));
        match &event {
            Followed::Gap(missing) if events.is_empty() => self.tell(missing),
            // The objects are there, though not as a whole.
            Followed::Gap(_) => return events,
            Followed::Object(..) => {}
        }
        events.insert(0, event);
        events
    }

    /// What a label gives: where it is not, it is nowhere, so that nothing is looked for by its edges.
    fn event_of_label(&mut self, tracker: &mut Tracker, item: Item) -> Event {
        let (item, picture) = match item {
            Recorded::Outline(frame, picture) => (Recorded::Outline(frame, None), picture),
            other => (other, None),
        };
        match self.seeker.push(tracker, item) {
            Followed::Object(observation, seen) => {
                Followed::Object(observation, seen.map(|(frame, _)| (frame, picture)))
            }
            Followed::Gap(missing) => {
                self.tell(&missing);
                Followed::Gap(missing)
            }
        }
    }

    fn tell(&mut self, missing: &Missing) {
        // The reason of a single picture is told in the end.
        if self.verbosity.is_quiet() || self.input.frame_count() == Some(1) {
            return;
        }
        if let Some(warning) = self.warnings.take(missing) {
            self.progress.pause(|| warn(&warning));
        }
    }

    /// Says what has been left for the end of the reading, and why that came before its time, if it did.
    fn finish(self) -> Option<Failure> {
        let Self { input, verbosity, progress, warnings, failure, seeker } = self;
        if !verbosity.is_quiet() {
            progress.pause(|| input.tell_in_the_end(Purpose::Motions));
            edge_notes(&seeker).iter().for_each(|told| progress.pause(|| note(told)));
        }
        warnings.finish().for_each(|warning| progress.pause(|| warn(&warning)));
        failure
    }
}

/// In which frames objects were found by their edges, in place of outlines.
fn edge_notes(seeker: &EdgeSeeker) -> Vec<String> {
    let reason =
        "it was not found as a whole, and parts of it were found by their edges where it was expected, in frame(s)";
    let mut notes: Vec<String> =
        seeker.found().map(|(name, frames)| format!("object {}: {reason} {frames}", readable(name))).collect();
    if seeker.frames_of_others() > 0 {
        notes.push(format!("the same for other objects, in {} of their frames together", seeker.frames_of_others()));
    }
    notes
}
