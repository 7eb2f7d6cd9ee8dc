use nalgebra::Point2;

use super::crossing_share;
use super::walk::{Grid, Line, Node, Step};
use crate::rectangle::Rectangle;

/// Steps of false position on each edge of a cell that the line crosses.
const REFINEMENTS: usize = 3;

/// The lines `f = 0` within a rectangle, closed ones with their first point repeated: those that leave it first, from edge
/// to edge, then the closed ones, each group in the order in which they are met row by row from below.
///
/// `cells` is the number of cells along the longer side of the rectangle, which are as nearly square as whole numbers of
/// them are; f is evaluated once at each of their corners, and three times for every crossing. What is smaller than a cell
/// may be missed. Points lie on the edges of the cells and for a smooth f on the zero set to a small fraction of the cell:
/// each step of false position reduces the error in proportion to the curvature of f within the cell. Values that are not
/// numbers count as positive. No lines where the rectangle is a point or not finite, or `cells` is 0.
pub fn of_function(f: impl Fn(&Point2<f64>) -> f64, within: &Rectangle, cells: usize) -> Vec<Vec<Point2<f64>>> {
    let row = |xs: &[f64], y: f64, values: &mut [f64]| {
        values.iter_mut().zip(xs).for_each(|(value, x)| *value = f(&Point2::new(*x, y)));
    };
    of_rows(row, &f, within, cells)
}

/// As [`of_function`], with the values at the corners of the cells from `row`: those of f at all these x and one y.
pub(crate) fn of_rows(
    row: impl Fn(&[f64], f64, &mut [f64]),
    f: impl Fn(&Point2<f64>) -> f64,
    within: &Rectangle,
    cells: usize,
) -> Vec<Vec<Point2<f64>>> {
    let size = within.size();
    let cell = size.max() / cells as f64;
    if !(cell > 0.0 && cell.is_finite()) {
        return Vec::new();
    }
    let count = |length: f64| ((length / cell).ceil() as usize).clamp(1, cells);
    let (columns, rows) = (count(size.x), count(size.y));
    let xs: Vec<f64> = (0..=columns).map(|column| within.low.x + size.x * column as f64 / columns as f64).collect();
    let ys: Vec<f64> = (0..=rows).map(|row| within.low.y + size.y * row as f64 / rows as f64).collect();
    let mut values = vec![0.0; xs.len() * ys.len()];
    values.chunks_exact_mut(xs.len()).zip(&ys).for_each(|(values, y)| row(&xs, *y, values));
    let inside: Vec<bool> = values.iter().map(|value| *value < 0.0).collect();

    let position = |[column, row]: Node| Point2::new(xs[column as usize], ys[row as usize]);
    let index = |[column, row]: Node| row as usize * xs.len() + column as usize;
    let value = |node: Node| values[index(node)];
    let joins_inside = |cell: Node| corners(cell).map(value).iter().sum::<f64>() < 0.0;
    let grid = Grid { columns: xs.len(), rows: ys.len(), is_inside: |node| inside[index(node)], joins_inside };

    let crossing = |step: &Step| {
        let [from, to] = step.ascending();
        refined_crossing((position(from), value(from)), (position(to), value(to)), &f)
    };
    let points = |line: Line| {
        let first = line.steps.first().filter(|_| line.closed);
        line.steps.iter().chain(first).map(crossing).collect()
    };
    grid.lines(starts(columns, rows, &inside)).into_iter().map(points).collect()
}

/// Corners of a cell, counter-clockwise from the one of the lowest column and row.
fn corners([column, row]: Node) -> [Node; 4] {
    [[column, row], [column + 1, row], [column + 1, row + 1], [column, row + 1]]
}

/// Steps into the grid over its edge, then over the right side of every cell that a line passes: the cell in which a closed line
/// is first met, row by row, is entered or left there, since all cells to its left and below are free of the line.
fn starts(columns: usize, rows: usize, inside: &[bool]) -> impl Iterator<Item = Step> {
    let (last_column, last_row) = (columns - 1, rows - 1);
    let over_edge = (0..rows).flat_map(move |row| {
        let step = if row == 0 || row == last_row { 1 } else { last_column.max(1) };
        (0..columns).step_by(step).flat_map(move |column| {
            let is_at_edge = [row == 0, column == last_column, row == last_row, column == 0];
            (0..4).filter(move |&side| is_at_edge[side]).map(move |side| step_into([column as i64, row as i64], side))
        })
    });
    let nodes = columns + 1;
    let pairs = inside.chunks_exact(nodes).zip(inside.chunks_exact(nodes).skip(1)).zip(0..);
    let within = pairs.flat_map(move |((lower, upper), row)| {
        let right_sides = lower[1..].iter().zip(&upper[1..]).zip(0..);
        right_sides.filter(|((lower, upper), _)| lower != upper).map(move |(_, column)| step_into([column, row], 1))
    });
    over_edge.chain(within)
}

/// The step into a cell over its lower (0), right, upper or left (3) side.
fn step_into(cell: Node, side: usize) -> Step {
    let corners = corners(cell);
    Step { left: corners[side], right: corners[(side + 1) % 4] }
}

/// Where a function changes sign between two points.
fn refined_crossing(
    (mut from, mut from_value): (Point2<f64>, f64),
    (mut to, mut to_value): (Point2<f64>, f64),
    f: impl Fn(&Point2<f64>) -> f64,
) -> Point2<f64> {
    let secant =
        |from: &Point2<f64>, a: f64, to: &Point2<f64>, b: f64| from + (to - from) * crossing_share(a, b, 0.0, 0.0);
    for _ in 0..REFINEMENTS {
        let middle = secant(&from, from_value, &to, to_value);
        let middle_value = f(&middle);
        if (middle_value < 0.0) == (from_value < 0.0) {
            (from, from_value) = (middle, middle_value);
        } else {
            (to, to_value) = (middle, middle_value);
        }
    }
    secant(&from, from_value, &to, to_value)
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;
    use proptest::prelude::*;

    fn square(half: f64) -> Rectangle {
        Rectangle { low: Point2::new(-half, -half), high: Point2::new(half, half) }
    }

    fn ellipse(p: &Point2<f64>) -> f64 {
        p.x * p.x / 4.0 + p.y * p.y - 1.0
    }

    #[test]
    fn an_ellipse_is_one_closed_line_on_its_zero_set() {
        let lines = of_function(ellipse, &square(3.0), 160);
        assert_eq!(lines.len(), 1);
        assert_eq!(lines[0].first(), lines[0].last());
        assert!(lines[0].len() > 200);
        // Interpolation alone would leave up to 3e-4.
        for p in &lines[0] {
            assert!(ellipse(p).abs() < 1e-6, "{p}: {}", ellipse(p));
        }
    }

    #[test]
    fn a_line_that_leaves_the_rectangle_ends_at_its_edge() {
        let right_half = Rectangle { low: Point2::new(0.0, -2.0), high: Point2::new(3.0, 2.0) };
        let lines = of_function(ellipse, &right_half, 160);
        assert_eq!(lines.len(), 1);
        let (first, last) = (lines[0][0], lines[0][lines[0].len() - 1]);
        assert!(first.x == 0.0 && last.x == 0.0 && (first.y - last.y).abs() > 1.9);
    }

    #[test]
    fn branches_that_nearly_meet_in_a_cell_are_joined_as_the_function_says() {
        // Both branches of a hyperbola pass through the one cell: above and below, or left and right.
        for (constant, is_tall) in [(0.1, false), (-0.1, true)] {
            let lines = of_function(|p| p.x * p.y + constant, &square(1.0), 1);
            assert_eq!(lines.len(), 2);
            for line in lines {
                assert_eq!(line.len(), 2);
                assert_eq!((line[0].x * line[0].y > 0.0), is_tall, "{line:?}");
                assert!((line[0] - line[1]).norm() < 1.5, "{line:?}");
            }
        }
    }

    #[test]
    fn a_function_is_evaluated_once_for_each_corner_and_three_times_for_each_crossing() {
        let (by_row, by_point) = (Cell::new(0), Cell::new(0));
        let row = |xs: &[f64], y: f64, values: &mut [f64]| {
            by_row.set(by_row.get() + values.len());
            values.iter_mut().zip(xs).for_each(|(value, x)| *value = ellipse(&Point2::new(*x, y)));
        };
        let f = |p: &Point2<f64>| {
            by_point.set(by_point.get() + 1);
            ellipse(p)
        };
        let lines = of_rows(row, f, &square(3.0), 160);
        assert_eq!(by_row.get(), 161 * 161);
        // The first point is repeated as the last, and may be found again.
        let crossings = lines[0].len();
        assert!((3 * crossings - 3..=3 * crossings).contains(&by_point.get()), "{} {crossings}", by_point.get());
        assert_eq!(lines, of_function(ellipse, &square(3.0), 160));
    }

    #[test]
    fn a_rectangle_without_extent_or_cells_has_no_line() {
        assert!(of_function(ellipse, &square(0.0), 10).is_empty());
        assert!(of_function(ellipse, &square(f64::INFINITY), 10).is_empty());
        assert!(of_function(ellipse, &square(1.0), 0).is_empty());
    }

    proptest! {
        #[test]
        fn lines_pass_once_between_all_neighbours_of_different_sign_and_end_nowhere_within(
            waves in prop::collection::vec((-1.0..1.0_f64, -6.0..6.0_f64, -6.0..6.0_f64, 0.0..6.3_f64), 1..6),
            cells in 1..24_usize,
        ) {
            let f = |p: &Point2<f64>| waves.iter().map(|(a, kx, ky, phase)| a * (kx * p.x + ky * p.y + phase).sin()).sum::<f64>();
            let lines = of_function(f, &square(1.0), cells);
            let at = |k: usize| -1.0 + 2.0 * k as f64 / cells as f64;
            let inside = |column: usize, row: usize| f(&Point2::new(at(column), at(row))) < 0.0;
            let mut crossed = 0;
            for row in 0..=cells {
                for column in 0..=cells {
                    crossed += usize::from(column < cells && inside(column, row) != inside(column + 1, row));
                    crossed += usize::from(row < cells && inside(column, row) != inside(column, row + 1));
                }
            }
            let mut passed = 0;
            for line in &lines {
                let is_closed = line.len() > 2 && line.first() == line.last();
                passed += line.len() - usize::from(is_closed);
                let is_at_edge = |p: &Point2<f64>| p.coords.amax() > 1.0 - 1e-12;
                prop_assert!(is_closed || (is_at_edge(&line[0]) && is_at_edge(&line[line.len() - 1])));
                for pair in line.windows(2) {
                    prop_assert!((pair[0] - pair[1]).amax() <= 2.0 / cells as f64 + 1e-12);
                }
            }
            prop_assert_eq!(passed, crossed);
        }
    }
}
