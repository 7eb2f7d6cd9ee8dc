//! The usual time from frame to frame, which a frame that is missing makes longer.
use super::centred::CentredVector;
use crate::tuning::dynamics as tuning;

/// The time from one frame to the next as it usually is. Levels of hypotheses, and probabilities of changes, are those of such a step: over a gap
/// between frames a motion changes for longer.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct UsualStep {
    seconds: f64,
    /// Whether more steps than one have been seen.
    are_several: bool,
}

/// What hypotheses measure a step by.
#[derive(Debug, Clone, Copy)]
pub(super) struct Units<'a> {
    /// Variance of a pose as one frame tells it, of every parameter.
    pub(super) pose_variance: &'a CentredVector,
    /// Seconds of a usual step.
    pub(super) usual: f64,
    /// Usual steps that the step takes the time of.
    pub(super) steps: f64,
}

#[cfg(test)]
impl<'a> Units<'a> {
    /// Of a step of so many seconds that is a usual one.
    pub(super) const fn of_usual_step(pose_variance: &'a CentredVector, seconds: f64) -> Self {
        Self { pose_variance, usual: seconds, steps: 1.0 }
    }
}

impl UsualStep {
    /// As long as the first step.
    pub(super) const fn of(seconds: f64) -> Self {
        Self { seconds, are_several: false }
    }

    /// In seconds.
    pub(super) const fn seconds(self) -> f64 {
        self.seconds
    }

    /// Follows a step of so many seconds; how many usual ones it takes the time of, a number that is 1 for steps that are about as long.
    pub(super) fn follow(&mut self, seconds: f64) -> f64 {
        // The first one may have been over a gap.
        let shorter = if self.are_several { tuning::SHORTER } else { 0.0 };
        self.seconds = seconds.clamp(self.seconds * shorter, self.seconds * tuning::LONGER);
        self.are_several = true;
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
    fn a_first_step_over_a_gap_is_not_usual_and_one_of_an_instant_is_forgotten() {
        for (times, frames) in [(20.0, 1), (0.05, 60)] {
            let mut usual = UsualStep::of(times * SECONDS);
            (0..frames).for_each(|_| {
                usual.follow(SECONDS);
            });
            assert_eq!(usual.follow(SECONDS), 1.0, "{times}");
        }
        // Such an instant later on changes little.
        let mut usual = UsualStep::of(SECONDS);
        for (seconds, least) in [(SECONDS, 1.0), (1e-6 * SECONDS, 0.0), (SECONDS, 1.0)] {
            let steps = usual.follow(seconds);
            assert!((least..1.25).contains(&steps), "{seconds}: {steps}");
        }
    }
}
