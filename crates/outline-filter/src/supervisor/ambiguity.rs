use super::motion_filter::MotionFilter;
use crate::tuning::turn_hypotheses as tuning;

/// Turns of an object that its frames do not decide between.
#[derive(Debug, Clone, PartialEq)]
pub struct Ambiguity {
    /// The turn taken, the smallest, in radians, anticlockwise where y points up: to the frame in which the object was last searched for
    /// and found, from the one before.
    pub turn: f64,
    /// What it may have been instead, of those of [`MotionFilter::rival_turns`] that are less than [`SURELY_SMALLER`](Self::SURELY_SMALLER) times the
    /// one taken.
    pub rival_turns: Vec<f64>,
    /// Names of the parameters in which the motions differ, which are marked as unobservable for it.
    pub parameters: Vec<&'static str>,
}

impl Ambiguity {
    /// The smallest turn is taken without a doubt if the others are so many times as large.
    pub const SURELY_SMALLER: f64 = tuning::SURELY_SMALLER;
}

impl MotionFilter {
    /// What the turn taken may have been instead; `None` where no parameter depends on it or the motion is not known anyway.
    #[must_use]
    pub fn ambiguity(&self) -> Option<Ambiguity> {
        let rival_turns = self.turn_hypotheses.doubtful_turns();
        if rival_turns.is_empty() {
            return None;
        }
        self.estimate()?;
        let estimate = self.track.as_ref()?.estimate()?;
        let doubts = self.turn_hypotheses.doubts(&estimate);
        let parameters =
            estimate.parameters().zip(doubts).filter(|(parameter, doubtful)| *doubtful && parameter.value.is_some());
        let parameters: Vec<_> = parameters.map(|(parameter, _)| parameter.name).collect();
        (!parameters.is_empty()).then(|| Ambiguity {
            turn: self.turn_hypotheses.present_turn(),
            rival_turns,
            parameters,
        })
    }
}
