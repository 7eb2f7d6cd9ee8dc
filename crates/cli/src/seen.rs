//! What is seen in an input: outlines in pictures, and pictures without one.
use std::io::ErrorKind;
use std::mem::{Discriminant, discriminant};

use freeform_motion::curve_fit::OutlineError;
use freeform_motion::outline_io::{PictureErrorKind, SourcePicture, TraceError};
use freeform_motion::tracker::{ObjectResult, Recorded, Sighting};

use crate::failure::Failure;

/// The next thing in an input: an outline, with the picture that it was seen in, if it was; or a picture without an object, or one that
/// cannot be read.
pub(crate) type Item = Recorded<Option<SourcePicture>, Missing>;

/// An object of a stream that has left.
pub(crate) struct Left {
    pub(crate) seen: Sighting,
    pub(crate) result: ObjectResult,
}

/// A picture without an outline.
#[derive(Debug)]
pub(crate) struct Missing {
    /// Its number in the sequence.
    pub(crate) frame: u64,
    /// Name of its file, with which the reason begins.
    pub(crate) file: String,
    pub(crate) reason: String,
    /// Advice, if there is any.
    pub(crate) hint: Option<&'static str>,
    pub(crate) kind: MissingKind,
    /// The picture, if it could be read.
    pub(crate) seen_in: Option<SourcePicture>,
}

/// The kind of reason, without its numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum MissingKind {
    /// What the system said, if it was that.
    Unreadable(Discriminant<PictureErrorKind>, Option<ErrorKind>),
    NothingFound(Discriminant<TraceError>, Option<Discriminant<OutlineError>>),
}

impl From<&PictureErrorKind> for MissingKind {
    fn from(kind: &PictureErrorKind) -> Self {
        let told = match kind {
            PictureErrorKind::Io(error) => Some(error.kind()),
            _ => None,
        };
        Self::Unreadable(discriminant(kind), told)
    }
}

impl From<&TraceError> for MissingKind {
    fn from(error: &TraceError) -> Self {
        let degenerate = match error {
            TraceError::Degenerate(error) => Some(discriminant(error)),
            _ => None,
        };
        Self::NothingFound(discriminant(error), degenerate)
    }
}

impl Missing {
    /// The reason, with advice.
    pub(crate) fn advice(&self) -> String {
        self.hint.map_or_else(|| self.reason.clone(), |hint| format!("{}; {hint}", self.reason))
    }

    /// The reason without the name of the file and the number of the frame.
    pub(crate) fn bare_reason(&self) -> &str {
        let (file, frame) = (format!("{}: ", self.file), format!("frame {}: ", self.frame));
        let reason = self.reason.strip_prefix(&file).unwrap_or(&self.reason);
        reason.strip_prefix(&frame).unwrap_or(reason)
    }

    /// The failure if no other picture gave an outline.
    pub(crate) fn into_failure(self) -> Failure {
        match self.seen_in {
            Some(_) => Failure::no_result(self.advice()),
            None => Failure::unusable(self.reason),
        }
    }
}
