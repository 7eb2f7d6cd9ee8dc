//! Where the outline is expected at a time to come.
use super::{
    motion_filter::{MotionFilter, Phase},
    tracking::predict,
};
use crate::track::KnownPiece;

/// The outline of an object as it is known, where it is expected.
#[derive(Debug, Clone, PartialEq)]
pub struct ExpectedOutline {
    /// Its connected parts. All run the same way around the object, as far as the frames have shown it.
    pub pieces: Vec<KnownPiece>,
    /// Standard deviation of its place along its normals, image lengths: that of the point whose place is known least.
    pub deviation: f64,
}

impl MotionFilter {
    /// The outline where it is expected at a time in seconds, not before the last frame; at the time of the last frame where it was found
    /// then. `None` unless the filter is [tracking](Phase::Tracking).
    ///
    /// ```
    /// use freeform_curve_fit::Outline;
    /// use freeform_outline_filter::{FilterSettings, MotionFilter};
    /// use nalgebra::Point2;
    ///
    /// let mut filter = MotionFilter::new(FilterSettings::default())?;
    /// for frame in 0..10 {
    ///     let time = f64::from(frame) / 30.0;
    ///     // An ellipse that drifts to the right at 0.3/s.
    ///     let ellipse = (0..300).map(|i| {
    ///         let t = std::f64::consts::TAU * f64::from(i) / 300.0;
    ///         Point2::new(0.3 * time + t.cos(), 0.5 * t.sin())
    ///     });
    ///     filter.step(time, &Outline::closed(ellipse.collect())?)?;
    /// }
    /// let expected = filter.expected_outline(1.0).expect("ten good frames");
    /// let piece = &expected.pieces[0];
    /// let rightmost = piece.points.iter().map(|p| p.x).fold(f64::MIN, f64::max);
    /// assert!(piece.closed && (rightmost - 1.3).abs() < 0.02, "{rightmost}");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn expected_outline(&self, time: f64) -> Option<ExpectedOutline> {
        let seconds = time / self.seconds_per_unit() - self.clock.of_track;
        if self.phase != Phase::Tracking || !seconds.is_finite() {
            return None;
        }
        let mut track = self.track.clone()?;
        if seconds > 0.0 && !predict(&self.settings, &mut track, &mut self.history.clone(), seconds) {
            return None;
        }
        let deviation = track.deviation_along_normals()? * track.reference().radius;
        deviation.is_finite().then(|| ExpectedOutline { pieces: track.pieces(), deviation })
    }
}
