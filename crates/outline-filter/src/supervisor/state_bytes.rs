//! A filter as bytes and back.
use freeform_estimate::{StateError, StateFormat};

use super::{
    counts::Counts,
    motion_filter::{MotionFilter, Phase},
    repeated_frames::BeforeRepeated,
};
use crate::track::{SavedCells, Track};
use crate::tuning::symmetry::LARGEST_ORDER;

/// Version of the format: another one for every change of what is saved.
const VERSION: u32 = 35;

/// The format of the bytes.
const FORMAT: StateFormat = state_format(*b"filt", "filter");

impl MotionFilter {
    /// Everything that the filter knows, as bytes: 50 to 100 kB for an outline of 400 points, for each rival of its turn up to as much again,
    /// before the object was found again also up to two outlines, of outlines of few points the first 15, and while its map is cut anew the frames that it is cut from, at most 128, their
    /// points once more or the track and its rivals on the new map. What was [measured between frames](Self::prepare) is left to the next step. A
    /// filter [made from them](Self::from_bytes) goes on as this one would, to the last bit. The first four bytes are the version of the format,
    /// little-endian.
    ///
    /// # Errors
    /// None for a filter; the encoder reports errors of its sink, and memory has none.
    pub fn to_bytes(&self) -> Result<Vec<u8>, StateError> {
        if self.window.is_due() {
            let mut done = self.clone();
            done.do_what_is_due();
            return FORMAT.encoded(&done);
        }
        FORMAT.encoded(self)
    }

    /// A filter from the bytes of [`to_bytes`](Self::to_bytes). Bytes from anywhere may be given: everything is checked.
    ///
    /// ```
    /// use freeform_curve_fit::Outline;
    /// use freeform_outline_filter::{FilterSettings, MotionFilter};
    /// use nalgebra::Point2;
    ///
    /// let mut filter = MotionFilter::new(FilterSettings::default())?;
    /// let egg = |shift: f64| {
    ///     let angles = (0..200).map(|i| std::f64::consts::TAU * f64::from(i) / 200.0);
    ///     Outline::closed(angles.map(|t| Point2::new(shift + 0.5 * t.cos() + 0.05 * (2.0 * t).cos(), 0.3 * t.sin())).collect())
    /// };
    /// (0..10).try_for_each(|k| filter.step(0.1 * f64::from(k), &egg(0.01 * f64::from(k)).expect("an egg")).map(drop))?;
    /// let mut restored = MotionFilter::from_bytes(&filter.to_bytes()?)?;
    /// assert_eq!(restored.step(1.0, &egg(0.1)?)?, filter.step(1.0, &egg(0.1)?)?);
    /// assert_eq!(restored.state(), filter.state());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Bytes of another version or kind, damaged ones, and ones that describe no filter.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, StateError> {
        let mut filter: Self = FORMAT.decoded(bytes)?;
        filter.restore()?;
        Ok(filter)
    }

    /// Builds what is not saved and checks the rest.
    fn restore(&mut self) -> Result<(), StateError> {
        let inconsistent = |part| Err(StateError::Inconsistent { part });
        if self.settings.check().is_err() {
            return inconsistent("settings");
        }
        if !self.times_are_valid() {
            return inconsistent("times");
        }
        let (model, unit) = (self.settings.model, self.seconds_per_unit());
        let restored_with = |track: &mut Track, cells| track.model() == model && track.restore(unit, cells);
        let restored = |track: &mut Track| restored_with(track, SavedCells::Measured);
        if !self.track.as_mut().is_none_or(restored) {
            return inconsistent("track");
        }
        let (settings, track_time, is_tracking) = (&self.settings, self.clock.of_track, self.phase == Phase::Tracking);
        let is_valid = |before: &mut Box<BeforeRepeated>| {
            restored(&mut before.track) && before.history.is_valid(settings) && before.time <= track_time && is_tracking
        };
        if !self.before_repeated.as_mut().is_none_or(is_valid) {
            return inconsistent("repeated frames");
        }
        if !self.turn_hypotheses.restore(restored) {
            return inconsistent("hypotheses");
        }
        if (self.phase == Phase::Waiting) != self.track.is_none() {
            return inconsistent("phase");
        }
        if !(1..=LARGEST_ORDER).contains(&self.search_memory.symmetry) {
            return inconsistent("symmetry");
        }
        if !self.history.is_valid(&self.settings) {
            return inconsistent("changes of the motion");
        }
        if !self.counts_are_below(StateFormat::MOST_COUNTED)
            || !self.search_memory.budget.is_valid()
            || !self.repeated.is_valid()
        {
            return inconsistent("counts");
        }
        if !self.search_memory.landmarks.is_none_or(|landmarks| landmarks.is_finite()) {
            return inconsistent("landmarks");
        }
        if !self.window.restore(&self.settings, restored_with) {
            return inconsistent("first frames");
        }
        if !self.edges.is_valid(StateFormat::MOST_COUNTED) {
            return inconsistent("edges");
        }
        if !self.unfound_are_valid() {
            return inconsistent("frames without the object");
        }
        if !self.search_memory.sparse.is_valid(model, self.clock.last_frame) {
            return inconsistent("first frames of few points");
        }
        Ok(())
    }

    /// Whether the last time is finite, or there was none, that of the track is, and the unit is a power of two.
    fn times_are_valid(&self) -> bool {
        let before_first = self.clock.last_frame == f64::NEG_INFINITY && self.track.is_none();
        let is_power_of_two = |unit: f64| unit > 0.0 && unit.is_normal() && unit == unit.log2().round().exp2();
        let is_unit = |unit: f64| is_power_of_two(unit) && (1.0 / unit).is_normal();
        (self.clock.last_frame.is_finite() || before_first)
            && self.clock.of_track.is_finite()
            && self.clock.unit.is_none_or(is_unit)
    }

    /// Whether no counter is near its end.
    fn counts_are_below(&self, most: usize) -> bool {
        let Counts {
            accepted_in_recording,
            rejected_in_recording,
            rejected_in_a_row,
            hidden_in_a_row,
            accepted_by_track,
            rejected_by_track,
            restarts,
            begun_with_more,
            turned_elsewhere,
            begun_without_edge,
            fruitless_starts,
        } = self.counts;
        let of_recording = [accepted_in_recording, rejected_in_recording, rejected_in_a_row, hidden_in_a_row];
        let of_starts = [restarts, begun_with_more, turned_elsewhere, begun_without_edge, fruitless_starts];
        of_recording.iter().chain(&of_starts).chain(&[accepted_by_track, rejected_by_track]).all(|count| *count < most)
    }
}

/// The format of states that hold those of filters; `name` is the kind in words.
#[doc(hidden)]
#[must_use]
pub const fn state_format(kind: [u8; 4], name: &'static str) -> StateFormat {
    StateFormat { version: VERSION, kind, name }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        drawn_curves::turning,
        supervisor::{
            settings::FilterSettings,
            window::{Measured, Remapping},
        },
    };

    /// A filter whose map is cut anew, of an outline of four lobes, while the hypotheses of its turn are measured on it.
    fn measuring() -> MotionFilter {
        let lobed = |t: f64| 1.0 + 0.2 * (4.0 * t).cos();
        let mut filter = MotionFilter::new(FilterSettings::default()).expect("settings");
        for frame in 0..8 {
            filter.step(f64::from(frame) / 30.0, &turning(frame, 100, lobed)).expect("increasing times");
        }
        filter
    }

    /// What comes of saving it after some change of what is being measured.
    fn restored_after(change: impl Fn(&mut Measured)) -> Result<MotionFilter, StateError> {
        let mut filter = measuring();
        let Remapping::Measured(mut measured) = filter.window.take_remapping() else { panic!("nothing is measured") };
        change(&mut measured);
        filter.window.set_remapping(Remapping::Measured(measured));
        MotionFilter::from_bytes(&filter.to_bytes().expect("memory takes it"))
    }

    #[test]
    fn hypotheses_that_have_taken_more_frames_than_are_kept_or_none_are_refused() {
        assert!(restored_after(|_| ()).is_ok());
        let refused = Some(StateError::Inconsistent { part: "first frames" });
        let kept = measuring().window.len();
        for frames in [0, kept + 1] {
            let of_present = restored_after(|measured| measured.present.poses.resize(frames, Default::default()));
            assert_eq!(of_present.err(), refused, "{frames} frames");
            let of_rival = restored_after(|measured| {
                let rival = measured.rivals.iter_mut().find_map(|(_, rival)| rival.as_mut()).expect("a rival");
                rival.poses.resize(frames, Default::default());
            });
            assert_eq!(of_rival.err(), refused, "{frames} frames of a rival");
        }
        assert!(restored_after(|measured| measured.present.poses.resize(kept, Default::default())).is_ok());
    }

    #[test]
    fn rivals_whose_turns_are_no_numbers_are_refused() {
        for turn in [f64::NAN, f64::INFINITY] {
            let restored = restored_after(|measured| measured.rivals[0].0 = turn);
            assert_eq!(restored.err(), Some(StateError::Inconsistent { part: "first frames" }), "{turn}");
        }
    }
}
