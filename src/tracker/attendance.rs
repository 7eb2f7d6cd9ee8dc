//! Which objects of a stream are still there.
use std::collections::{BTreeMap, HashMap};

/// Frames of a stream after which an object that was in none of them is taken to have left.
const PATIENCE: u64 = 1000;

/// Objects at once at most; of more, that has left which was not seen for longest. An object holds up to half a megabyte.
const MOST_OBJECTS: usize = 2048;

/// Keeps a list of the objects of a stream, so that those that have left can be closed ([`Tracker::close`](super::Tracker::close)) and
/// memory does not grow with their number.
///
/// An object has left when it was in none of the last 1000 frames, or when more than 2048 others were seen after it. Frames are counted
/// whenever the number of the frame changes, whatever the numbers and times are.
///
/// ```
/// use freeform_motion::tracker::Attendance;
///
/// let mut present = Attendance::default();
/// assert!(present.take("first", 0, Some(0.0)).is_empty());
/// let left: Vec<_> = (1..2000).flat_map(|frame| present.take("second", frame, Some(frame as f64))).collect();
/// assert_eq!((left.len(), left[0].object.as_str(), left[0].frame), (1, "first", 0));
/// ```
#[derive(Debug, Clone, Default)]
pub struct Attendance {
    /// By the number of their latest outline.
    by_outline: BTreeMap<u64, Sighting>,
    /// The number of the latest outline of each.
    outlines: HashMap<String, u64>,
    /// Outlines so far.
    outline: u64,
    /// Number of the latest frame, and how often it has changed.
    frame: Option<u64>,
    frames: u64,
}

/// When an object was last seen.
#[derive(Debug, Clone, PartialEq)]
pub struct Sighting {
    /// Its name.
    pub object: String,
    /// Number of the frame.
    pub frame: u64,
    /// Time in seconds, if the points were an outline.
    pub time: Option<f64>,
    /// Frames of the stream before it.
    frames: u64,
}

impl Attendance {
    /// Takes note of an object. Returns those that have left by now, each once.
    pub fn take(&mut self, object: &str, frame: u64, time: Option<f64>) -> Vec<Sighting> {
        if self.frame.replace(frame) != Some(frame) {
            self.frames += 1;
        }
        self.outline += 1;
        let seen = match self.outlines.get_mut(object) {
            Some(outline) => self.by_outline.remove(&std::mem::replace(outline, self.outline)),
            None => {
                self.outlines.insert(object.to_owned(), self.outline);
                None
            }
        };
        let object = seen.map_or_else(|| object.to_owned(), |seen| seen.object);
        self.by_outline.insert(self.outline, Sighting { object, frame, time, frames: self.frames });
        let mut left = Vec::new();
        while let Some(first) = self.by_outline.first_entry() {
            if first.get().frames + PATIENCE >= self.frames && self.outlines.len() <= MOST_OBJECTS {
                break;
            }
            let sighting = first.remove();
            self.outlines.remove(&sighting.object);
            left.push(sighting);
        }
        left
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_object_stays_while_it_is_seen_now_and_then_and_leaves_once() {
        let mut present = Attendance::default();
        for frame in 0..5000 {
            let mut left = present.take("always", frame, None);
            if frame % 900 == 0 {
                left.extend(present.take("sometimes", frame, None));
            }
            assert_eq!(left, []);
        }
        let left: Vec<u64> = (5000..9000).filter(|&frame| !present.take("always", frame, None).is_empty()).collect();
        assert_eq!(left, [4500 + PATIENCE + 1]);
        assert_eq!(present.outlines.len(), 1);
    }

    #[test]
    fn however_many_there_are_no_more_than_a_number_are_kept_and_those_seen_last() {
        let mut present = Attendance::default();
        let mut count = 0;
        for object in 0..10_000 {
            let left = present.take(&object.to_string(), 7, Some(0.5));
            assert!(left.iter().all(|left| left.object.parse::<usize>() == Ok(object - MOST_OBJECTS)));
            count += left.len();
        }
        assert_eq!((count, present.by_outline.len()), (10_000 - MOST_OBJECTS, MOST_OBJECTS));
    }
}
