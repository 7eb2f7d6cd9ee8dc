//! Straight lines through points.
use freeform_curve_fit::principal_angle;
use nalgebra::{Matrix2, Point2, Vector2};

#[cfg(feature = "serde")]
use crate::tuning::map::UNIT_NORMAL;
use crate::tuning::occlusion::{FITS_OF_PART, SEED, SEED_OVERLAP, SEED_STEP, STRAIGHT, WITHIN};

/// A straight line.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Line {
    /// A point on it: the mean of those that it was found from.
    pub(super) through: Point2<f64>,
    /// Of length 1.
    pub(super) along: Vector2<f64>,
}

impl Line {
    pub(super) fn normal(&self) -> Vector2<f64> {
        Vector2::new(-self.along.y, self.along.x)
    }

    /// Distance of a point from it, positive on the side of the normal.
    pub(super) fn distance(&self, p: &Point2<f64>) -> f64 {
        self.normal().dot(&(p - self.through))
    }

    /// Where along it a point lies.
    pub(super) fn place(&self, p: &Point2<f64>) -> f64 {
        self.along.dot(&(p - self.through))
    }

    pub(super) fn at(&self, place: f64) -> Point2<f64> {
        self.through + self.along * place
    }

    pub(super) fn moved(&self, shift: f64) -> Self {
        Self { through: self.through + self.normal() * shift, ..*self }
    }

    #[cfg(feature = "serde")]
    pub(super) fn is_valid(&self) -> bool {
        self.through.coords.norm().is_finite() && (self.along.norm() - 1.0).abs() < UNIT_NORMAL
    }

    /// The line of least mean square distance from points, with the root of that; `None` of fewer than two points.
    pub(super) fn through(points: impl Iterator<Item = Point2<f64>> + Clone) -> Option<(Self, f64)> {
        let count = points.clone().count() as f64;
        if count < 2.0 {
            return None;
        }
        let mean = points.clone().fold(Vector2::zeros(), |sum, p| sum + p.coords) / count;
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        for p in points {
            let d = p.coords - mean;
            (xx, xy, yy) = (xx + d.x * d.x, xy + d.x * d.y, yy + d.y * d.y);
        }
        let (middle, difference) = (0.5 * (xx + yy), 0.5 * (xx - yy));
        let least = (middle - difference.hypot(xy)).max(0.0);
        let angle = principal_angle(&Matrix2::new(xx, xy, xy, yy));
        let line = Self { through: mean.into(), along: Vector2::new(angle.cos(), angle.sin()) };
        Some((line, (least / count).sqrt()))
    }
}

/// The longest straight part of a run of points, of at least so many and with so much noise: which of them, and the line. One point that lies off
/// it between two that do not is left in.
pub(super) fn longest_straight(
    points: &[Point2<f64>],
    noise: f64,
    fewest: usize,
) -> Option<(std::ops::Range<usize>, Line)> {
    let mut best: Option<(std::ops::Range<usize>, Line)> = None;
    let mut start = 0;
    while start + fewest <= points.len() {
        let Some((seed, scatter)) = Line::through(points[start..start + fewest].iter().copied()) else { break };
        if scatter >= SEED * noise {
            start += (fewest / SEED_STEP).max(1);
            continue;
        }
        let (range, line, scatter) = grown(points, (start..start + fewest, seed), noise);
        let is_longer = best.as_ref().is_none_or(|(other, _)| range.len() > other.len());
        start = (range.end.saturating_sub(fewest / SEED_OVERLAP)).max(start + 1);
        if scatter < STRAIGHT * noise && is_longer {
            best = Some((range, line));
        }
    }
    best
}

/// A straight part as long as its neighbours lie on its line, with what its points scatter by.
fn grown(
    points: &[Point2<f64>],
    (mut range, mut line): (std::ops::Range<usize>, Line),
    noise: f64,
) -> (std::ops::Range<usize>, Line, f64) {
    let mut scatter = 0.0;
    for _ in 0..FITS_OF_PART {
        let lies = |i: usize| points.get(i).is_some_and(|p| line.distance(p).abs() < WITHIN * noise);
        let (mut low, mut high) = (range.start, range.end);
        while high < points.len() && (lies(high) || lies(high + 1)) {
            high += 1;
        }
        while low > 0 && (lies(low - 1) || low > 1 && lies(low - 2)) {
            low -= 1;
        }
        let is_settled = range == (low..high);
        range = low..high;
        if let Some(found) = Line::through(points[range.clone()].iter().copied()) {
            (line, scatter) = found;
        }
        if is_settled {
            break;
        }
    }
    (range, line, scatter)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_through_points_has_their_direction_and_what_they_scatter_by() {
        for angle in [0.0_f64, 0.4, 1.5, 2.9] {
            let along = Vector2::new(angle.cos(), angle.sin());
            let point = |i: i32| {
                let off = if i % 2 == 0 { 0.01 } else { -0.01 };
                Point2::new(3.0, -2.0) + along * f64::from(i) + Vector2::new(-along.y, along.x) * off
            };
            let (line, scatter) = Line::through((0..40).map(point)).expect("points");
            assert!(line.along.dot(&along).abs() > 1.0 - 1e-6, "{line:?}");
            assert!((scatter - 0.01).abs() < 1e-3, "{scatter}");
            assert!((line.distance(&(line.at(5.0) + line.normal() * 0.3)) - 0.3).abs() < 1e-12);
        }
        assert_eq!(Line::through([Point2::origin()].into_iter()), None);
    }

    #[test]
    fn the_longest_straight_part_ends_where_the_points_bend() {
        let bend = |i: i32| {
            let x = f64::from(i);
            Point2::new(x, if i < 10 { 0.2 * (10.0 - x) * (10.0 - x) } else { 0.0 })
        };
        let points: Vec<_> = (0..40).map(bend).collect();
        let (range, line) = longest_straight(&points, 0.05, 6).expect("a straight part");
        assert!((9..=11).contains(&range.start) && range.end == 40, "{range:?}");
        assert!(line.along.x.abs() > 0.999, "{line:?}");
        let circle = |i: i32| Point2::new((0.2 * f64::from(i)).cos(), (0.2 * f64::from(i)).sin());
        let points: Vec<_> = (0..31).map(circle).collect();
        assert_eq!(longest_straight(&points, 0.005, 6), None, "a circle has none");
    }
}
