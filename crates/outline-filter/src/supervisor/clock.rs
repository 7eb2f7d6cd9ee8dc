//! The times of a filter.

/// Times of a filter, in its unit of time.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Clock {
    /// Time of the last frame; minus infinity before the first.
    pub(super) last_frame: f64,
    /// Time that the track stands at.
    pub(super) of_track: f64,
    /// Seconds per unit of filter time, a power of two; `None` until the second frame sets it, and the unit is a second.
    pub(super) unit: Option<f64>,
}

impl Default for Clock {
    fn default() -> Self {
        Self { last_frame: f64::NEG_INFINITY, of_track: 0.0, unit: None }
    }
}
