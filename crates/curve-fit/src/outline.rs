use nalgebra::{Affine2, Matrix2, Point2, Vector2};

use crate::error::OutlineError;

/// Largest absolute coordinate accepted, so that squares never overflow.
pub(crate) const COORDINATE_LIMIT: f64 = 1e100;

/// Two principal radii whose ratio is below this are taken for points on one line.
const COLLINEAR_RATIO: f64 = 1e-9;

/// Points of one contour in the order in which they follow each other, either way round; the last is joined to the
/// first, which is not repeated. At least three finite points that do not lie on one line.
#[derive(Debug, Clone, PartialEq)]
pub struct ClosedOutline {
    points: Vec<Point2<f64>>,
}

impl ClosedOutline {
    /// Checks and takes over the points, in any length unit.
    ///
    /// # Errors
    /// Fewer than 3 points, a coordinate that is not finite or beyond 1e100, all points equal or on one line.
    pub fn new(points: Vec<Point2<f64>>) -> Result<Self, OutlineError> {
        check_points(&points, 3)?;
        let spread = Spread::of(&points);
        if spread.ratio() < COLLINEAR_RATIO {
            return Err(OutlineError::Collinear { count: points.len() });
        }
        Ok(Self { points })
    }

    /// The points in order.
    #[must_use]
    pub fn points(&self) -> &[Point2<f64>] {
        &self.points
    }

    /// Area by the shoelace formula: positive where the points run counter-clockwise in a y-up frame.
    #[must_use]
    pub fn signed_area(&self) -> f64 {
        signed_area(self.points.iter())
    }
}

/// An ordered open piece of a contour, either way round: at least two finite points that are not all equal.
#[derive(Debug, Clone, PartialEq)]
pub struct OpenArc {
    points: Vec<Point2<f64>>,
}

impl OpenArc {
    /// Checks and takes over the points, in any length unit.
    ///
    /// # Errors
    /// Fewer than 2 points, a coordinate that is not finite or beyond 1e100, all points equal.
    pub fn new(points: Vec<Point2<f64>>) -> Result<Self, OutlineError> {
        check_points(&points, 2)?;
        Ok(Self { points })
    }

    /// The points in order.
    #[must_use]
    pub fn points(&self) -> &[Point2<f64>] {
        &self.points
    }
}

/// What is seen of a partly hidden contour: one or more open arcs, all running the same way round and listed in the
/// order in which the contour passes through them.
#[derive(Debug, Clone, PartialEq)]
pub struct OpenOutline {
    arcs: Vec<OpenArc>,
}

impl OpenOutline {
    /// Takes over the arcs.
    ///
    /// # Errors
    /// No arc.
    pub fn new(arcs: Vec<OpenArc>) -> Result<Self, OutlineError> {
        if arcs.is_empty() {
            return Err(OutlineError::NoArc);
        }
        Ok(Self { arcs })
    }

    /// The arcs in order.
    #[must_use]
    pub fn arcs(&self) -> &[OpenArc] {
        &self.arcs
    }
}

/// What one frame shows of one object: the whole contour, or open arcs of it.
#[derive(Debug, Clone, PartialEq)]
pub enum Outline {
    /// The whole contour.
    Closed(ClosedOutline),
    /// Parts of the contour.
    Open(OpenOutline),
}

/// One run of neighbouring points and whether its last point is joined to its first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece<'a> {
    /// The points in order.
    pub points: &'a [Point2<f64>],
    /// Whether the last point is joined to the first.
    pub closed: bool,
}

impl Outline {
    /// A closed outline from its points; see [`ClosedOutline::new`].
    ///
    /// # Errors
    /// As [`ClosedOutline::new`].
    pub fn closed(points: Vec<Point2<f64>>) -> Result<Self, OutlineError> {
        ClosedOutline::new(points).map(Self::Closed)
    }

    /// The connected pieces: one for a closed outline, one per arc otherwise.
    pub fn pieces(&self) -> impl Iterator<Item = Piece<'_>> + Clone {
        let (whole, arcs) = match self {
            Self::Closed(outline) => (Some(outline), &[][..]),
            Self::Open(outline) => (None, outline.arcs()),
        };
        let closed = whole.map(|outline| Piece { points: outline.points(), closed: true });
        let open = arcs.iter().map(|arc| Piece { points: arc.points(), closed: false });
        closed.into_iter().chain(open)
    }

    /// All points in order, the arcs one after the other.
    pub fn points(&self) -> impl Iterator<Item = &Point2<f64>> + Clone {
        self.pieces().flat_map(|piece| piece.points)
    }

    /// Number of points, at least 2.
    #[must_use]
    pub fn point_count(&self) -> usize {
        self.pieces().map(|piece| piece.points.len()).sum()
    }

    /// Area of the polygon through all points in order, gaps closed by straight lines: positive where they run
    /// counter-clockwise in a y-up frame. Its sign tells on which side of an arc the inside lies.
    #[must_use]
    pub fn signed_area(&self) -> f64 {
        signed_area(self.points())
    }

    /// Mean of the points.
    #[must_use]
    pub fn centroid(&self) -> Point2<f64> {
        Spread::of_iter(self.points()).centroid
    }

    /// Root mean square distance of the points from their mean: the size that every fit works in units of.
    #[must_use]
    pub fn rms_radius(&self) -> f64 {
        Spread::of_iter(self.points()).scatter.trace().sqrt()
    }

    /// The same outline with every point moved by an affine map of the plane.
    ///
    /// # Errors
    /// The map sends the points onto one line, to one point, or beyond the accepted range.
    pub fn moved(&self, map: &Affine2<f64>) -> Result<Self, OutlineError> {
        let move_all = |points: &[Point2<f64>]| points.iter().map(|p| map * p).collect();
        match self {
            Self::Closed(outline) => Self::closed(move_all(outline.points())),
            Self::Open(outline) => {
                let arcs = outline.arcs().iter().map(|arc| OpenArc::new(move_all(arc.points())));
                OpenOutline::new(arcs.collect::<Result<_, _>>()?).map(Self::Open)
            }
        }
    }
}

impl From<ClosedOutline> for Outline {
    fn from(outline: ClosedOutline) -> Self {
        Self::Closed(outline)
    }
}

impl From<OpenOutline> for Outline {
    fn from(outline: OpenOutline) -> Self {
        Self::Open(outline)
    }
}

/// First and second central moments of a set of points.
struct Spread {
    centroid: Point2<f64>,
    scatter: Matrix2<f64>,
}

impl Spread {
    fn of(points: &[Point2<f64>]) -> Self {
        Self::of_iter(points.iter())
    }

    fn of_iter<'a>(points: impl Iterator<Item = &'a Point2<f64>> + Clone) -> Self {
        let count = points.clone().count() as f64;
        let sum: Vector2<f64> = points.clone().map(|p| p.coords / count).sum();
        let centroid = Point2::from(sum);
        let scatter = points.map(|p| (p - centroid) * (p - centroid).transpose() / count).sum();
        Self { centroid, scatter }
    }

    /// Smaller over larger principal radius, between 0 and 1.
    fn ratio(&self) -> f64 {
        let (a, b, d) = (self.scatter[(0, 0)], self.scatter[(0, 1)], self.scatter[(1, 1)]);
        let largest = 0.5 * (a + d) + (0.5 * (a - d)).hypot(b);
        if largest > 0.0 { ((a / largest * d - b / largest * b).max(0.0) / largest).sqrt() } else { 0.0 }
    }
}

fn signed_area<'a>(points: impl Iterator<Item = &'a Point2<f64>> + Clone) -> f64 {
    let Some(&origin) = points.clone().next() else { return 0.0 };
    // Relative to the first point, so that a large offset does not cancel the area away.
    let next = points.clone().skip(1);
    0.5 * points.zip(next).map(|(p, q)| (p - origin).perp(&(q - origin))).sum::<f64>()
}

fn check_points(points: &[Point2<f64>], needed: usize) -> Result<(), OutlineError> {
    if points.len() < needed {
        return Err(OutlineError::TooFewPoints { found: points.len(), needed });
    }
    for (index, point) in points.iter().enumerate() {
        for &value in point.coords.iter() {
            if !value.is_finite() {
                return Err(OutlineError::NotFinite { index });
            }
            if value.abs() > COORDINATE_LIMIT {
                return Err(OutlineError::TooLarge { index, value });
            }
        }
    }
    if points.iter().all(|p| *p == points[0]) {
        return Err(OutlineError::Coincident { count: points.len() });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(list: &[(f64, f64)]) -> Vec<Point2<f64>> {
        list.iter().map(|&(x, y)| Point2::new(x, y)).collect()
    }

    #[test]
    fn points_that_are_no_outline_are_refused_with_the_reason() {
        let closed = |list| Outline::closed(points(list));
        assert_eq!(closed(&[(0.0, 0.0)]), Err(OutlineError::TooFewPoints { found: 1, needed: 3 }));
        assert_eq!(closed(&[(1.0, 2.0); 5]), Err(OutlineError::Coincident { count: 5 }));
        assert_eq!(closed(&[(0.0, 0.0), (1.0, 1.0), (3.0, 3.0)]), Err(OutlineError::Collinear { count: 3 }));
        assert_eq!(closed(&[(0.0, 0.0), (f64::NAN, 1.0), (3.0, 3.0)]), Err(OutlineError::NotFinite { index: 1 }));
        assert_eq!(
            closed(&[(0.0, 0.0), (0.0, 1.0), (1e300, 3.0)]),
            Err(OutlineError::TooLarge { index: 2, value: 1e300 })
        );
        assert_eq!(OpenOutline::new(vec![]), Err(OutlineError::NoArc));
    }

    #[test]
    fn collinearity_is_judged_relative_to_the_size_and_not_to_the_offset() {
        let far = points(&[(1e6, 1e6), (1e6 + 1e-3, 1e6), (1e6, 1e6 + 1e-3)]);
        assert!(ClosedOutline::new(far).is_ok());
    }

    #[test]
    fn the_area_is_positive_counter_clockwise() {
        let square = Outline::closed(points(&[(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)])).expect("a square");
        assert_eq!(square.signed_area(), 4.0);
        assert_eq!(square.centroid(), Point2::new(1.0, 1.0));
        assert_eq!(square.rms_radius(), 2.0_f64.sqrt());
    }
}
