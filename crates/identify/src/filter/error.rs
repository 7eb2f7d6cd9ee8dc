/// Why a frame or a setting cannot be used at all. Frames that merely do not fit are no errors: the filter rejects and counts
/// them.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum FilterError {
    /// Times must be finite and increase.
    #[error("a frame at {time} s after one at {previous} s")]
    TimeNotIncreasing {
        /// Time of the frame before in seconds, or negative infinity.
        previous: f64,
        /// Time given.
        time: f64,
    },
    /// Too few points to start a map from.
    #[error("{found} points where at least {needed} are needed to start")]
    TooFewPoints {
        /// Points of the outline.
        found: usize,
        /// Points needed.
        needed: usize,
    },
    /// A setting outside its range.
    #[error("{setting} of {value} is not {range}")]
    Setting {
        /// Name of the setting.
        setting: &'static str,
        /// Value given.
        value: f64,
        /// What is accepted.
        range: &'static str,
    },
}
