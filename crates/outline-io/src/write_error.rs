//! Why an outline could not be written.
use std::io;

use thiserror::Error;

/// Why an outline could not be written.
#[derive(Debug, Error)]
pub enum WriteError {
    /// The sink failed; a closed pipe keeps its kind.
    #[error("cannot write the outline: {0}")]
    Io(#[from] io::Error),
    /// An object other than the default one, but the header has no `object` column.
    #[error("object {object:?} needs an object column, which the header does not have")]
    NoObjectColumn {
        /// The object's name.
        object: String,
    },
    /// An open outline, but the header has no `arc` column.
    #[error(
        "the open outline of object {object:?} in frame {frame} needs an arc column, which the header does not have"
    )]
    NoArcColumn {
        /// The object's name.
        object: String,
        /// The frame's number.
        frame: u64,
    },
    /// An outline with several contours, in a file without a column for them.
    #[error("the contours of object {object:?} in frame {frame} need a contour column, which the header does not have")]
    NoContourColumn {
        /// The object's name.
        object: String,
        /// The frame's number.
        frame: u64,
    },
    /// A name that would not be read back: control characters, or white space at an end.
    #[error("object name {object:?} has control characters or white space at an end")]
    ObjectName {
        /// The name.
        object: String,
    },
    /// A frame number beyond those of Parquet files.
    #[error("frame {frame} of object {object:?} is beyond {}, the largest number of a frame in Parquet", i64::MAX)]
    FrameNumber {
        /// The object's name.
        object: String,
        /// The frame's number.
        frame: u64,
    },
    /// Parquet, in a build that cannot write it.
    #[error("this build writes no Parquet: build it with the feature parquet")]
    ParquetLeftOut,
    /// A time that is not finite or beyond 1e100.
    #[error("the time of frame {frame} of object {object:?} is {time:e}, not a number up to 1e100")]
    Time {
        /// The object's name.
        object: String,
        /// The frame's number.
        frame: u64,
        /// The time.
        time: f64,
    },
}
