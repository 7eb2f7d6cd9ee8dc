//! What the rows of a file look like, where that is hardly what was meant.
use freeform_motion::curve_fit::{Outline, Piece};
use freeform_motion::outline_io::OutlineFrame;
use freeform_motion::significant;
use freeform_motion::tracker::Observation;
use nalgebra::{Point2, distance};

/// Frames whose points are looked at.
const FRAMES: usize = 5;

/// A step along a contour is a jump if it is longer than so many of the usual ones.
const JUMP: f64 = 8.0;

/// A part between two jumps is a contour of its own if its last point is no further from its first than so many usual steps.
const CLOSING: f64 = 3.0;

/// Fewest points of such a part.
const FEWEST: usize = 5;

/// Seconds from frame to frame that no camera is likely to take.
const SLOW: f64 = 10.0;
const FAST: f64 = 1e-4;

/// Most points of outlines that may be the corners of polygons.
const MOST_CORNERS: usize = 24;

/// What to say of an input beside its results.
#[derive(Debug, Default)]
pub(crate) struct Hints {
    looked_at: usize,
    /// Number of the first frame that has two contours in one.
    two_contours: Option<(String, u64)>,
    pace: Option<Pace>,
    corners: Corners,
}

/// How many points the outlines have.
#[derive(Debug, Default)]
enum Corners {
    #[default]
    Unseen,
    /// All of them so many.
    Same(usize),
    /// Different numbers.
    Various,
}

/// The times of one object.
#[derive(Debug)]
struct Pace {
    object: String,
    first: f64,
    last: f64,
    frames: usize,
}

impl Hints {
    /// Looks at a frame.
    pub(crate) fn take(&mut self, observation: &Observation, frame: Option<&OutlineFrame>) {
        if let Some(time) = observation.time {
            let new = || Pace { object: observation.object.clone(), first: time, last: time, frames: 0 };
            let pace = self.pace.get_or_insert_with(new);
            if pace.object == observation.object {
                (pace.last, pace.frames) = (time, pace.frames + 1);
            }
        }
        if let Some(frame) = frame {
            let count = frame.outline.point_count();
            self.corners = match self.corners {
                Corners::Unseen => Corners::Same(count),
                Corners::Same(known) if known == count => Corners::Same(count),
                _ => Corners::Various,
            };
        }
        if let Some(frame) = frame.filter(|_| self.looked_at < FRAMES && self.two_contours.is_none()) {
            self.looked_at += 1;
            self.two_contours = are_two_contours(&frame.outline).then(|| (frame.object.clone(), frame.frame));
        }
    }

    /// What there is to say of an input, of which something is not stated.
    pub(crate) fn told(&self, lacks_values: bool) -> Vec<String> {
        let contours = self.two_contours.as_ref().map(|(object, frame)| {
            format!(
                "object {object}: the points of frame {frame} seem to be two contours, one after the other: add a column object, or a \
                 column contour if both are of one body"
            )
        });
        let step = self.pace.as_ref().filter(|pace| pace.frames > 1).map(Pace::step);
        let pace = step
            .filter(|step| *step > SLOW || *step < FAST)
            .map(|step| format!("one frame every {} s: times and rates are in seconds", significant(step, 3)));
        let corners = match self.corners {
            Corners::Same(count) if count <= MOST_CORNERS && lacks_values => Some(format!(
                "every outline has {count} points: if they are the corners of polygons, give points along the sides too: the \
                 corners alone tell too little"
            )),
            _ => None,
        };
        contours.into_iter().chain(pace).chain(corners).collect()
    }
}

impl Pace {
    /// Seconds from frame to frame.
    fn step(&self) -> f64 {
        (self.last - self.first) / (self.frames - 1) as f64
    }
}

/// Whether a closed contour jumps twice, between two parts that each close by themselves. Where parts of one contour are hidden, it jumps too, but
/// what is left of it does not close.
fn are_two_contours(outline: &Outline) -> bool {
    let mut pieces = outline.pieces();
    let (Some(Piece { points, closed: true, .. }), None) = (pieces.next(), pieces.next()) else { return false };
    let next = |index: usize| &points[(index + 1) % points.len()];
    let steps: Vec<f64> = (0..points.len()).map(|index| distance(&points[index], next(index))).collect();
    let mut sorted = steps.clone();
    sorted.sort_unstable_by(f64::total_cmp);
    let usual = sorted[sorted.len() / 2];
    let jumps: Vec<usize> = (0..steps.len()).filter(|index| steps[*index] > JUMP * usual).collect();
    let [first, second] = jumps[..] else { return false };
    let inner = &points[first + 1..=second];
    let outer = [&points[second + 1..], &points[..=first]].concat();
    let closes = |part: &[Point2<f64>]| match part {
        [first, .., last] => part.len() >= FEWEST && distance(first, last) <= CLOSING * usual,
        _ => false,
    };
    closes(inner) && closes(&outer)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    fn arc(middle: f64, from: f64, to: f64) -> Vec<Point2<f64>> {
        let angles = (0..40).map(|i| TAU * (from + (to - from) * f64::from(i) / 40.0));
        angles.map(|angle| Point2::new(middle + angle.cos(), angle.sin())).collect()
    }

    #[test]
    fn two_contours_in_one_are_told_from_one_of_which_two_parts_are_hidden() {
        let outline = |parts: &[Vec<Point2<f64>>]| Outline::closed(parts.concat()).expect("an outline");
        assert!(are_two_contours(&outline(&[arc(0.0, 0.0, 1.0), arc(5.0, 0.3, 1.3)])));
        assert!(!are_two_contours(&outline(&[arc(0.0, 0.0, 1.0)])));
        assert!(!are_two_contours(&outline(&[arc(0.0, 0.0, 0.25), arc(0.0, 0.5, 0.75)])));
    }

    #[test]
    fn a_pace_that_no_camera_has_is_told_and_an_ordinary_one_is_not() {
        let told = |step: f64| {
            let pace = Pace { object: "a".to_owned(), first: 0.0, last: 9.0 * step, frames: 10 };
            Hints { pace: Some(pace), ..Hints::default() }.told(false)
        };
        assert_eq!(told(33.3), ["one frame every 33.3 s: times and rates are in seconds"]);
        assert_eq!(told(3e-5).len(), 1);
        assert_eq!((told(1.0 / 30.0).len(), told(9.0).len()), (0, 0));
    }
}
