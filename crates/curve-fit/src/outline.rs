use std::borrow::Cow;

use nalgebra::{Affine2, Point2, Vector2};

use crate::deviations::{check_deviations, mapped_deviations};
use crate::error::OutlineError;
use crate::open_outline::OpenOutline;
use crate::points::{Spread, check_not_collinear, check_points, signed_area};
use crate::rectangle::Rectangle;

/// Most points that sides are filled with, about: a contour of a few pixels' noise needs no more, and a damaged coordinate must not ask for all
/// memory.
const MOST_SIDES: f64 = 1e4;

/// Points of the boundary of a body in the order in which they follow each other, either way round; the last is joined to the
/// first, which is not repeated. At least three finite points that do not lie on one line. There may be further closed contours of
/// the same body within it, such as of holes and marks. Points may have standard deviations, all of them or none.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "WrittenOutline", into = "WrittenOutline"))]
pub struct ClosedOutline {
    points: Vec<Point2<f64>>,
    inner: Vec<Vec<Point2<f64>>>,
    /// Of all points, the boundary first.
    deviations: Option<Vec<f64>>,
}

impl ClosedOutline {
    /// Checks and takes over the points, in any length unit.
    ///
    /// # Errors
    /// Fewer than 3 points, a coordinate that is not finite or beyond 1e100, all points equal or on one line.
    pub fn new(points: Vec<Point2<f64>>) -> Result<Self, OutlineError> {
        check_points(&points, 3)?;
        check_not_collinear(points.iter())?;
        Ok(Self { points, inner: Vec::new(), deviations: None })
    }

    /// This boundary with further closed contours of the body, in the place of those that it had: of holes and marks within it. Those of
    /// holes run the other way round than the boundary. Standard deviations are to be given after them.
    ///
    /// # Errors
    /// As [`new`](Self::new), of any of them.
    pub fn with_inner(self, inner: Vec<Vec<Point2<f64>>>) -> Result<Self, OutlineError> {
        for contour in &inner {
            check_points(contour, 3)?;
            check_not_collinear(contour.iter())?;
        }
        Ok(Self { inner, deviations: None, ..self })
    }

    /// This outline with standard deviations of its points; see [`Outline::with_deviations`].
    ///
    /// # Errors
    /// As [`Outline::with_deviations`].
    pub fn with_deviations(self, deviations: Vec<f64>) -> Result<Self, OutlineError> {
        check_deviations(&deviations, self.contours().map(<[_]>::len).sum())?;
        Ok(Self { deviations: Some(deviations), ..self })
    }

    /// The boundary and the further contours.
    fn contours(&self) -> impl Iterator<Item = &[Point2<f64>]> + Clone {
        std::iter::once(self.points.as_slice()).chain(self.inner.iter().map(Vec::as_slice))
    }

    /// The further contours, each closed.
    #[must_use]
    pub fn inner(&self) -> &[Vec<Point2<f64>>] {
        &self.inner
    }

    /// This outline with every point mapped, and its standard deviations as the map stretches what lies across the contour there.
    ///
    /// # Errors
    /// As [`new`](Self::new) and [`with_deviations`](Self::with_deviations), of what the points become.
    pub fn mapped(&self, map: impl Fn(&Point2<f64>) -> Point2<f64>) -> Result<Self, OutlineError> {
        let all = |points: &Vec<Point2<f64>>| points.iter().map(&map).collect();
        let moved = Self::new(all(&self.points))?.with_inner(self.inner.iter().map(all).collect())?;
        let Some(mut rest) = self.deviations.as_deref() else { return Ok(moved) };
        let mut deviations = Vec::with_capacity(rest.len());
        for contour in self.contours() {
            let (own, others) = rest.split_at(contour.len());
            deviations.extend(mapped_deviations(contour, true, own, &map));
            rest = others;
        }
        moved.with_deviations(deviations)
    }

    /// This outline with points along the sides between its own, so that from one to the next neither coordinate changes by more than `longest`,
    /// or by a ten-thousandth of the length of the contours where that is more: a polygon whose corners alone are given shows its sides too. An
    /// outline whose points have standard deviations stays as it is, as they are measurements. So it does if `longest` is not positive.
    #[must_use]
    pub fn with_sides(&self, longest: f64) -> Self {
        if self.deviations.is_some() || longest.is_nan() || longest <= 0.0 {
            return self.clone();
        }
        let longest = longest.max(self.length() / MOST_SIDES);
        let along = |points: &[Point2<f64>]| {
            let mut all = Vec::new();
            for (from, side) in sides(points) {
                let count = (side.amax() / longest).ceil().max(1.0);
                all.extend((0..count as usize).map(|k| from + side * (k as f64 / count)));
            }
            all
        };
        let inner = self.inner.iter().map(|contour| along(contour)).collect();
        Self { points: along(&self.points), inner, deviations: None }
    }

    /// Length of all contours, the sides that close them included.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.contours().flat_map(sides).map(|(_, side)| side.norm()).sum()
    }

    /// Lengths of the sides of the boundary, from each of its points to the next, the one that closes it last.
    pub fn side_lengths(&self) -> impl ExactSizeIterator<Item = f64> + Clone {
        sides(&self.points).map(|(_, side)| side.norm())
    }

    /// The points of the boundary in order.
    #[must_use]
    pub fn points(&self) -> &[Point2<f64>] {
        &self.points
    }

    /// Area within the boundary by the shoelace formula: positive where the points run counter-clockwise in a y-up frame.
    #[must_use]
    pub fn signed_area(&self) -> f64 {
        signed_area(self.points.iter())
    }
}

/// Every point of a closed contour, and the way from there to the next.
fn sides(points: &[Point2<f64>]) -> impl ExactSizeIterator<Item = (&Point2<f64>, Vector2<f64>)> + Clone {
    (0..points.len()).map(|i| (&points[i], points[(i + 1) % points.len()] - points[i]))
}

/// What one frame shows of one object: the whole contour, or open arcs of it.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Outline {
    /// The whole contour.
    Closed(ClosedOutline),
    /// Parts of the contour.
    Open(OpenOutline),
}

/// The boundary first, then the further contours; and the deviations.
#[cfg(feature = "serde")]
type WrittenOutline = (Vec<Vec<Point2<f64>>>, Option<Vec<f64>>);

#[cfg(feature = "serde")]
impl TryFrom<WrittenOutline> for ClosedOutline {
    type Error = OutlineError;

    fn try_from((contours, deviations): WrittenOutline) -> Result<Self, OutlineError> {
        let mut contours = contours.into_iter();
        let outline = Self::new(contours.next().unwrap_or_default())?.with_inner(contours.collect())?;
        match deviations {
            Some(deviations) => outline.with_deviations(deviations),
            None => Ok(outline),
        }
    }
}

#[cfg(feature = "serde")]
impl From<ClosedOutline> for WrittenOutline {
    fn from(outline: ClosedOutline) -> Self {
        (std::iter::once(outline.points).chain(outline.inner).collect(), outline.deviations)
    }
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
    /// Length of all contours or arcs; of contours the sides that close them included.
    ///
    /// ```
    /// use freeform_curve_fit::{OpenArc, OpenOutline, Outline};
    /// use nalgebra::Point2;
    ///
    /// let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]].map(Point2::from).to_vec();
    /// assert_eq!(Outline::closed(corners.clone())?.length(), 8.0);
    /// assert_eq!(Outline::Open(OpenOutline::new(vec![OpenArc::new(corners)?])?).length(), 6.0);
    /// # Ok::<(), freeform_curve_fit::OutlineError>(())
    /// ```
    #[must_use]
    pub fn length(&self) -> f64 {
        match self {
            Self::Closed(outline) => outline.length(),
            Self::Open(outline) => outline
                .arcs()
                .iter()
                .flat_map(|arc| arc.points().windows(2))
                .map(|side| (side[1] - side[0]).norm())
                .sum(),
        }
    }

    /// A closed outline from its points; see [`ClosedOutline::new`].
    ///
    /// # Errors
    /// As [`ClosedOutline::new`].
    pub fn closed(points: Vec<Point2<f64>>) -> Result<Self, OutlineError> {
        ClosedOutline::new(points).map(Self::Closed)
    }

    /// The connected pieces: the boundary of a closed outline and its further contours, one per arc otherwise.
    pub fn pieces(&self) -> impl Iterator<Item = Piece<'_>> + Clone {
        let (whole, arcs) = match self {
            Self::Closed(outline) => (Some(outline), &[][..]),
            Self::Open(outline) => (None, outline.arcs()),
        };
        let closed = whole.into_iter().flat_map(ClosedOutline::contours).map(|points| Piece { points, closed: true });
        let open = arcs.iter().map(|arc| Piece { points: arc.points(), closed: false });
        closed.chain(open)
    }

    /// This outline without further contours within the boundary.
    #[must_use]
    pub fn boundary(&self) -> Cow<'_, Self> {
        match self {
            Self::Closed(ClosedOutline { points, inner, deviations }) if !inner.is_empty() => {
                let deviations = deviations.as_ref().map(|deviations| deviations[..points.len()].to_vec());
                Cow::Owned(Self::Closed(ClosedOutline { points: points.clone(), inner: Vec::new(), deviations }))
            }
            _ => Cow::Borrowed(self),
        }
    }

    /// This outline with standard deviations of its points along the normal of the contour, in the unit of the points and in their order,
    /// in the place of those that it had. They say how much a point counts in comparison with others: a factor that all of them have in
    /// common does not matter.
    ///
    /// # Errors
    /// Not one for each point, or one that is not a positive finite number.
    pub fn with_deviations(self, deviations: Vec<f64>) -> Result<Self, OutlineError> {
        Ok(match self {
            Self::Closed(outline) => Self::Closed(outline.with_deviations(deviations)?),
            Self::Open(outline) => Self::Open(outline.with_deviations(deviations)?),
        })
    }

    /// The standard deviations of the points in their order; `None` where nothing is known of them.
    pub fn deviations(&self) -> Option<impl Iterator<Item = f64> + Clone> {
        let (whole, arcs) = match self {
            Self::Closed(outline) => (outline.deviations.as_deref()?, &[][..]),
            Self::Open(outline) if outline.has_deviations() => (&[][..], outline.arcs()),
            Self::Open(_) => return None,
        };
        Some(whole.iter().chain(arcs.iter().flat_map(|arc| arc.deviations().unwrap_or_default())).copied())
    }

    /// All points in order, the arcs or contours one after the other.
    pub fn points(&self) -> impl Iterator<Item = &Point2<f64>> + Clone {
        self.pieces().flat_map(|piece| piece.points)
    }

    /// Number of points, at least 3.
    #[must_use]
    pub fn point_count(&self) -> usize {
        self.pieces().map(|piece| piece.points.len()).sum()
    }

    /// Area of the polygon through all points in order, gaps closed by straight lines; of a closed outline, within its boundary: positive
    /// where they run counter-clockwise in a y-up frame. Its sign gives the side of an arc on which the inside lies.
    #[must_use]
    pub fn signed_area(&self) -> f64 {
        match self {
            Self::Closed(outline) => outline.signed_area(),
            Self::Open(_) => signed_area(self.points()),
        }
    }

    /// The smallest rectangle that holds all points.
    #[must_use]
    pub fn bounding_box(&self) -> Rectangle {
        let first = self.points().next().copied().unwrap_or_else(Point2::origin);
        Rectangle { low: first, high: first }.extended(self.points())
    }

    /// Mean of the points.
    #[must_use]
    pub fn centroid(&self) -> Point2<f64> {
        Spread::of(self.points()).centroid
    }

    /// Root mean square distance of the points from their mean: the size that every fit works in units of.
    #[must_use]
    pub fn rms_radius(&self) -> f64 {
        Spread::of(self.points()).scatter.trace().sqrt()
    }

    /// This outline with every point moved by an affine map of the plane.
    ///
    /// # Errors
    /// The map sends the points onto one line, to one point, or beyond the accepted range.
    pub fn moved(&self, map: &Affine2<f64>) -> Result<Self, OutlineError> {
        self.mapped(|p| map * p)
    }

    /// This outline with every point mapped, and its standard deviations as the map stretches what lies across the contour there.
    ///
    /// # Errors
    /// The map sends the points onto one line, to one point, or beyond the accepted range.
    pub fn mapped(&self, map: impl Fn(&Point2<f64>) -> Point2<f64>) -> Result<Self, OutlineError> {
        match self {
            Self::Closed(outline) => outline.mapped(map).map(Self::Closed),
            Self::Open(outline) => {
                let arcs = outline.arcs().iter().map(|arc| arc.mapped(&map));
                OpenOutline::in_sequence(arcs.collect::<Result<_, _>>()?).map(Self::Open)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::points::points;

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
