use thiserror::Error;

/// Why a motion, or what it does to a curve, could not be computed.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum DynamicsError {
    /// The scale f / Z0 of a camera is not a positive number.
    #[error("the camera scale f / Z0 must be positive and finite, not {scale}")]
    CameraScale {
        /// The value given.
        scale: f64,
    },
}
