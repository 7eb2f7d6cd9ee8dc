//! The usual time from frame to frame, which a frame that is missing makes longer.
use crate::tuning::dynamics as tuning;

/// The time from one frame to the next as it usually is. Levels of hypotheses, and probabilities of changes, are those of such a step: over a gap between
/// frames a motion changes for longer.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct UsualStep {
    seconds: f64,
}

impl UsualStep {
    /// As long as a step that has been seen.
    pub(super) const fn of(seconds: f64) -> Self {
        Self { seconds }
    }

    /// In seconds.
    pub(super) const fn seconds(self) -> f64 {
        self.seconds
    }

    /// Follows a step of so many seconds; how many usual ones it takes the time of, a number that is 1 for steps that are about as long.
    pub(super) fn follow(&mut self, seconds: f64) -> f64 {
        self.seconds = seconds.clamp(self.seconds * tuning::SHORTER, self.seconds * tuning::LONGER);
        (seconds / self.seconds).min(tuning::MOST_STEPS)
    }

    /// Whether it can be worked with.
    #[cfg(feature = "serde")]
    pub(super) fn is_valid(self) -> bool {
        self.seconds > 0.0 && self.seconds.is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECONDS: f64 = 1.0 / 30.0;

    #[test]
    fn a_gap_takes_the_time_of_as_many_steps_as_frames_are_missing_and_hardly_changes_what_is_usual() {
        let mut usual = UsualStep::of(SECONDS);
        for seconds in [0.96 * SECONDS, SECONDS, 1.04 * SECONDS] {
            assert_eq!(usual.follow(seconds), 1.0);
        }
        let steps = usual.follow(17.0 * SECONDS);
        assert!((15.0..18.0).contains(&steps), "{steps}");
        assert_eq!(usual.follow(SECONDS), 1.0);
    }

    #[test]
    fn what_is_usual_after_a_first_step_over_a_gap_or_an_instant_is_found_within_some_frames() {
        for (times, frames) in [(20.0, 5), (0.05, 50)] {
            let mut usual = UsualStep::of(times * SECONDS);
            (0..frames).for_each(|_| {
                usual.follow(SECONDS);
            });
            assert_eq!(usual.follow(SECONDS), 1.0, "{times}");
        }
    }
}
