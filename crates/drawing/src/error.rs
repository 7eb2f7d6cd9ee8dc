use std::io;

/// Why a drawing could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DrawingError {
    /// The sink refused it.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// A picture of another size than the first one of an animation, or with a side of 0 or, of a GIF, of more than 65535 pixels.
    #[error("a picture of {width} x {height} pixels does not go into the animation")]
    PictureSize {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// The encoder of animations refused it.
    #[error(transparent)]
    Gif(gif::EncodingError),
    /// The picture could not be encoded as PNG.
    #[error(transparent)]
    Png(#[from] png::EncodingError),
}

impl From<gif::EncodingError> for DrawingError {
    fn from(error: gif::EncodingError) -> Self {
        match error {
            gif::EncodingError::Io(error) => Self::Io(error),
            other => Self::Gif(other),
        }
    }
}
