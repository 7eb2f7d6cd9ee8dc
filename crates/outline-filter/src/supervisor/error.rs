use freeform_estimate::TimeNotIncreasing;

/// Why a frame or a setting cannot be used at all. Frames that merely do not fit are no errors: the filter rejects and counts
/// them.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum FilterError {
    /// Times must be finite and increase.
    #[error(transparent)]
    TimeNotIncreasing(#[from] TimeNotIncreasing),
    /// Too few points to start a map from.
    #[error(
        "{found} points where at least {needed} are needed to start, along the sides of a polygon too and not at its corners alone"
    )]
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
