use std::path::Path;

use freeform_outline_io::{ReadShapeError, read_shape};
use freeform_sim_camera::{BuiltInShape, Shape, ShapeError};

/// Why there is no shape of a name.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum NamedShapeError {
    /// It is neither that of a built-in shape nor that of a file.
    #[error(transparent)]
    Unknown(ShapeError),
    /// The file cannot be read.
    #[error(transparent)]
    Unreadable(#[from] ReadShapeError),
    /// The outline in the file is no shape.
    #[error("{file}: {error}")]
    NoShape {
        /// The file.
        file: String,
        /// Why not.
        error: ShapeError,
    },
}

/// A built-in shape by its name, or that of a file, a polygon as CSV or a mask picture, centred and scaled to unit size.
///
/// ```
/// use freeform_motion::named_shape;
///
/// assert_eq!(named_shape("bird")?.name(), "bird");
/// let error = named_shape("brid").expect_err("no such shape");
/// assert!(error.to_string().contains("bird"));
/// # Ok::<(), freeform_motion::NamedShapeError>(())
/// ```
///
/// # Errors
///
/// No built-in shape and no file has this name; the file cannot be read, or its outline is no shape.
pub fn named_shape(name_or_file: &str) -> Result<Shape, NamedShapeError> {
    let unknown = match name_or_file.parse::<BuiltInShape>() {
        Ok(shape) => return Ok(shape.shape()),
        Err(error) => error,
    };
    let path = Path::new(name_or_file);
    let looks_like_file = path.extension().is_some() || path.components().count() > 1 || path.exists();
    if !looks_like_file {
        return Err(NamedShapeError::Unknown(unknown));
    }
    let points: Vec<_> = read_shape(path)?.points().copied().collect();
    let no_shape = |error| NamedShapeError::NoShape { file: name_or_file.to_owned(), error };
    let shape = Shape::from_polygon(&points).map_err(no_shape)?;
    Ok(shape.normalised().with_name(name_or_file))
}
