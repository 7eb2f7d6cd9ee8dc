use std::fmt;

use freeform_outline_filter::{FilterError, Rejection};

use crate::{error_chain::with_causes, pipeline_error::PipelineError, rectification::RectifyError};

/// Why a frame of an object was not used.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameRejection {
    /// Name of the object.
    pub object: String,
    /// Number of the frame.
    pub frame: u64,
    /// The reason.
    pub cause: RejectionCause,
}

/// Reasons not to use a frame.
#[derive(Debug, Clone, PartialEq)]
pub enum RejectionCause {
    /// The points are not an outline. The text comes from the reader and names the frame.
    NoOutline(String),
    /// The outline cannot be brought to the plane that the objects move in.
    NotRectified(RectifyError),
    /// The frame does not fit the object as the motion filter knows it.
    NotAccepted(Rejection),
    /// Error of the motion filter.
    Filter(FilterError),
    /// Error of the pipeline.
    Pipeline(PipelineError),
    /// What was known of the object cannot be had back from the file that it rested in, for this reason.
    StateLost(String),
    /// What was told of a frame rejected before the state of the tracker was saved.
    Saved(String),
}

impl fmt::Display for FrameRejection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { object, frame, cause } = self;
        match cause {
            RejectionCause::NoOutline(_) => cause.fmt(f),
            _ => write!(f, "frame {frame} of object {object:?}: {cause}"),
        }
    }
}

impl fmt::Display for RejectionCause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoOutline(reason) | Self::Saved(reason) => f.write_str(reason),
            Self::StateLost(reason) => write_state_lost(f, reason),
            Self::NotRectified(error) => error.fmt(f),
            Self::NotAccepted(rejection) => rejection.fmt(f),
            Self::Filter(error) => f.write_str(&with_causes(error)),
            Self::Pipeline(error) => f.write_str(&with_causes(error)),
        }
    }
}

pub(crate) fn write_state_lost(f: &mut fmt::Formatter<'_>, reason: &str) -> fmt::Result {
    write!(
        f,
        "what was known of the object could not be read back from the temporary file that it was kept in: {reason}"
    )
}
