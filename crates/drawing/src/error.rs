use std::io;

/// Why a drawing could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DrawingError {
    /// The sink refused it.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The format of an animation cannot hold it, such as a picture with a side of more than 65535 pixels.
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
