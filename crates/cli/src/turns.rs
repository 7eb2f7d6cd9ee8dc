use std::fmt;

use freeform_motion::outline_filter::Ambiguity;

/// Turns from one frame to the next that the outlines do not decide between, in degrees, positive where omega is.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub(crate) struct Turns {
    /// The one taken.
    pub(crate) turn: f64,
    /// What it may have been instead.
    pub(crate) rival_turns: Vec<f64>,
    /// Parameters that depend on it.
    pub(crate) parameters: Vec<&'static str>,
}

impl From<Ambiguity> for Turns {
    fn from(Ambiguity { turn, rival_turns, parameters }: Ambiguity) -> Self {
        let as_omega = |anticlockwise: f64| -anticlockwise.to_degrees();
        Self { turn: as_omega(turn), rival_turns: rival_turns.into_iter().map(as_omega).collect(), parameters }
    }
}

impl fmt::Display for Turns {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rivals: Vec<String> = self.rival_turns.iter().map(|turn| format!("{turn:.1}")).collect();
        let (rivals, turn) = (rivals.join(" or "), self.turn);
        write!(
            f,
            "another turn explains the outlines as well: {rivals} instead of {turn:.1} degrees from one frame to the next"
        )
    }
}
