//! What holds for the points of any outline.
use nalgebra::{Matrix2, Point2, Vector2};

use crate::{
    error::{COORDINATE_LIMIT, OutlineError, SMALLEST_EXTENT},
    principal_axis::principal_angle,
};

/// Two principal radii whose ratio is at most this are taken for points on one line.
const COLLINEAR_RATIO: f64 = 1e-9;

/// First and second central moments of a set of points.
pub(crate) struct Spread {
    pub(crate) centroid: Point2<f64>,
    pub(crate) scatter: Matrix2<f64>,
}

impl Spread {
    pub(crate) fn of<'a>(points: impl Iterator<Item = &'a Point2<f64>> + Clone) -> Self {
        let count = points.clone().count() as f64;
        let sum: Vector2<f64> = points.clone().map(|p| p.coords / count).sum();
        let centroid = Point2::from(sum);
        let scatter = points.map(|p| (p - centroid) * (p - centroid).transpose() / count).sum();
        Self { centroid, scatter }
    }

    /// Unit vector along which the points scatter most.
    fn axis(&self) -> Vector2<f64> {
        let angle = principal_angle(&self.scatter);
        Vector2::new(angle.cos(), angle.sin())
    }
}

/// Refuses points whose distances from the line that fits them best are no more than rounding of their coordinates.
pub(crate) fn check_not_collinear<'a>(
    points: impl Iterator<Item = &'a Point2<f64>> + Clone,
) -> Result<(), OutlineError> {
    let spread = Spread::of(points.clone());
    let axis = spread.axis();
    // From the distances themselves: the determinant of the scatter would lose half the digits to cancellation.
    let (mut count, mut length, mut width, mut largest, mut extent) = (0, 0.0, 0.0, 0.0_f64, 0.0_f64);
    for p in points {
        let from_centroid = p - spread.centroid;
        count += 1;
        length += axis.dot(&from_centroid).powi(2);
        width += axis.perp(&from_centroid).powi(2);
        largest = largest.max(p.coords.amax());
        extent = extent.max(from_centroid.amax());
    }
    if extent > 0.0 && extent < SMALLEST_EXTENT {
        return Err(OutlineError::TooSmall { extent });
    }
    let (length, width) = ((length / f64::from(count)).sqrt(), (width / f64::from(count)).sqrt());
    if width <= (COLLINEAR_RATIO * length).max(f64::EPSILON * largest) {
        return Err(OutlineError::Collinear { count: count as usize });
    }
    Ok(())
}

pub(crate) fn signed_area<'a>(points: impl Iterator<Item = &'a Point2<f64>> + Clone) -> f64 {
    let Some(&origin) = points.clone().next() else { return 0.0 };
    // Relative to the first point, so that a large offset does not cancel the area away.
    let next = points.clone().skip(1);
    0.5 * points.zip(next).map(|(p, q)| (p - origin).perp(&(q - origin))).sum::<f64>()
}

pub(crate) fn check_points(points: &[Point2<f64>], needed: usize) -> Result<(), OutlineError> {
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

/// Points for tests.
#[cfg(test)]
pub(crate) fn points(list: &[(f64, f64)]) -> Vec<Point2<f64>> {
    list.iter().map(|&(x, y)| Point2::new(x, y)).collect()
}
