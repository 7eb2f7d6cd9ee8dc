use super::crossing_share;
use super::walk::{Grid, Node, Step};

/// Crossings keep this distance from the samples, in sample spacings, so that an isoline never touches itself there.
const SAMPLE_CLEARANCE: f64 = 1e-4;

/// A point where an isoline crosses the line between two neighbouring samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// Distance from the first column to the right, in sample spacings.
    pub x: f64,
    /// Distance from the first row downwards, in sample spacings.
    pub y: f64,
    /// Whether the isoline has been closed here along the edge of the grid, half a spacing beyond its last samples.
    pub at_edge: bool,
}

/// All isolines of the samples of a grid of `[columns, rows]` at a level, each a closed line whose first crossing is not
/// repeated; none where all samples are below it. `value` gives the sample in a column and row, counted from 0.
///
/// What is at or above the level is on the left, seen with rows downwards as in a picture: lines around it run
/// counter-clockwise there, lines around its holes clockwise. Every line starts where it leads into the inside from the
/// row before, and lines come in the order in which their starts are met row by row. Crossings are interpolated linearly
/// between samples. The grid is taken as surrounded by samples below any level. Where two opposite corners of a cell are
/// inside and two are not, the inside corners are joined: the inside is connected over corners, as in 8-connected
/// components. Values that are not numbers are below any level.
pub fn of_samples([columns, rows]: [usize; 2], value: impl Fn(usize, usize) -> f64, level: f64) -> Vec<Vec<Crossing>> {
    // A margin of one node stands for what surrounds the grid: no line leaves it.
    let sample = |[column, row]: Node| {
        let (x, y) = (usize::try_from(column - 1).ok()?, usize::try_from(row - 1).ok()?);
        (x < columns && y < rows).then(|| value(x, y))
    };
    let is_inside = |node: Node| sample(node).is_some_and(|value| value >= level);
    let grid = Grid { columns: columns + 2, rows: rows + 2, is_inside, joins_inside: |_| true };
    // Every closed line has a first row, where it leads into the inside from the row before.
    let starts = (1..=rows as i64).flat_map(|row| (1..=columns as i64).map(move |column| [column, row]));
    let starts = starts.map(|inside| Step { left: [inside[0], inside[1] - 1], right: inside });
    let lines = grid.lines(starts.filter(|start| is_inside(start.right)));

    let crossing = |Step { left: outside, right: inside }: &Step| {
        let (share, at_edge) = match (sample(*inside), sample(*outside)) {
            (Some(inside), Some(outside)) => (crossing_share(inside, outside, level, SAMPLE_CLEARANCE), false),
            _ => (0.5, true),
        };
        let [x, y] = [0, 1].map(|k| (inside[k] - 1) as f64 + share * (outside[k] - inside[k]) as f64);
        Crossing { x, y, at_edge }
    };
    lines.iter().map(|line| line.steps.iter().map(crossing).collect()).collect()
}

/// Area within a closed line of [`of_samples`], in squares of the sample spacing: positive with the inside within, negative
/// for a hole.
#[must_use]
pub fn signed_area(line: &[Crossing]) -> f64 {
    let next = line.iter().cycle().skip(1);
    // The minus sign turns rows upwards.
    -0.5 * line.iter().zip(next).map(|(p, q)| p.x * q.y - p.y * q.x).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn lines_of(rows: &[&[f64]], level: f64) -> Vec<Vec<Crossing>> {
        of_samples([rows[0].len(), rows.len()], |x, y| rows[y][x], level)
    }

    #[test]
    fn corners_that_touch_are_joined() {
        assert_eq!(lines_of(&[&[1.0, 0.0], &[0.0, 1.0]], 0.5).len(), 1);
        assert_eq!(lines_of(&[&[0.0, 1.0], &[1.0, 0.0]], 0.5).len(), 1);
    }

    #[test]
    fn a_hole_has_negative_area() {
        let ring: [&[f64]; 5] =
            [&[0.0; 5], &[0.0, 1.0, 1.0, 1.0, 0.0], &[0.0, 1.0, 0.0, 1.0, 0.0], &[0.0, 1.0, 1.0, 1.0, 0.0], &[0.0; 5]];
        let areas: Vec<f64> = lines_of(&ring, 0.5).iter().map(|line| signed_area(line)).collect();
        assert_eq!(areas, [8.5, -0.5]);
    }

    #[test]
    fn a_grid_that_is_all_inside_is_closed_along_its_edge() {
        let lines = lines_of(&[&[1.0, 1.0], &[1.0, 1.0]], 0.5);
        assert_eq!(lines.len(), 1);
        assert!(lines[0].iter().all(|crossing| crossing.at_edge));
        assert_eq!(signed_area(&lines[0]), 3.5);
    }

    #[test]
    fn samples_that_are_not_numbers_are_outside_and_give_no_crossing_that_is_not_one() {
        let lines = lines_of(&[&[f64::NAN, 1.0, f64::INFINITY, f64::NEG_INFINITY]], 0.5);
        assert_eq!(lines.len(), 1);
        assert!(lines[0].iter().all(|crossing| crossing.x.is_finite() && crossing.y.is_finite()));
        assert_eq!((lines[0][0].x, lines[0][0].y), (1.0, -0.5));
    }

    #[test]
    fn a_grid_without_samples_has_no_isoline() {
        assert_eq!(of_samples([0, 0], |_, _| 1.0, 0.5), Vec::<Vec<Crossing>>::new());
        assert_eq!(of_samples([3, 0], |_, _| 1.0, 0.5), Vec::<Vec<Crossing>>::new());
    }

    proptest! {
        #[test]
        fn isolines_are_simple_and_enclose_every_sample_inside(
            values in (1..9_usize, 1..9_usize).prop_flat_map(|(w, h)|
                prop::collection::vec(prop::collection::vec((0..5_u8).prop_map(f64::from), w), h)),
        ) {
            let lines = of_samples([values[0].len(), values.len()], |x, y| values[y][x], 2.0);
            for (y, row) in values.iter().enumerate() {
                for (x, value) in row.iter().enumerate() {
                    let winding: i32 = lines.iter().map(|line| winding(line, x as f64, y as f64)).sum();
                    prop_assert_eq!(winding, i32::from(*value >= 2.0));
                }
            }
            let segments: Vec<_> = lines.iter()
                .flat_map(|line| line.iter().zip(line.iter().cycle().skip(1)))
                .collect();
            for (index, a) in segments.iter().enumerate() {
                for b in &segments[..index] {
                    prop_assert!(!cross(*a, *b), "{a:?} {b:?}");
                }
            }
        }
    }

    /// Times the line goes round a point, counter-clockwise with y upwards.
    fn winding(line: &[Crossing], x: f64, y: f64) -> i32 {
        let mut count = 0;
        for (p, q) in line.iter().zip(line.iter().cycle().skip(1)) {
            // A point to the right of the ray's start, the ray running to the right along the row.
            let rises = p.y > y && q.y <= y;
            let falls = p.y <= y && q.y > y;
            let at = p.x + (y - p.y) / (q.y - p.y) * (q.x - p.x);
            if (rises || falls) && at > x {
                count += if rises { 1 } else { -1 };
            }
        }
        count
    }

    /// Whether two segments cross at a point within both.
    fn cross((a, b): (&Crossing, &Crossing), (c, d): (&Crossing, &Crossing)) -> bool {
        let side = |p: &Crossing, q: &Crossing, r: &Crossing| (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
        side(a, b, c) * side(a, b, d) < -1e-18 && side(c, d, a) * side(c, d, b) < -1e-18
    }
}
