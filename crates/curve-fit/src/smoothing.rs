//! A moving mean along an outline.
use nalgebra::{Point2, Vector2};

use crate::outline::Piece;

/// Half of the window in parts of the points of the outline. A window of an eighth of a radian of a circle takes 0.2 % off its radius, and
/// 0.73 of the noise of 400 points: what was three times the distance of neighbours comes below it, so that arc lengths mean something.
const PARTS: usize = 50;

/// Appends the points of a piece of an outline of so many points in all, each a mean of its neighbours with weights that fall evenly to
/// both sides, to `out`. Towards the ends of an open piece the window becomes narrower; the ends stay where they are.
pub(crate) fn smooth(piece: Piece<'_>, total: usize, out: &mut Vec<Point2<f64>>) {
    let Piece { points, closed } = piece;
    let count = points.len();
    let widest = (total / PARTS).min(count.saturating_sub(1) / 2);
    out.extend((0..count).map(|i| {
        let half = if closed { widest } else { widest.min(i).min(count - 1 - i) };
        let weight = |k: usize| (half + 1 - k) as f64;
        let sides = (1..=half).map(|k| {
            let (before, after) = ((i + count - k) % count, (i + k) % count);
            weight(k) * (points[before].coords + points[after].coords)
        });
        let sum = sides.sum::<Vector2<f64>>() + weight(0) * points[i].coords;
        Point2::from(sum / (weight(0) * weight(0)))
    }));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn smoothed(points: &[Point2<f64>], closed: bool) -> Vec<Point2<f64>> {
        let mut out = Vec::new();
        smooth(Piece { points, closed }, points.len(), &mut out);
        out
    }

    #[test]
    fn a_circle_stays_a_circle_of_nearly_the_same_radius() {
        let angle = |k: i32| std::f64::consts::TAU * f64::from(k) / 400.0;
        let circle: Vec<_> = (0..400).map(|k| Point2::new(angle(k).cos(), angle(k).sin())).collect();
        for p in smoothed(&circle, true) {
            assert!((p.coords.norm() - 0.9984).abs() < 1e-4, "{p}");
        }
    }

    #[test]
    fn a_straight_arc_keeps_its_points_and_its_ends() {
        let line: Vec<_> = (0..300).map(|k| Point2::new(f64::from(k), 2.0 * f64::from(k))).collect();
        for (p, q) in line.iter().zip(smoothed(&line, false)) {
            assert!((p - q).norm() < 1e-10, "{p} {q}");
        }
    }

    #[test]
    fn noise_to_and_fro_is_taken_off() {
        let jagged: Vec<_> = (0..400).map(|k| Point2::new(f64::from(k), f64::from(k % 2))).collect();
        for p in &smoothed(&jagged, false)[10..390] {
            assert!((p.y - 0.5).abs() < 0.01, "{p}");
        }
    }

    #[test]
    fn a_few_points_are_left_alone() {
        let three = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(x, y)| Point2::new(x, y));
        assert_eq!(smoothed(&three, true), three);
    }
}
