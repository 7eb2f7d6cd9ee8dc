//! What the formats of polygons have in common: bodies in pictures, and their corners.
use nalgebra::Point2;

use crate::frame::NAME_LIMIT;
use crate::polygon_file::error::PolygonError;

/// The polygons of a body in a picture, as the file has them: y downwards.
#[derive(Debug)]
pub(crate) struct Body {
    pub(crate) object: String,
    pub(crate) frame: u64,
    /// In seconds, where the file tells.
    pub(crate) time: Option<f64>,
    /// Of the picture; 0 where it is not known.
    pub(crate) height: f64,
    pub(crate) contours: Vec<Vec<Point2<f64>>>,
}

/// Bodies, and what would tell those of one name apart.
pub(crate) struct Bodies {
    pub(crate) list: Vec<Body>,
    pub(crate) remedy: &'static str,
}

/// A name that many outlines will have.
pub(crate) fn checked_name(name: &str) -> Result<&str, PolygonError> {
    match name.len() {
        length if length > NAME_LIMIT => Err(PolygonError::LongName { length, limit: NAME_LIMIT }),
        _ => Ok(name),
    }
}

/// Points of a flat list of coordinates.
pub(crate) fn points_of(coordinates: &[f64], item: impl Fn() -> String) -> Result<Vec<Point2<f64>>, PolygonError> {
    if coordinates.len() % 2 == 1 {
        return Err(PolygonError::OddCoordinates { item: item(), count: coordinates.len() });
    }
    Ok(coordinates.chunks_exact(2).map(|pair| Point2::new(pair[0], pair[1])).collect())
}
