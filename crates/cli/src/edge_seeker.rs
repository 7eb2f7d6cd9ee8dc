//! Objects in pictures that are not found as a whole: their edges are looked for where they are expected.
use std::collections::{BTreeMap, HashMap};
use std::rc::Rc;

use freeform_motion::Tracker;
use freeform_motion::curve_fit::{Outline, Piece};
use freeform_motion::outline_io::{EdgeProfile, SourcePicture, readable};
use freeform_motion::tracker::{ExpectedOutline, Followed, FrameRanges, Recorded};
use nalgebra::Point2;

use crate::reader::Event;
use crate::seen::Item;

/// Pictures in a row that an object is looked for in by its edges alone: half a second at 30 frames/s. What is looked for where it is expected, and
/// found there, confirms what was expected.
const MOST_IN_A_ROW: u64 = 15;

/// Standard deviations of the place expected that edges are looked for in, and pixels beyond them.
const DEVIATIONS: f64 = 4.0;
const PIXELS: f64 = 3.0;

/// Share of the points found that may lie on the outline of another object of the picture, and how near that is, in pixels: its edges are not
/// those of the object looked for, also where both look alike.
const ON_ANOTHER: f64 = 0.3;
const NEAR_ANOTHER: f64 = 2.5;

/// Objects that are named at the end.
const OBJECTS_NAMED: usize = 4;

/// What the edges of the objects look like, and where they were looked for.
#[derive(Debug, Default)]
pub(crate) struct EdgeSeeker {
    objects: HashMap<String, Known>,
    found: BTreeMap<String, FrameRanges>,
    /// Number of the present picture, and what was taken of which object in it.
    picture: u64,
    taken: Vec<(String, Outline)>,
    /// Frames of objects beyond those that are named.
    frames_of_others: u64,
}

/// An object in pictures.
#[derive(Debug, Default)]
struct Known {
    profile: EdgeProfile,
    /// Number of the last picture that the object was found in as a whole, and of the last that it was looked for in.
    traced: u64,
    looked_for: Option<u64>,
}

impl Known {
    /// Arcs of the object in a picture where it is expected, if they are not those of another.
    fn seek(
        &self,
        name: &str,
        seen_in: &SourcePicture,
        expected: &ExpectedOutline,
        taken: &[(String, Outline)],
    ) -> Option<Outline> {
        let SourcePicture { frame, picture, grid, .. } = seen_in;
        if frame.saturating_sub(self.traced) > MOST_IN_A_ROW {
            return None;
        }
        let pixel = grid.pixel_size().max();
        let reach = DEVIATIONS * expected.deviation + PIXELS * pixel;
        let found = self.profile.seek(picture, grid, pieces(expected), reach)?.outline;
        let others = || taken.iter().filter(|(other, _)| other != name).flat_map(|(_, outline)| outline.points());
        let is_another = |p: &&Point2<f64>| others().any(|q| (q - *p).norm() < NEAR_ANOTHER * pixel);
        let on_another = found.points().filter(is_another).count();
        (on_another as f64 <= ON_ANOTHER * found.point_count() as f64).then_some(found)
    }
}

fn pieces(expected: &ExpectedOutline) -> impl Iterator<Item = Piece<'_>> {
    expected.pieces.iter().map(|piece| Piece { points: &piece.points, closed: piece.closed })
}

impl EdgeSeeker {
    /// Has a tracker take what comes next, and hands on what it gave.
    pub(crate) fn push(&mut self, tracker: &mut Tracker, item: Item) -> Event {
        let (frame, seen_in) = match item {
            Recorded::Gap(missing) => return Followed::Gap(missing),
            Recorded::NoOutline { object, frame, reason } => {
                return Followed::Object(tracker.reject(&object, frame, reason), None);
            }
            Recorded::Outline(frame, None) => return Followed::Object(tracker.push(&frame), Some((frame, None))),
            Recorded::Outline(frame, Some(seen_in)) => (frame, seen_in),
        };
        self.begin(seen_in.frame);
        let taken = &self.taken;
        let known = self.objects.entry(frame.object.clone()).or_default();
        known.looked_for = Some(seen_in.frame);
        let (observation, arcs) = if known.profile.is_known() {
            tracker.push_or_seek(&frame, |expected| known.seek(&frame.object, &seen_in, expected, taken))
        } else {
            (tracker.push(&frame), None)
        };
        let taken = match arcs {
            Some(arcs) => {
                self.count(&arcs.object, seen_in.frame);
                arcs
            }
            None => {
                if observation.is_accepted() {
                    known.traced = seen_in.frame;
                    if let Some(seen) = tracker.expected_outline(&frame.object, frame.time) {
                        known.profile.take(&seen_in.picture, &seen_in.grid, pieces(&seen));
                    }
                }
                frame
            }
        };
        if observation.is_accepted() {
            self.taken.push((taken.object.clone(), taken.outline.clone()));
        }
        Followed::Object(observation, Some((taken, Some(seen_in))))
    }

    /// Forgets what was taken in the picture before, and objects that will not be looked for any more.
    fn begin(&mut self, picture: u64) {
        if picture != self.picture {
            self.picture = picture;
            self.taken.clear();
            self.objects.retain(|_, known| picture.saturating_sub(known.traced) <= MOST_IN_A_ROW);
        }
    }

    /// Looks for the objects that nothing was found of in a picture. What is found comes in the order of their names.
    pub(crate) fn seek_others(&mut self, tracker: &mut Tracker, seen_in: &Rc<SourcePicture>) -> Vec<Event> {
        self.begin(seen_in.frame);
        let is_missing = |known: &Known| known.looked_for != Some(seen_in.frame) && known.profile.is_known();
        let mut missing: Vec<(&String, &mut Known)> =
            self.objects.iter_mut().filter(|(_, known)| is_missing(known)).collect();
        missing.sort_by_key(|(name, _)| *name);
        let mut events = Vec::new();
        for (name, known) in missing {
            known.looked_for = Some(seen_in.frame);
            let taken = &self.taken;
            let sought =
                tracker.seek(name, seen_in.frame, seen_in.time, |expected| known.seek(name, seen_in, expected, taken));
            self.taken.extend(sought.iter().map(|(_, arcs)| (arcs.object.clone(), arcs.outline.clone())));
            events.extend(sought);
        }
        events.iter().for_each(|(_, arcs)| self.count(&arcs.object, seen_in.frame));
        let with_picture = |(observation, arcs)| Followed::Object(observation, Some((arcs, Some(Rc::clone(seen_in)))));
        events.into_iter().map(with_picture).collect()
    }

    fn count(&mut self, object: &str, frame: u64) {
        if self.found.len() < OBJECTS_NAMED || self.found.contains_key(object) {
            self.found.entry(object.to_owned()).or_default().add(frame);
        } else {
            self.frames_of_others += 1;
        }
    }

    /// Forgets an object that has left.
    pub(crate) fn forget(&mut self, object: &str) {
        self.objects.remove(object);
    }

    /// In which frames arcs were found by their edges, in place of outlines.
    pub(crate) fn notes(&self) -> Vec<String> {
        let reason =
            "it was not found as a whole, and parts of it were found by their edges where it was expected, in frames";
        let note = |(name, frames): (&String, &FrameRanges)| format!("object {}: {reason} {frames}", readable(name));
        let mut notes: Vec<String> = self.found.iter().map(note).collect();
        if self.frames_of_others > 0 {
            notes.push(format!("the same for other objects, in {} of their frames together", self.frames_of_others));
        }
        notes
    }
}
