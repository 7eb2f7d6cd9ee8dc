//! The columns of a table of outlines.
use std::fmt;

/// A column of an outline file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Column {
    /// Frame number, a whole number from 0.
    Frame,
    /// Time in seconds.
    Time,
    /// First coordinate.
    X,
    /// Second coordinate.
    Y,
    /// Name of the object; optional.
    Object,
    /// Arc of an open outline; optional, empty for a closed one.
    Arc,
    /// Contour of a closed outline that has several; optional.
    Contour,
    /// Standard deviation of the point along the normal of the contour; optional, empty where it is not known.
    Deviation,
    /// What the program that found the outlines said of them, see [`OriginWarnings`](crate::OriginWarnings); optional.
    Warning,
}

impl Column {
    /// The name in the header.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Frame => "frame",
            Self::Time => "time",
            Self::X => "x",
            Self::Y => "y",
            Self::Object => "object",
            Self::Arc => "arc",
            Self::Contour => "contour",
            Self::Deviation => "deviation",
            Self::Warning => "warning",
        }
    }
}

impl fmt::Display for Column {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
