//! Frames that repeat the one before them.
use freeform_curve_fit::Outline;
use nalgebra::Point2;

use crate::tuning::supervisor::MOST_REPEATED;

/// The points of the last frame, and how often it has been repeated. A camera or a converter that stores pictures twice gives outlines that are the same
/// to the last digit. They are no measurements of the times that they are given with: their noise is that of the frame before.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct RepeatedFrames {
    points: Vec<Point2<f64>>,
    times: usize,
}

impl RepeatedFrames {
    /// Takes the outline of a frame; whether it repeats the one before it, and not so often that the object must be at rest.
    pub(super) fn is_repeated(&mut self, outline: &Outline) -> bool {
        let points = || outline.pieces().flat_map(|piece| piece.points);
        if points().eq(&self.points) {
            self.times = (self.times + 1).min(MOST_REPEATED + 1);
        } else {
            self.points.clear();
            self.points.extend(points());
            self.times = 0;
        }
        (1..=MOST_REPEATED).contains(&self.times)
    }
}

#[cfg(feature = "serde")]
impl RepeatedFrames {
    pub(super) fn is_valid(&self) -> bool {
        self.times <= MOST_REPEATED + 1
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
        let mut found = |shift| frames.is_repeated(&outline(shift));
        assert_eq!(
            [0.0, 0.0, 1e-15, 1e-15, 1e-15, 1e-15, 1e-15, 1e-15, 0.0, 0.0].map(&mut found),
            [false, true, false, true, true, true, false, false, false, true]
        );
    }
}
