use std::collections::HashMap;

use nalgebra::Point2;

/// Points to either side of a crossing that go back to where they were.
const AROUND: usize = 4;

/// Rounds after which all points go back.
const ROUNDS: usize = 4;

/// Twice the area of a triangle, in square pixels, below which its corners lie on one line.
const ON_ONE_LINE: f64 = 1e-9;

/// Puts points of a closed line that have been moved back to where they were, near places where the line crosses itself, until it does
/// so nowhere; it did not before it was moved.
pub(super) fn undo_crossings(before: &[Point2<f64>], moved: &mut [Point2<f64>]) {
    let count = moved.len();
    for _ in 0..ROUNDS {
        let crossing = crossing_segments(moved);
        if crossing.is_empty() {
            return;
        }
        for segment in crossing {
            for k in 0..=2 * AROUND + 1 {
                let at = (segment + count + k - AROUND.min(count)) % count;
                moved[at] = before[at];
            }
        }
    }
    if !crossing_segments(moved).is_empty() {
        moved.copy_from_slice(before);
    }
}

/// The segments, by their first points, that others cross.
fn crossing_segments(points: &[Point2<f64>]) -> Vec<usize> {
    let count = points.len();
    let ends = |i: usize| (points[i], points[(i + 1) % count]);
    let mut cells: HashMap<(i32, i32), Vec<usize>> = HashMap::new();
    let mut crossing = Vec::new();
    for i in 0..count {
        let (a, b) = ends(i);
        let range = |p: f64, q: f64| (p.min(q).floor() as i32)..=(p.max(q).floor() as i32);
        for cell in range(a.x, b.x).flat_map(|x| range(a.y, b.y).map(move |y| (x, y))) {
            let others = cells.entry(cell).or_default();
            for &j in others.iter() {
                let is_next = j == i || (j + 1) % count == i || (i + 1) % count == j;
                if !is_next && do_cross((a, b), ends(j)) {
                    crossing.extend([i, j]);
                }
            }
            others.push(i);
        }
    }
    crossing.sort_unstable();
    crossing.dedup();
    crossing
}

fn do_cross((a, b): (Point2<f64>, Point2<f64>), (c, d): (Point2<f64>, Point2<f64>)) -> bool {
    // Points on one line are on neither side, however they are rounded.
    let side = |p: Point2<f64>, q: Point2<f64>, r: Point2<f64>| {
        let doubled = (q - p).perp(&(r - p));
        if doubled.abs() < ON_ONE_LINE { 0.0 } else { doubled }
    };
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_on_one_line_do_not_cross() {
        let along = |k: usize| Point2::new(10.0 + 0.37 * k as f64, 20.0 + 0.37 * k as f64);
        let mut points: Vec<_> = (0..40).map(along).collect();
        points.extend([Point2::new(24.8, 20.0), Point2::new(10.0, 20.0 - 1e-3)]);
        assert_eq!(crossing_segments(&points), Vec::<usize>::new());
    }

    #[test]
    fn a_line_that_crosses_itself_goes_back_there_and_stays_moved_elsewhere() {
        let circle = |radius: f64, k: usize| {
            let angle = std::f64::consts::TAU * k as f64 / 60.0;
            Point2::new(20.0 + radius * angle.cos(), 20.0 + radius * angle.sin())
        };
        let before: Vec<_> = (0..60).map(|k| circle(8.0, k)).collect();
        let mut moved: Vec<_> = (0..60).map(|k| circle(8.3, k)).collect();
        moved.swap(10, 12);
        undo_crossings(&before, &mut moved);
        assert!(crossing_segments(&moved).is_empty());
        assert_eq!(moved[11], before[11]);
        assert_eq!(moved[40], circle(8.3, 40));
    }
}
