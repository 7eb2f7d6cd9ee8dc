use freeform_curve_fit::OutlineError;
use freeform_riccati::DynamicsError;
use thiserror::Error;

/// Why something is not a shape.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ShapeError {
    /// No built-in shape has this name.
    #[error("no shape is called \"{name}\"; the shapes are {}", known.join(", "))]
    UnknownName {
        /// The name asked for.
        name: String,
        /// The names that there are.
        known: Vec<&'static str>,
    },
    /// The points are not a closed outline.
    #[error("the polygon is not a shape: {0}")]
    Polygon(#[from] OutlineError),
    /// The polygon's parts enclose nothing, or cancel each other like the loops of an eight.
    #[error("the polygon encloses an area of only {area:e} at a diameter of {diameter:e}")]
    NoArea {
        /// Area by the shoelace formula, signed.
        area: f64,
        /// Largest distance between two of its points.
        diameter: f64,
    },
}

/// Why a simulation cannot be run.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum SimulationError {
    /// A setting is not finite or outside its range.
    #[error("{setting} is {value}, it must be {range}")]
    OutOfRange {
        /// Which setting.
        setting: &'static str,
        /// Its value.
        value: f64,
        /// The values accepted, in words.
        range: &'static str,
    },
    /// Too few points are left in view to make an outline.
    #[error("{visible} point(s) of {points} would be in view, at least {needed} are needed")]
    TooFewPoints {
        /// Points asked for on the whole contour.
        points: usize,
        /// Points left in a frame with a hidden arc, or all of them.
        visible: usize,
        /// Smallest number accepted.
        needed: usize,
    },
    /// The sequence has no frame.
    #[error("the sequence has no frame")]
    NoFrame,
    /// The sequence is longer than supported.
    #[error("the sequence has {frames} frames, at most {limit} are supported")]
    TooManyFrames {
        /// Frames asked for, rounded.
        frames: f64,
        /// Largest number accepted.
        limit: usize,
    },
    /// The motion has grown, shrunk, flattened or carried off the object beyond what numbers can hold.
    #[error("at {time} s the object is too large, too small, too flat or too far away to be pictured")]
    PoseOutOfRange {
        /// Time in seconds.
        time: f64,
    },
    /// A varying motion that is not finite at some time of the sequence, or too rough to be integrated.
    #[error("the motion cannot be simulated: {0}")]
    Motion(#[from] DynamicsError),
    /// A list of motion phases that is empty or does not start at time 0.
    #[error("a piecewise motion needs a first phase that starts at time 0")]
    NoFirstPhase,
    /// The starts of a piecewise motion do not increase.
    #[error("motion phase {index} starts at {start} s, not after the phase before it")]
    PhaseOrder {
        /// Position of the phase in the list, counted from 0.
        index: usize,
        /// Its start in seconds.
        start: f64,
    },
    /// A mask without pixels or with too many.
    #[error("a mask of {width} by {height} pixels has none or more than {limit}")]
    MaskSize {
        /// Columns asked for.
        width: usize,
        /// Rows asked for.
        height: usize,
        /// Largest number of pixels accepted.
        limit: usize,
    },
}
