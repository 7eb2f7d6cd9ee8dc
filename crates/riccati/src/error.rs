use thiserror::Error;

/// Why a motion, or what it does to a line or a curve, could not be computed.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum DynamicsError {
    /// The scale f / Z0 of a camera is not a positive number.
    #[error("the camera scale f / Z0 must be positive and finite, not {scale}")]
    CameraScale {
        /// The value given.
        scale: f64,
    },
    /// The focal length of a camera is not a positive number.
    #[error("the focal length must be positive and finite, not {focal}")]
    FocalLength {
        /// The value given.
        focal: f64,
    },
    /// The principal point of a camera is not finite.
    #[error("the principal point must be finite, not {x},{y}")]
    PrincipalPoint {
        /// Its x.
        x: f64,
        /// Its y.
        y: f64,
    },
    /// The map of the plane has no inverse, or is not finite.
    #[error("the map of the plane is singular or not finite (determinant {determinant:e})")]
    SingularMap {
        /// Determinant of its 3x3 matrix.
        determinant: f64,
    },
    /// The line has no x any more: it left the chart `x + l y + k = 0`. Only a real line gets there exactly.
    #[error("the line with homogeneous coordinates p = {p_magnitude:e}, l = {l_magnitude:e} has left the chart p = 1")]
    LineLeftChart {
        /// Absolute value of the coefficient of x.
        p_magnitude: f64,
        /// Absolute value of the coefficient of y.
        l_magnitude: f64,
    },
    /// A motion that changes with time is not finite at this time.
    #[error("the generator of the motion is not finite at t = {time} s")]
    GeneratorNotFinite {
        /// Time in seconds.
        time: f64,
    },
    /// The tolerance of an integration is outside what f64 can give.
    #[error("the tolerance must lie between {smallest:e} and {largest:e}, not {tolerance:e}",
        smallest = crate::integrate::SMALLEST_TOLERANCE, largest = crate::integrate::LARGEST_TOLERANCE)]
    Tolerance {
        /// The value given.
        tolerance: f64,
    },
    /// The longest step of an integration is not a positive number.
    #[error("the longest step must be positive, not {step} s")]
    LongestStep {
        /// The value given, in seconds.
        step: f64,
    },
    /// The step that the tolerance asks for is too small to advance the time.
    #[error("the step became too small at t = {time} s ({step:e} s)")]
    StepTooSmall {
        /// Time in seconds up to which the motion was integrated.
        time: f64,
        /// The step in seconds.
        step: f64,
    },
}
