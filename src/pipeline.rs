use freeform_curve_fit::{Fit, FitSettings, Outline};
use freeform_decompose::Decomposition;
use freeform_identify::MotionEstimate;
use freeform_riccati::MotionModel;

/// Settings of a [`Pipeline`].
#[derive(Debug, Clone, PartialEq)]
pub struct PipelineSettings {
    /// How a curve is fitted to every outline.
    pub fit: FitSettings,
    /// Which motion is identified: rigid or affine.
    pub motion: MotionModel,
}

/// What one frame gave.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameResult {
    /// The fitted curve.
    pub fit: Fit,
    /// Its lines, in image coordinates.
    pub decomposition: Decomposition,
    /// The motion as identified so far; `None` before the second frame.
    pub estimate: Option<MotionEstimate>,
}

/// From outlines to motion, frame by frame: fit, decompose, match, identify.
#[derive(Debug)]
pub struct Pipeline {}

/// Why a frame gave nothing, or a pipeline could not be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PipelineError {
    /// Time did not advance.
    #[error("time {time} does not come after {previous}")]
    TimeNotIncreasing {
        /// Time of the frame.
        time: f64,
        /// Time of the frame before it.
        previous: f64,
    },
}

impl Pipeline {
    /// A pipeline that has seen nothing yet.
    ///
    /// # Errors
    /// A setting outside its range.
    pub fn new(_settings: PipelineSettings) -> Result<Self, PipelineError> {
        Ok(Self {})
    }

    /// Takes the next outline of the object, at `time` in seconds. After an error that concerns only this frame the
    /// pipeline goes on with the next one; the frame counts as rejected.
    ///
    /// # Errors
    /// Time that does not advance, an outline that cannot be fitted or decomposed.
    pub fn push(&mut self, _time: f64, _outline: &Outline) -> Result<FrameResult, PipelineError> {
        Err(PipelineError::TimeNotIncreasing { time: 0.0, previous: 0.0 })
    }

    /// The motion as identified so far, or `None` before there are two frames.
    #[must_use]
    pub fn estimate(&self) -> Option<MotionEstimate> {
        None
    }

    /// Frames taken, rejected ones included.
    #[must_use]
    pub fn frames(&self) -> usize {
        0
    }

    /// Frames that gave nothing.
    #[must_use]
    pub fn frames_rejected(&self) -> usize {
        0
    }

    /// What a user should know of the result, one line each.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        Vec::new()
    }
}
