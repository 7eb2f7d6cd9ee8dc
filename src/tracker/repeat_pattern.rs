//! Frames that repeat the one before them at regular intervals, as converters of frame rates make them.
use std::collections::BTreeMap;

use crate::Warning;

/// Frames from one repetition to the next, at least and at most: more than every second frame is repeated of what rests, and ffmpeg drops one frame of
/// up to so many.
const SHORTEST: u64 = 2;
const LONGEST: u64 = 25;

/// Fewest intervals that make a pattern, and their share of all.
const FEWEST: usize = 3;
const MOST_OF_ALL: f64 = 0.9;

/// When an object was seen, and which of its frames repeated the one before them.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct RepeatPattern {
    /// Numbers and times in seconds of the first and the last frame.
    seen: Option<[(u64, f64); 2]>,
    /// Number of the last frame that was a repetition.
    last: Option<u64>,
    /// How often a repetition came so many frames after the one before.
    intervals: BTreeMap<u64, usize>,
    /// How often one came later or sooner than a converter makes them.
    others: usize,
}

/// Whether a frame shows something new.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Content {
    New,
    Repeated,
}

impl RepeatPattern {
    /// Takes a frame at a time in seconds; one at no time, which no method takes, is left out.
    pub(super) fn take(&mut self, frame: u64, time: f64, content: Content) {
        if !time.is_finite() {
            return;
        }
        let first = self.seen.map_or((frame, time), |[first, _]| first);
        self.seen = Some([first, (frame, time)]);
        if content == Content::New {
            return;
        }
        let interval = self.last.replace(frame).map(|last| frame.saturating_sub(last));
        match interval {
            Some(interval @ SHORTEST..=LONGEST) => *self.intervals.entry(interval).or_default() += 1,
            Some(_) => self.others += 1,
            None => {}
        }
    }

    /// What is to be said where they come at regular intervals.
    pub(super) fn warning(&self) -> Option<Warning> {
        let (every, count) = self.intervals.iter().max_by_key(|(_, count)| **count)?;
        let all = self.intervals.values().sum::<usize>() + self.others;
        let is_regular = *count >= FEWEST && *count as f64 >= MOST_OF_ALL * all as f64;
        let [(first, begin), (last, end)] = self.seen?;
        let rate = last.saturating_sub(first) as f64 / (end - begin);
        (is_regular && rate.is_finite() && rate > 0.0).then_some(Warning::RepeatedFrames { every: *every, rate })
    }

    /// Whether it may be that of an object of which so many frames were not used, repetitions among them.
    #[cfg(feature = "serde")]
    pub(super) fn is_valid(&self, rejected: usize) -> bool {
        let counted = self.intervals.values().try_fold(self.others, |sum, count| sum.checked_add(*count));
        let are_finite = self.seen.is_none_or(|seen| seen.iter().all(|(_, time)| time.is_finite()));
        let are_intervals = self.intervals.keys().all(|interval| (SHORTEST..=LONGEST).contains(interval));
        are_finite && are_intervals && counted.is_some_and(|counted| counted <= rejected)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is said of frames at 30 a second of which these are repetitions.
    fn told(frames: u64, is_repeated: impl Fn(u64) -> bool) -> Option<Warning> {
        let mut pattern = RepeatPattern::default();
        for frame in 0..frames {
            let content = if is_repeated(frame) { Content::Repeated } else { Content::New };
            pattern.take(frame, frame as f64 / 30.0, content);
        }
        pattern.warning()
    }

    #[test]
    fn every_sixth_frame_that_repeats_the_one_before_is_told_with_the_rates() {
        let warning = told(30, |frame| frame % 6 == 5).expect("a pattern");
        assert!(matches!(warning, Warning::RepeatedFrames { every: 6, rate } if (rate - 30.0).abs() < 1e-9));
        assert!(warning.to_string().contains("from 25 to 30 frames a second"), "{warning}");
        assert!(matches!(told(30, |frame| frame % 2 == 1), Some(Warning::RepeatedFrames { every: 2, .. })));
    }

    #[test]
    fn a_frame_at_no_time_changes_nothing() {
        let mut pattern = RepeatPattern::default();
        pattern.take(0, f64::NAN, Content::New);
        for frame in 1..31 {
            let content = if frame % 6 == 5 { Content::Repeated } else { Content::New };
            pattern.take(frame, frame as f64 / 30.0, content);
        }
        pattern.take(31, f64::NAN, Content::New);
        assert!(matches!(pattern.warning(), Some(Warning::RepeatedFrames { every: 6, .. })), "{pattern:?}");
    }

    #[test]
    fn frames_of_what_rests_few_repetitions_and_irregular_ones_are_no_pattern() {
        assert_eq!(told(30, |frame| frame > 3), None);
        assert_eq!(told(20, |frame| frame % 6 == 5), None);
        assert_eq!(told(60, |frame| [3, 9, 14, 27, 31, 44, 52].contains(&frame)), None);
        assert_eq!(told(60, |_| false), None);
    }
}
