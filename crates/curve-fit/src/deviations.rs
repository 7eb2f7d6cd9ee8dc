//! Standard deviations of points along the normal of their contour.
use nalgebra::{Point2, Vector2};

use crate::error::OutlineError;

/// Refuses a list that is not one positive finite number for each of so many points.
pub(crate) fn check_deviations(deviations: &[f64], points: usize) -> Result<(), OutlineError> {
    if deviations.len() != points {
        return Err(OutlineError::DeviationCount { found: deviations.len(), points });
    }
    let is_wrong = |value: &f64| !(value.is_finite() && *value > 0.0);
    match deviations.iter().position(is_wrong) {
        Some(index) => Err(OutlineError::Deviation { index, value: deviations[index] }),
        None => Ok(()),
    }
}

/// The deviations of the points of a run after a map: how far it moves a point across the mapped contour that is moved by its
/// deviation across the contour.
pub(crate) fn mapped_deviations<'a>(
    points: &'a [Point2<f64>],
    closed: bool,
    deviations: &'a [f64],
    map: impl Fn(&Point2<f64>) -> Point2<f64> + 'a,
) -> impl Iterator<Item = f64> + 'a {
    let last = points.len() - 1;
    deviations.iter().enumerate().map(move |(i, deviation)| {
        let before = if i > 0 { i - 1 } else { usize::from(closed) * last };
        let after = if i < last { i + 1 } else { usize::from(!closed) * last };
        let along = points[after] - points[before];
        let across = Vector2::new(-along.y, along.x).try_normalize(0.0).unwrap_or_else(Vector2::x);
        let moved = map(&(points[i] + *deviation * across)) - map(&points[i]);
        match (map(&points[after]) - map(&points[before])).try_normalize(0.0) {
            Some(direction) => direction.perp(&moved).abs(),
            None => moved.norm(),
        }
    })
}
