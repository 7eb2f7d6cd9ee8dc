//! Frames that repeat the one before them.
use freeform_curve_fit::Outline;
use nalgebra::Point2;

use super::motion_change::MotionHistory;
use crate::{track::Track, tuning::supervisor::MOST_REPEATED};

/// The points of the last frame, when it was seen first, and how often it has been repeated.
///
/// A camera or a converter that stores pictures twice gives outlines that are the same to the last digit. They are no measurements of the times that
/// they are given with: their noise is that of the frame before.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct RepeatedFrames {
    points: Vec<Point2<f64>>,
    times: usize,
    /// Seconds.
    since: f64,
    /// Shortest time between frames one after the other that differ, s; none before the second.
    shortest_step: Option<f64>,
}

impl RepeatedFrames {
    /// Takes the outline of a frame at a time in seconds; whether it repeats the one before it, and not so often that the object must be at rest.
    pub(super) fn take(&mut self, time: f64, outline: &Outline) -> bool {
        if self.repeats(outline) {
            self.times = (self.times + 1).min(MOST_REPEATED + 1);
        } else {
            if !self.points.is_empty() {
                let step = time - self.since;
                self.shortest_step = Some(self.shortest_step.map_or(step, |shortest| shortest.min(step)));
            }
            self.since = time;
            self.points.clear();
            outline.pieces().for_each(|piece| self.points.extend_from_slice(piece.points));
            self.times = 0;
        }
        (1..=MOST_REPEATED).contains(&self.times)
    }

    /// Whether an outline has the points of the last frame, one after the other.
    fn repeats(&self, outline: &Outline) -> bool {
        let mut rest = self.points.as_slice();
        let is_same = outline.pieces().all(|piece| {
            let Some((points, others)) = rest.split_at_checked(piece.points.len()) else { return false };
            rest = others;
            points == piece.points
        });
        is_same && rest.is_empty()
    }

    /// Forgets the times between frames, of which a motion was not known.
    pub(super) fn forget_steps(&mut self) {
        self.shortest_step = None;
    }

    /// Shortest time between frames one after the other that differ, s; none before the second.
    pub(super) fn shortest_step(&self) -> Option<f64> {
        self.shortest_step
    }
}

/// What was known at the last frame that was looked at. After frames that repeat it the track stands at their times, so that what is stated does; the
/// next frame is looked at as if they had not been there.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct BeforeRepeated {
    pub(super) track: Track,
    pub(super) history: MotionHistory,
    pub(super) time: f64,
}

#[cfg(feature = "serde")]
impl RepeatedFrames {
    pub(super) fn is_valid(&self) -> bool {
        self.times <= MOST_REPEATED + 1 && self.since.is_finite() && self.shortest_step.is_none_or(|step| step > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_is_repeated_until_it_has_been_so_often_that_the_object_rests() {
        let outline = |shift: f64| {
            let point = |i: u32| Point2::new(shift + f64::from(i).cos(), f64::from(i).sin());
            Outline::closed((0..9).map(point).collect()).expect("an outline")
        };
        let mut frames = RepeatedFrames::default();
        let shifts = [0.0, 0.0, 1e-15, 1e-15, 1e-15, 1e-15, 1e-15, 1e-15, 0.0, 0.0];
        let found: Vec<_> =
            (0_u32..).zip(shifts).map(|(i, shift)| frames.take(f64::from(i), &outline(shift))).collect();
        assert_eq!(found, [false, true, false, true, true, true, false, false, false, true]);
        assert_eq!(frames.shortest_step(), Some(2.0));
    }
}
