/// Times of frames must be finite and increase.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("times must increase: a frame at {time} s after one at {previous} s")]
pub struct TimeNotIncreasing {
    /// Time of the frame before in seconds, or negative infinity.
    pub previous: f64,
    /// Time given.
    pub time: f64,
}

impl TimeNotIncreasing {
    /// Checks a time against that of the frame before it, negative infinity where there is none.
    ///
    /// # Errors
    /// A time that is not finite, or not after the one before.
    pub fn check(previous: f64, time: f64) -> Result<(), Self> {
        if !time.is_finite() || time <= previous { Err(Self { previous, time }) } else { Ok(()) }
    }
}
