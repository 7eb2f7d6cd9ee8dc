//! Numbers of frames, written short.
use std::fmt;

/// Runs kept; what comes after them is only counted, so that an endless stream takes no more memory.
const RUNS_KEPT: usize = 100;

/// Numbers of frames in rising order, written as `1, 5-7`.
///
/// ```
/// use freeform_motion::tracker::FrameRanges;
///
/// assert_eq!(FrameRanges::from_iter([1, 5, 6, 7]).to_string(), "1, 5-7");
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FrameRanges {
    runs: Vec<(u64, u64)>,
    beyond: u64,
}

impl FrameRanges {
    /// Adds a number that is not less than those before it.
    pub fn add(&mut self, number: u64) {
        let is_full = self.runs.len() == RUNS_KEPT;
        match self.runs.last_mut() {
            Some((_, last)) if self.beyond == 0 && *last == number => {}
            Some((_, last)) if self.beyond == 0 && last.checked_add(1) == Some(number) => *last = number,
            _ if is_full => self.beyond += 1,
            _ => self.runs.push((number, number)),
        }
    }

    /// Whether its runs can be added to.
    #[cfg(feature = "serde")]
    pub(crate) fn is_sound(&self) -> bool {
        self.runs.len() <= RUNS_KEPT && self.beyond < 1 << 48
    }

    /// Whether there is no number.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.runs.is_empty()
    }
}

impl FromIterator<u64> for FrameRanges {
    fn from_iter<I: IntoIterator<Item = u64>>(numbers: I) -> Self {
        let mut ranges = Self::default();
        numbers.into_iter().for_each(|number| ranges.add(number));
        ranges
    }
}

impl fmt::Display for FrameRanges {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, (first, last)) in self.runs.iter().enumerate() {
            let comma = if index > 0 { ", " } else { "" };
            if first == last { write!(f, "{comma}{first}") } else { write!(f, "{comma}{first}-{last}") }?;
        }
        if self.beyond > 0 { write!(f, " and {} more", self.beyond) } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_of_frames_are_written_short() {
        let ranges = FrameRanges::from_iter([3, 5, 6, 6, 7, 9, u64::MAX]);
        assert_eq!(ranges.to_string(), format!("3, 5-7, 9, {}", u64::MAX));
        assert_eq!(FrameRanges::default().to_string(), "");
    }

    #[test]
    fn what_is_beyond_many_runs_is_counted() {
        let ranges = FrameRanges::from_iter((0..1000).map(|number| 2 * number));
        assert!(ranges.to_string().ends_with("196, 198 and 900 more"), "{ranges}");
    }
}
