use std::borrow::Cow;

use nalgebra::{Affine2, Matrix2, Point2, Vector2};

use crate::error::{COORDINATE_LIMIT, OutlineError};
use crate::rectangle::Rectangle;

/// Two principal radii whose ratio is at most this are taken for points on one line.
const COLLINEAR_RATIO: f64 = 1e-9;

/// Points of the boundary of a body in the order in which they follow each other, either way round; the last is joined to the
/// first, which is not repeated. At least three finite points that do not lie on one line. There may be further closed contours of
/// the same body within it, such as of holes and marks.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Vec<Vec<Point2<f64>>>", into = "Vec<Vec<Point2<f64>>>"))]
pub struct ClosedOutline {
    points: Vec<Point2<f64>>,
    inner: Vec<Vec<Point2<f64>>>,
}

impl ClosedOutline {
    /// Checks and takes over the points, in any length unit.
    ///
    /// # Errors
    /// Fewer than 3 points, a coordinate that is not finite or beyond 1e100, all points equal or on one line.
    pub fn new(points: Vec<Point2<f64>>) -> Result<Self, OutlineError> {
        check_points(&points, 3)?;
        check_not_collinear(points.iter())?;
        Ok(Self { points, inner: Vec::new() })
    }

    /// This boundary with further closed contours of the body, in the place of those that it had: of holes and marks within it. Those of
    /// holes run the other way round than the boundary.
    ///
    /// # Errors
    /// As [`new`](Self::new), of any of them.
    pub fn with_inner(self, inner: Vec<Vec<Point2<f64>>>) -> Result<Self, OutlineError> {
        for contour in &inner {
            check_points(contour, 3)?;
            check_not_collinear(contour.iter())?;
        }
        Ok(Self { inner, ..self })
    }

    /// The further contours, each closed.
    #[must_use]
    pub fn inner(&self) -> &[Vec<Point2<f64>>] {
        &self.inner
    }

    /// This outline with every point mapped.
    ///
    /// # Errors
    /// As [`new`](Self::new), of what the points become.
    pub fn mapped(&self, map: impl Fn(&Point2<f64>) -> Point2<f64>) -> Result<Self, OutlineError> {
        let all = |points: &Vec<Point2<f64>>| points.iter().map(&map).collect();
        Self::new(all(&self.points))?.with_inner(self.inner.iter().map(all).collect())
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

/// An ordered open piece of a contour, either way round: at least two finite points that are not all equal.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Vec<Point2<f64>>", into = "Vec<Point2<f64>>"))]
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

/// What is seen of a partly hidden contour: one or more open arcs, all running the same way round, in the order in which
/// the contour passes through them; not all on one line.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Vec<OpenArc>", into = "Vec<OpenArc>"))]
pub struct OpenOutline {
    arcs: Vec<OpenArc>,
}

impl OpenOutline {
    /// Takes over arcs that may each run either way round, and turns them the same way: each takes the direction that
    /// makes the gaps between the end of every arc and the beginning of the next, and from the last to the first,
    /// shortest in total. For arcs of a convex contour that is how it passes through them; of one with deep bays, a gap
    /// across a bay can be shorter than the true one, so use [`in_sequence`](Self::in_sequence) where the directions are
    /// known.
    ///
    /// The arcs are to be listed in their order along the contour, either way round; for up to three, every order is that.
    ///
    /// # Errors
    /// No arc, all points on one line.
    pub fn new(mut arcs: Vec<OpenArc>) -> Result<Self, OutlineError> {
        turn_the_same_way(&mut arcs);
        Self::in_sequence(arcs)
    }

    /// Takes over arcs that are known to run the same way round, as they are.
    ///
    /// # Errors
    /// No arc, all points on one line.
    pub fn in_sequence(arcs: Vec<OpenArc>) -> Result<Self, OutlineError> {
        if arcs.is_empty() {
            return Err(OutlineError::NoArc);
        }
        check_not_collinear(arcs.iter().flat_map(|arc| &arc.points))?;
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
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Outline {
    /// The whole contour.
    Closed(ClosedOutline),
    /// Parts of the contour.
    Open(OpenOutline),
}

impl TryFrom<Vec<Vec<Point2<f64>>>> for ClosedOutline {
    type Error = OutlineError;

    /// The boundary first, then the further contours.
    fn try_from(contours: Vec<Vec<Point2<f64>>>) -> Result<Self, OutlineError> {
        let mut contours = contours.into_iter();
        Self::new(contours.next().unwrap_or_default())?.with_inner(contours.collect())
    }
}

impl From<ClosedOutline> for Vec<Vec<Point2<f64>>> {
    fn from(outline: ClosedOutline) -> Self {
        std::iter::once(outline.points).chain(outline.inner).collect()
    }
}

impl TryFrom<Vec<Point2<f64>>> for OpenArc {
    type Error = OutlineError;

    fn try_from(points: Vec<Point2<f64>>) -> Result<Self, OutlineError> {
        Self::new(points)
    }
}

impl From<OpenArc> for Vec<Point2<f64>> {
    fn from(arc: OpenArc) -> Self {
        arc.points
    }
}

impl TryFrom<Vec<OpenArc>> for OpenOutline {
    type Error = OutlineError;

    fn try_from(arcs: Vec<OpenArc>) -> Result<Self, OutlineError> {
        Self::in_sequence(arcs)
    }
}

impl From<OpenOutline> for Vec<OpenArc> {
    fn from(outline: OpenOutline) -> Self {
        outline.arcs
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
        let contours = whole.into_iter().flat_map(|outline| outline.inner().iter().map(Vec::as_slice));
        let contours = whole.map(ClosedOutline::points).into_iter().chain(contours);
        let closed = contours.map(|points| Piece { points, closed: true });
        let open = arcs.iter().map(|arc| Piece { points: arc.points(), closed: false });
        closed.chain(open)
    }

    /// This outline without further contours within the boundary.
    #[must_use]
    pub fn boundary(&self) -> Cow<'_, Self> {
        match self {
            Self::Closed(ClosedOutline { points, inner }) if !inner.is_empty() => {
                Cow::Owned(Self::Closed(ClosedOutline { points: points.clone(), inner: Vec::new() }))
            }
            _ => Cow::Borrowed(self),
        }
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
        let move_all = |points: &[Point2<f64>]| points.iter().map(|p| map * p).collect();
        match self {
            Self::Closed(outline) => outline.mapped(|p| map * p).map(Self::Closed),
            Self::Open(outline) => {
                let arcs = outline.arcs().iter().map(|arc| OpenArc::new(move_all(arc.points())));
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

/// First and second central moments of a set of points.
struct Spread {
    centroid: Point2<f64>,
    scatter: Matrix2<f64>,
}

impl Spread {
    fn of<'a>(points: impl Iterator<Item = &'a Point2<f64>> + Clone) -> Self {
        let count = points.clone().count() as f64;
        let sum: Vector2<f64> = points.clone().map(|p| p.coords / count).sum();
        let centroid = Point2::from(sum);
        let scatter = points.map(|p| (p - centroid) * (p - centroid).transpose() / count).sum();
        Self { centroid, scatter }
    }

    /// Unit vector along which the points scatter most.
    fn axis(&self) -> Vector2<f64> {
        let (a, b, d) = (self.scatter[(0, 0)], self.scatter[(0, 1)], self.scatter[(1, 1)]);
        let angle = 0.5 * (2.0 * b).atan2(a - d);
        Vector2::new(angle.cos(), angle.sin())
    }
}

/// Refuses points whose distances from the line that fits them best are no more than rounding of their coordinates.
fn check_not_collinear<'a>(points: impl Iterator<Item = &'a Point2<f64>> + Clone) -> Result<(), OutlineError> {
    let spread = Spread::of(points.clone());
    let axis = spread.axis();
    // From the distances themselves: the determinant of the scatter would lose half the digits to cancellation.
    let (mut count, mut length, mut width, mut largest) = (0, 0.0, 0.0, 0.0_f64);
    for p in points {
        let from_centroid = p - spread.centroid;
        count += 1;
        length += axis.dot(&from_centroid).powi(2);
        width += axis.perp(&from_centroid).powi(2);
        largest = largest.max(p.coords.amax());
    }
    let (length, width) = ((length / f64::from(count)).sqrt(), (width / f64::from(count)).sqrt());
    if width <= (COLLINEAR_RATIO * length).max(f64::EPSILON * largest) {
        return Err(OutlineError::Collinear { count: count as usize });
    }
    Ok(())
}

/// Reverses arcs so that the gaps from each to the next, and from the last to the first, are shortest in total. Of equal
/// totals, that with more of the arcs as they are counts, the first above all.
fn turn_the_same_way(arcs: &mut [OpenArc]) {
    if arcs.len() < 2 {
        return;
    }
    let [as_it_is, reversed] = [false, true].map(|first| shortest_joining(arcs, first));
    let (_, directions) = if reversed.0 < as_it_is.0 { reversed } else { as_it_is };
    arcs.iter_mut().zip(directions).filter(|(_, reverse)| *reverse).for_each(|(arc, _)| arc.points.reverse());
}

/// Total length of the gaps and which arcs to reverse, for one direction of the first arc.
fn shortest_joining(arcs: &[OpenArc], reverse_first: bool) -> (f64, Vec<bool>) {
    // Both ways through an arc, as it is and reversed: where it begins and where it ends.
    let ways = |arc: &OpenArc| {
        let (begin, end) = (arc.points[0], arc.points[arc.points.len() - 1]);
        [(begin, end), (end, begin)]
    };
    let (start, first_end) = ways(&arcs[0])[usize::from(reverse_first)];
    // Shortest totals up to each way through the arc before, and where it ends.
    let mut reached = [(0.0, first_end); 2];
    // Which way through the arc before belongs to each way through an arc.
    let mut choices: Vec<[usize; 2]> = Vec::with_capacity(arcs.len());
    for arc in &arcs[1..] {
        let mut choice = [0; 2];
        let mut next = reached;
        for (way, (begin, end)) in ways(arc).into_iter().enumerate() {
            let via = reached.map(|(total, from)| total + (begin - from).norm());
            choice[way] = usize::from(via[1] < via[0]);
            next[way] = (via[choice[way]], end);
        }
        choices.push(choice);
        reached = next;
    }
    let closed = reached.map(|(total, from)| total + (start - from).norm());
    let mut way = usize::from(closed[1] < closed[0]);
    let total = closed[way];
    let mut directions = vec![reverse_first; arcs.len()];
    for (direction, choice) in directions.iter_mut().skip(1).zip(&choices).rev() {
        *direction = way == 1;
        way = choice[way];
    }
    (total, directions)
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
    fn points_on_one_line_up_to_rounding_are_refused_in_whole_and_in_arcs() {
        for turn in 0..50 {
            let (sin, cos) = (0.13 * f64::from(turn)).sin_cos();
            let offset = f64::from(turn * turn);
            let at = |k: i32| (offset + cos * f64::from(k) / 7.0, sin * f64::from(k) / 7.0 - 3.0 * offset);
            let line: Vec<_> = (0..60).map(at).collect();
            assert_eq!(Outline::closed(points(&line)), Err(OutlineError::Collinear { count: 60 }));
            let arcs = || line.chunks(20).map(|part| OpenArc::new(points(part)).expect("an arc")).collect::<Vec<_>>();
            assert_eq!(OpenOutline::new(arcs()), Err(OutlineError::Collinear { count: 60 }));
            assert_eq!(OpenOutline::in_sequence(arcs()), Err(OutlineError::Collinear { count: 60 }));
            // Straight arcs that are not in line with each other do make an outline.
            let mut bent = arcs();
            bent[1].points.iter_mut().for_each(|p| *p += 0.1 * Vector2::new(-sin, cos));
            assert!(OpenOutline::new(bent).is_ok());
        }
    }

    #[test]
    fn arcs_of_a_contour_run_the_same_way_however_each_was_given() {
        // Seven arcs of an ellipse, with gaps of different lengths.
        let at = |k: u32| (3.0 * (0.01 * f64::from(k)).cos(), (0.01 * f64::from(k)).sin());
        let bounds = [(0, 40), (60, 90), (100, 230), (240, 250), (300, 330), (420, 480), (500, 610)];
        let arcs = bounds.map(|(from, to)| points(&(from..to).map(at).collect::<Vec<_>>()));
        for reversed in 0..1_u32 << arcs.len() {
            let mut given = arcs.clone();
            given.iter_mut().enumerate().filter(|(i, _)| reversed >> i & 1 == 1).for_each(|(_, arc)| arc.reverse());
            let given: Vec<_> = given.into_iter().map(|arc| OpenArc::new(arc).expect("an arc")).collect();
            let outline = OpenOutline::new(given.clone()).expect("arcs");
            assert!(outline.arcs().iter().zip(&arcs).all(|(arc, original)| arc.points() == original));
            // Listed the other way round, they run the other way round.
            let backwards = OpenOutline::new(given.iter().rev().cloned().collect()).expect("arcs");
            for (arc, original) in backwards.arcs().iter().zip(arcs.iter().rev()) {
                assert!(arc.points().iter().rev().eq(original));
            }
            // Two arcs have no order: the first stays as it is.
            let two = OpenOutline::new(given[..2].to_vec()).expect("arcs");
            let same = |i: usize| two.arcs()[i].points() == arcs[i];
            assert!(two.arcs()[0] == given[0] && same(0) == same(1));
            // What has been turned once stays.
            assert_eq!(OpenOutline::new(outline.arcs().to_vec()).as_ref(), Ok(&outline));
        }
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
