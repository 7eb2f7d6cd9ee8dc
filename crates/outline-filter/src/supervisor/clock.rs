//! The times of a filter.
/// Times of a filter, in its unit of time.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Clock {
    /// Before the first frame the beginning of all times.
    pub(super) last_frame: f64,
    /// Time that the track stands at.
    pub(super) of_track: f64,
    /// Seconds; one until it is chosen.
    pub(super) unit: Option<f64>,
}

impl Default for Clock {
    fn default() -> Self {
        Self { last_frame: f64::NEG_INFINITY, of_track: 0.0, unit: None }
    }
}
