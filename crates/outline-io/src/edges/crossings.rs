//! Places where points that moved onto their edges have changed their order.
use nalgebra::Point2;

/// Segments of a small loop, whose points are put in a row again; wider ones are two parts of the line that cross.
const LOOP: usize = 8;

/// Points to either side of a crossing that go back to where they were.
const AROUND: usize = 4;

/// Rounds in which small loops are straightened, and rounds after which all points go back.
const ROUNDS: [usize; 2] = [3, 7];

/// Twice the area of a triangle, in square pixels, below which its corners lie on one line.
const ON_ONE_LINE: f64 = 1e-9;

/// What has become of a line that was moved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Moved {
    /// All of its points are where they were moved to.
    Everywhere,
    /// Some are elsewhere.
    NotEverywhere,
}

/// Undoes the crossings of a closed line that has been moved, until it crosses itself nowhere; it did not before it was moved. Where neighbours
/// have passed each other they are put in a row between those around them, and elsewhere points go back to where they were.
pub(super) fn undo_crossings(before: &[Point2<f64>], moved: &mut [Point2<f64>]) -> Moved {
    let count = moved.len();
    for round in 0..ROUNDS[1] {
        let crossing = crossing_segments(moved);
        if crossing.is_empty() {
            return if round == 0 { Moved::Everywhere } else { Moved::NotEverywhere };
        }
        for pair in crossing {
            match loop_between(pair, count) {
                Some((from, length)) if round < ROUNDS[0] => straighten(moved, from, length),
                _ => pair.into_iter().for_each(|segment| put_back(before, moved, segment)),
            }
        }
    }
    if !crossing_segments(moved).is_empty() {
        moved.copy_from_slice(before);
    }
    Moved::NotEverywhere
}

/// The first segment of the small loop that two make which cross, and how many it has after that.
fn loop_between([i, j]: [usize; 2], count: usize) -> Option<(usize, usize)> {
    let [on, back] = [(j + count - i) % count, (i + count - j) % count];
    let (from, length) = if on < back { (i, on) } else { (j, back) };
    (length <= LOOP && 2 * length < count).then_some((from, length))
}

/// Puts the points of a loop in a row, evenly spaced.
fn straighten(moved: &mut [Point2<f64>], from: usize, length: usize) {
    let count = moved.len();
    let (first, last) = (moved[from], moved[(from + length + 1) % count]);
    for k in 1..=length {
        moved[(from + k) % count] = first + (last - first) * (k as f64 / (length + 1) as f64);
    }
}

fn put_back(before: &[Point2<f64>], moved: &mut [Point2<f64>], segment: usize) {
    let count = moved.len();
    for k in 0..=2 * AROUND + 1 {
        let at = (segment + count + k - AROUND.min(count)) % count;
        moved[at] = before[at];
    }
}

/// The pairs of segments, by their first points, that cross.
fn crossing_segments(points: &[Point2<f64>]) -> Vec<[usize; 2]> {
    let count = points.len();
    let ends = |i: usize| (points[i], points[(i + 1) % count]);
    // Segments that cross have a cell of the grid in common. Those of a cell are beside each other once all are sorted.
    let mut cells: Vec<(i32, i32, usize)> = Vec::with_capacity(2 * count);
    for i in 0..count {
        let (a, b) = ends(i);
        let range = |p: f64, q: f64| (p.min(q).floor() as i32)..=(p.max(q).floor() as i32);
        cells.extend(range(a.x, b.x).flat_map(|x| range(a.y, b.y).map(move |y| (x, y, i))));
    }
    cells.sort_unstable();
    let mut crossing = Vec::new();
    for of_cell in cells.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        for (k, &(_, _, i)) in of_cell.iter().enumerate() {
            for &(_, _, j) in &of_cell[..k] {
                let is_next = j == i || j + 1 == i || (j == 0 && i + 1 == count);
                if !is_next && do_cross(ends(i), ends(j)) {
                    crossing.push([j, i]);
                }
            }
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
        assert!(crossing_segments(&points).is_empty());
    }

    fn circle(radius: f64, k: usize) -> Point2<f64> {
        let angle = std::f64::consts::TAU * k as f64 / 60.0;
        Point2::new(20.0 + radius * angle.cos(), 20.0 + radius * angle.sin())
    }

    #[test]
    fn neighbours_that_have_passed_each_other_are_put_in_a_row_and_others_stay() {
        let before: Vec<_> = (0..60).map(|k| circle(8.0, k)).collect();
        let mut moved: Vec<_> = (0..60).map(|k| circle(7.0, k)).collect();
        moved.swap(10, 12);
        assert_eq!(undo_crossings(&before, &mut moved), Moved::NotEverywhere);
        assert!(crossing_segments(&moved).is_empty());
        assert!((moved[11] - circle(7.0, 11)).norm() < 0.2, "{}", moved[11]);
        assert_eq!(moved[40], circle(7.0, 40));
    }

    #[test]
    fn parts_of_a_line_that_cross_go_back_there_and_stay_moved_elsewhere() {
        let before: Vec<_> = (0..60).map(|k| circle(8.0, k)).collect();
        let mut moved: Vec<_> = (0..60).map(|k| circle(8.3, k)).collect();
        // Beyond the other side.
        moved[10] = circle(-9.0, 10);
        assert_eq!(undo_crossings(&before, &mut moved), Moved::NotEverywhere);
        assert!(crossing_segments(&moved).is_empty());
        assert_eq!((moved[10], moved[25]), (before[10], circle(8.3, 25)));
    }
}
