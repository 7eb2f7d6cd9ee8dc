use std::collections::{BTreeMap, HashMap};

use freeform_curve_fit::{Outline, Piece};
use freeform_outline_filter::ExpectedOutline;
use freeform_outline_io::{EdgeProfile, SourcePicture};
use nalgebra::Point2;

use super::{
    Tracker,
    recording::{Followed, Recorded},
};
use crate::frame_ranges::FrameRanges;

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

/// Objects whose frames are told apart.
const OBJECTS_NAMED: usize = 4;

/// Follows objects in pictures, and looks for the edges of those that are not found as a whole where they are expected. An object that is partly
/// hidden, or touches another, is so still seen by the arcs that show. What the edges of an object look like is learnt from the frames that fit.
///
/// ```
/// use freeform_motion::outline_io::{OutlineFrame, SourcePicture};
/// use freeform_motion::tracker::{EdgeSeeker, Followed, Recorded};
/// use freeform_motion::{Tracker, TrackerSettings};
///
/// /// What comes of a picture and the outlines that were traced in it.
/// fn observations(
///     tracker: &mut Tracker,
///     seeker: &mut EdgeSeeker,
///     source: &SourcePicture,
///     outlines: Vec<OutlineFrame>,
/// ) -> Vec<Followed<Option<SourcePicture>, ()>> {
///     let items = outlines.into_iter().map(|outline| Recorded::Outline(outline, Some(source.clone())));
///     let mut found: Vec<_> = items.map(|item| seeker.push(tracker, item)).collect();
///     found.extend(seeker.seek_others(tracker, source));
///     found
/// }
/// # let mut tracker = Tracker::new(TrackerSettings::default())?;
/// # let grid = freeform_motion::outline_io::TraceSettings::default().pixel_grid(30);
/// # let picture = std::sync::Arc::new(freeform_motion::outline_io::GrayImage::new(30, 30));
/// # let source = SourcePicture { frame: 0, time: 0.0, picture, grid };
/// # assert!(observations(&mut tracker, &mut EdgeSeeker::default(), &source, Vec::new()).is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Default)]
pub struct EdgeSeeker {
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
        source: &SourcePicture,
        expected: &ExpectedOutline,
        taken: &[(String, Outline)],
    ) -> Option<Outline> {
        let SourcePicture { frame, picture, grid, .. } = source;
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
    /// Has a tracker take what comes next, and returns what it gave. If an outline does not fit, arcs found by their edges are taken in its place.
    pub fn push<G>(
        &mut self,
        tracker: &mut Tracker,
        item: Recorded<Option<SourcePicture>, G>,
    ) -> Followed<Option<SourcePicture>, G> {
        let (frame, source) = match item {
            Recorded::Gap(missing) => return Followed::Gap(missing),
            Recorded::NoOutline { object, frame, reason } => {
                return Followed::Object(tracker.reject(&object, frame, reason), None);
            }
            Recorded::Outline(frame, None) => return Followed::Object(tracker.push(&frame), Some((frame, None))),
            Recorded::Outline(frame, Some(source)) => (frame, source),
        };
        self.begin(source.frame);
        let taken = &self.taken;
        let known = self.objects.entry(frame.object.clone()).or_default();
        known.looked_for = Some(source.frame);
        let (observation, arcs) = if known.profile.is_known() {
            tracker.push_or_seek(&frame, |expected| known.seek(&frame.object, &source, expected, taken))
        } else {
            (tracker.push(&frame), None)
        };
        let taken = match arcs {
            Some(arcs) => {
                self.count(&arcs.object, source.frame);
                arcs
            }
            None => {
                if observation.is_accepted() {
                    known.traced = source.frame;
                    if let Some(seen) = tracker.expected_outline(&frame.object, frame.time) {
                        known.profile.take(&source.picture, &source.grid, pieces(&seen));
                    }
                }
                frame
            }
        };
        if observation.is_accepted() {
            self.taken.push((taken.object.clone(), taken.outline.clone()));
        }
        Followed::Object(observation, Some((taken, Some(source))))
    }

    /// Forgets what was taken in the picture before, and objects that will not be looked for any more.
    fn begin(&mut self, picture: u64) {
        if picture != self.picture {
            self.picture = picture;
            self.taken.clear();
            self.objects.retain(|_, known| picture.saturating_sub(known.traced) <= MOST_IN_A_ROW);
        }
    }

    /// After the last outline of a picture: looks for the objects that nothing was found of in it. What is found comes in the order of their names.
    pub fn seek_others<G>(
        &mut self,
        tracker: &mut Tracker,
        source: &SourcePicture,
    ) -> Vec<Followed<Option<SourcePicture>, G>> {
        self.begin(source.frame);
        let is_missing = |known: &Known| known.looked_for != Some(source.frame) && known.profile.is_known();
        let mut missing: Vec<(&String, &mut Known)> =
            self.objects.iter_mut().filter(|(_, known)| is_missing(known)).collect();
        missing.sort_by_key(|(name, _)| *name);
        let mut events = Vec::new();
        for (name, known) in missing {
            known.looked_for = Some(source.frame);
            let taken = &self.taken;
            let sought =
                tracker.seek(name, source.frame, source.time, |expected| known.seek(name, source, expected, taken));
            self.taken.extend(sought.iter().map(|(_, arcs)| (arcs.object.clone(), arcs.outline.clone())));
            events.extend(sought);
        }
        events.iter().for_each(|(_, arcs)| self.count(&arcs.object, source.frame));
        let with_picture = |(observation, arcs)| Followed::Object(observation, Some((arcs, Some(source.clone()))));
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
    pub fn forget(&mut self, object: &str) {
        self.objects.remove(object);
    }

    /// The first objects of which arcs were found by their edges in place of outlines, in the order of their names, with these frames.
    pub fn found(&self) -> impl Iterator<Item = (&str, &FrameRanges)> {
        self.found.iter().map(|(name, frames)| (name.as_str(), frames))
    }

    /// Number of such frames of the other objects together.
    #[must_use]
    pub const fn frames_of_others(&self) -> u64 {
        self.frames_of_others
    }
}
