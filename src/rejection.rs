use std::fmt;

use freeform_outline_filter::{FilterError, Rejection};

use crate::{error_chain::with_causes, number::short, pipeline_error::PipelineError, rectification::RectifyError};

/// Share of rejected frames from which on there is a warning: less happens where a motion changes or something passes by.
const MANY_REJECTED: f64 = 0.1;

/// Fewest rejected frames of which there is a warning: of a short sequence one or two are a large share.
const FEWEST_REJECTED: usize = 3;

/// Whether so many frames were rejected that this questions the result.
pub(crate) fn are_many_rejected(rejected: usize, frames: usize) -> bool {
    rejected >= FEWEST_REJECTED && rejected as f64 >= MANY_REJECTED * frames as f64
}

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

pub(crate) fn write_too_many_rejected(f: &mut fmt::Formatter<'_>, rejected: usize, frames: usize) -> fmt::Result {
    write!(
        f,
        "{rejected} of {frames} frames do not fit the others, so that no motion is stated: the outlines may be of \
         several things, or turn by about half a turn (of their symmetry) from frame to frame"
    )
}

pub(crate) fn write_frames_rejected(f: &mut fmt::Formatter<'_>, rejected: usize, frames: usize) -> fmt::Result {
    write!(
        f,
        "{rejected} of {frames} frames rejected, more than the few that are normal: the outlines may not be those of the object, or its motion \
         may not be of the chosen kind"
    )
}

pub(crate) fn write_repeated_frames(f: &mut fmt::Formatter<'_>, every: u64, rate: f64) -> fmt::Result {
    let shown = rate * every.saturating_sub(1) as f64 / every as f64;
    let [shown, rate] = [shown, rate].map(|rate| short((1e2 * rate).round() / 1e2));
    write!(
        f,
        "one frame in {every} repeats the one before it: the video was probably converted from {shown} to {rate} frames a second, so that its times \
         are not those of exposure; take the original, or leave the repeated frames out (ffmpeg -vf decimate={every})"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tenth_of_the_frames_is_many_and_two_frames_are_few() {
        assert!(are_many_rejected(3, 30) && are_many_rejected(3, 3));
        assert!(!are_many_rejected(3, 31) && !are_many_rejected(2, 2) && !are_many_rejected(0, 0));
    }
}
