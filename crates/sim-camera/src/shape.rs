use std::{borrow::Cow, fmt};

use freeform_curve_fit::ClosedOutline;
use nalgebra::{Point2, Unit, Vector2};

use crate::{
    arc_length::ArcLengthCurve,
    curve::{Segment, Vertex, ellipse_path, smooth_path},
    error::ShapeError,
};

/// Area below which a polygon counts as enclosing nothing, in squares of its diameter.
const SMALLEST_AREA: f64 = 1e-9;

/// A closed curve in the plane of the object (the body frame, y up), running counter-clockwise, walked by arc length.
///
/// A built-in shape is of *unit size*: its area centroid is the origin, and its diameter, the largest distance between two
/// of its points, is 1 (to 1e-6). Places along the curve are given as a fraction of the perimeter, taken modulo 1.
#[derive(Clone, PartialEq)]
pub struct Shape {
    name: Cow<'static, str>,
    curve: ArcLengthCurve,
    area: f64,
    centroid: Point2<f64>,
}

impl Shape {
    /// A polygon as a shape, in the coordinates given; see [`normalised`](Self::normalised). The points are those of a
    /// contour in order, either way round. Its corners stay sharp.
    ///
    /// # Errors
    /// The points are not a closed outline ([`ClosedOutline::new`]), or their polygon has no area.
    pub fn from_polygon(points: &[Point2<f64>]) -> Result<Self, ShapeError> {
        let mut corners = points.to_vec();
        corners.dedup();
        while corners.len() > 1 && corners.first() == corners.last() {
            corners.pop();
        }
        let outline = ClosedOutline::new(corners)?;
        let corners = outline.points();
        let next = corners.iter().cycle().skip(1);
        let segments = corners.iter().zip(next).map(|(p, q)| Segment::line(*p, *q)).collect();
        let shape = Self::from_segments(Cow::Borrowed("polygon"), segments);
        let (area, diameter) = (outline.signed_area(), shape.diameter());
        if area.abs() < SMALLEST_AREA * diameter * diameter {
            return Err(ShapeError::NoArea { area, diameter });
        }
        Ok(shape)
    }

    /// This shape with another name.
    #[must_use]
    pub fn with_name(mut self, name: impl Into<String>) -> Self {
        self.name = Cow::Owned(name.into());
        self
    }

    /// This shape at unit size: area centroid at the origin, diameter 1.
    #[must_use]
    pub fn normalised(&self) -> Self {
        let scale = 1.0 / self.diameter();
        let segments = self.curve.segments().iter().map(|s| s.normalised(&self.centroid.coords, scale)).collect();
        Self::from_segments(self.name.clone(), segments)
    }

    pub(crate) fn drawn(name: &'static str, vertices: &[Vertex]) -> Self {
        Self::from_segments(Cow::Borrowed(name), smooth_path(vertices)).normalised()
    }

    pub(crate) fn ellipse(name: &'static str, a: f64, b: f64) -> Self {
        Self::from_segments(Cow::Borrowed(name), ellipse_path(a, b))
    }

    fn from_segments(name: Cow<'static, str>, mut segments: Vec<Segment>) -> Self {
        // Green's theorem relative to a point of the curve, so that a large offset does not cancel the area away.
        let origin = segments.first().map_or_else(Vector2::zeros, |s| s.point(0.0).coords);
        let (signed_area, moments) = segments
            .iter()
            .map(|s| s.normalised(&origin, 1.0).area_and_moments())
            .fold((0.0, Vector2::zeros()), |(area, moments), (a, m)| (area + a, moments + m));
        if signed_area < 0.0 {
            segments = segments.iter().rev().map(Segment::reversed).collect();
        }
        let centroid = Point2::from(origin + moments / signed_area);
        Self { name, curve: ArcLengthCurve::new(segments), area: signed_area.abs(), centroid }
    }

    /// Name of the shape, `polygon` for one made from points.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Length of the closed curve.
    #[must_use]
    pub fn perimeter(&self) -> f64 {
        self.curve.perimeter()
    }

    /// Area enclosed, positive.
    #[must_use]
    pub fn area(&self) -> f64 {
        self.area
    }

    /// Centroid of the area enclosed.
    #[must_use]
    pub fn centroid(&self) -> Point2<f64> {
        self.centroid
    }

    /// Largest distance between two points of the curve, to 1e-6 of itself.
    #[must_use]
    pub fn diameter(&self) -> f64 {
        let hull = convex_hull(self.curve.fine_points().collect());
        largest_distance(&hull)
    }

    /// The point at a fraction of the perimeter.
    #[must_use]
    pub fn point_at(&self, fraction: f64) -> Point2<f64> {
        self.curve.point(fraction)
    }

    /// The unit tangent at a fraction of the perimeter, pointing the way the curve runs.
    #[must_use]
    pub fn tangent_at(&self, fraction: f64) -> Unit<Vector2<f64>> {
        self.curve.tangent(fraction)
    }

    /// The outward unit normal at a fraction of the perimeter.
    #[must_use]
    pub fn normal_at(&self, fraction: f64) -> Unit<Vector2<f64>> {
        let tangent = self.tangent_at(fraction);
        Unit::new_unchecked(Vector2::new(tangent.y, -tangent.x))
    }

    /// `count` points equally spaced by arc length, the first at the fraction `phase`.
    #[must_use]
    pub fn sample(&self, count: usize, phase: f64) -> Vec<Point2<f64>> {
        (0..count).map(|k| self.point_at(phase + k as f64 / count as f64)).collect()
    }
}

impl fmt::Debug for Shape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut fields = f.debug_struct("Shape");
        fields.field("name", &self.name).field("perimeter", &self.perimeter()).field("area", &self.area);
        fields.finish_non_exhaustive()
    }
}

/// Corners of the convex hull, counter-clockwise, by Andrew's monotone chain (1979).
fn convex_hull(mut points: Vec<Point2<f64>>) -> Vec<Point2<f64>> {
    points.sort_by(|p, q| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)));
    let half = |ordered: &mut dyn Iterator<Item = &Point2<f64>>| {
        let mut chain: Vec<Point2<f64>> = Vec::new();
        for p in ordered {
            while let [.., a, b] = chain[..]
                && (b - a).perp(&(p - b)) <= 0.0
            {
                chain.pop();
            }
            chain.push(*p);
        }
        // The last point is the first of the other half.
        chain.pop();
        chain
    };
    let (lower, upper) = (half(&mut points.iter()), half(&mut points.iter().rev()));
    lower.into_iter().chain(upper).collect()
}

/// Largest distance between two corners of a convex polygon, by rotating calipers (Shamos, 1978).
fn largest_distance(hull: &[Point2<f64>]) -> f64 {
    let count = hull.len();
    let mut far = 1;
    let mut largest = 0.0_f64;
    for i in 0..count {
        let (from, to) = (hull[i], hull[(i + 1) % count]);
        let height = |k: usize| (to - from).perp(&(hull[k % count] - from));
        // At most once round: equal heights of a tiny polygon must not keep it turning.
        let limit = far + count;
        while far < limit && height(far + 1) > height(far) {
            far += 1;
        }
        let opposite = hull[far % count];
        largest = largest.max((opposite - from).norm()).max((opposite - to).norm());
    }
    largest
}
