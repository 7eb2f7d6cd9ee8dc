use nalgebra::{Point2, Projective2};

/// The outline of an object as far as it is known.
#[derive(Debug, Clone, PartialEq)]
pub struct KnownOutline {
    /// Its connected parts, where they were in the first frame, image coordinates.
    pub pieces: Vec<KnownPiece>,
    /// The map of the image from there to the present place.
    pub pose: Projective2<f64>,
}

/// A connected part of a known outline.
#[derive(Debug, Clone, PartialEq)]
pub struct KnownPiece {
    /// Points in their order along the outline, one for each cell of the map.
    pub points: Vec<Point2<f64>>,
    /// Whether the last is followed by the first.
    pub closed: bool,
}
