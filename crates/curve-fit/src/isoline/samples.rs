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
pub fn of_samples(size: [usize; 2], value: impl Fn(usize, usize) -> f64, level: f64) -> Vec<Vec<Crossing>> {
    let of_row = |y: usize, inside: &mut [bool]| {
        inside.iter_mut().enumerate().for_each(|(x, inside)| *inside = value(x, y) >= level);
    };
    let samples = Samples { size, value: &value, of_row, level };
    let lines = samples.grid().lines(samples.starts());
    lines.iter().map(|line| line.steps.iter().map(|step| samples.crossing(*step)).collect()).collect()
}

/// A line would have more crossings than are wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("an isoline has more than {most} points")]
pub struct LineTooLong {
    /// Most crossings that were asked for.
    pub most: usize,
}

/// The lines of an object among those of [`of_samples`].
#[derive(Debug, Clone, PartialEq)]
pub struct LargestLines {
    /// The one with the largest [`signed_area`], the last of several.
    pub outer: Vec<Crossing>,
    /// Lines around holes, which have a negative area, the largest first.
    pub holes: Vec<Vec<Crossing>>,
}

/// Which holes are wanted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WantedHoles {
    /// The area that they enclose at least, in squares of the sample spacing.
    pub smallest: f64,
    /// How many at most.
    pub count: usize,
}

/// Of the lines of [`of_samples`], for samples row by row, the largest, and those of the largest holes that do not run along the edge of the
/// grid; `None` if there is no line. Nothing is kept of the others, of which there may be as many as samples.
///
/// # Errors
/// A line, one of these or another, has more than `most` crossings, or those of the holes have together.
///
/// # Panics
/// There are fewer samples than columns times rows.
pub fn largest_of_samples(
    size: [usize; 2],
    samples: &[f32],
    level: f64,
    wanted: WantedHoles,
    most: usize,
) -> Result<Option<LargestLines>, LineTooLong> {
    let [columns, rows] = size;
    let samples = &samples[..columns * rows];
    // As numbers of the samples' own size more of them are compared side by side.
    let least = least_at(level);
    let of_row = |y: usize, inside: &mut [bool]| {
        let of_row = &samples[y * columns..(y + 1) * columns];
        inside.iter_mut().zip(of_row).for_each(|(inside, sample)| *inside = *sample >= least);
    };
    let value = |x: usize, y: usize| f64::from(samples[y * columns + x]);
    let samples = Samples { size, value, of_row, level };
    let mut outer: Option<Summary> = None;
    let mut holes: Vec<Summary> = Vec::new();
    for line in samples.summaries(most) {
        let line = line?;
        if outer.is_none_or(|before| before.area.total_cmp(&line.area).is_le()) {
            outer = Some(line);
        }
        if line.area < 0.0 && -line.area >= wanted.smallest && !line.is_at_edge {
            let place = holes.partition_point(|before| before.area <= line.area);
            holes.insert(place, line);
            holes.truncate(wanted.count);
        }
    }
    if holes.iter().map(|line| line.crossings).sum::<usize>() > most {
        return Err(LineTooLong { most });
    }
    let Some(outer) = outer.map(|line| samples.line(line.start)) else { return Ok(None) };
    Ok(Some(LargestLines { outer, holes: holes.into_iter().map(|line| samples.line(line.start)).collect() }))
}

/// What is kept of a line that has been passed.
#[derive(Debug, Clone, Copy)]
struct Summary {
    start: Step,
    /// Its [`signed_area`].
    area: f64,
    crossings: usize,
    /// Whether any crossing is where the line was closed along the edge of the grid.
    is_at_edge: bool,
}

/// Samples of a grid and a level. A margin of one node stands for what surrounds the grid: no line leaves it.
struct Samples<V, R> {
    /// Columns and rows.
    size: [usize; 2],
    value: V,
    /// Says of all samples of a row whether they are inside.
    of_row: R,
    level: f64,
}

impl<V: Fn(usize, usize) -> f64, R: Fn(usize, &mut [bool])> Samples<V, R> {
    fn sample(&self, [column, row]: Node) -> Option<f64> {
        let (x, y) = (usize::try_from(column - 1).ok()?, usize::try_from(row - 1).ok()?);
        (x < self.size[0] && y < self.size[1]).then(|| (self.value)(x, y))
    }

    fn is_inside(&self, node: Node) -> bool {
        self.sample(node).is_some_and(|value| value >= self.level)
    }

    fn grid(&self) -> Grid<impl Fn(Node) -> bool, impl Fn(Node) -> bool> {
        let [columns, rows] = self.size;
        Grid { columns: columns + 2, rows: rows + 2, is_inside: |node| self.is_inside(node), joins_inside: |_| true }
    }

    /// All lines, one after the other; an error for one of more crossings than `most`.
    fn summaries(&self, most: usize) -> impl Iterator<Item = Result<Summary, LineTooLong>> {
        let grid = self.grid();
        let mut passed = grid.nothing_passed();
        self.starts().filter_map(move |start| {
            if !grid.begins_a_line(&passed, start) {
                return None;
            }
            let (mut crossings, mut is_at_edge) = (0, false);
            let steps = grid.steps_from(start).take(most.saturating_add(1));
            let area = signed_area_of(steps.map(|step| {
                let crossing = self.crossing(step);
                passed.mark(grid.index(step));
                crossings += 1;
                is_at_edge |= crossing.at_edge;
                crossing
            }));
            let line = Summary { start, area, crossings, is_at_edge };
            Some(if crossings > most { Err(LineTooLong { most }) } else { Ok(line) })
        })
    }

    /// The line that begins with a step.
    fn line(&self, start: Step) -> Vec<Crossing> {
        self.grid().steps_from(start).map(|step| self.crossing(step)).collect()
    }

    /// Steps into the inside from the row before: every closed line has a first row, where it has one. Most samples have none, so that
    /// those of a row are looked at side by side.
    fn starts(&self) -> impl Iterator<Item = Step> {
        let [columns, rows] = self.size;
        let (mut inside, mut enters) = (vec![false; columns], vec![false; columns]);
        let entries = (0..rows).flat_map(move |y| {
            enters.copy_from_slice(&inside);
            (self.of_row)(y, &mut inside);
            enters.iter_mut().zip(&inside).for_each(|(enters, inside)| *enters = *inside && !*enters);
            let is_empty = !enters.contains(&true);
            let of_row: Vec<usize> = if is_empty { Vec::new() } else { (0..columns).filter(|&x| enters[x]).collect() };
            of_row.into_iter().map(move |x| [x, y])
        });
        entries.map(|[x, y]| {
            let inside = [x as i64 + 1, y as i64 + 1];
            Step { left: [inside[0], inside[1] - 1], right: inside }
        })
    }

    fn crossing(&self, Step { left: outside, right: inside }: Step) -> Crossing {
        let (share, at_edge) = match (self.sample(inside), self.sample(outside)) {
            (Some(inside), Some(outside)) => (crossing_share(inside, outside, self.level, SAMPLE_CLEARANCE), false),
            _ => (0.5, true),
        };
        let [x, y] = [0, 1].map(|k| (inside[k] - 1) as f64 + share * (outside[k] - inside[k]) as f64);
        Crossing { x, y, at_edge }
    }
}

/// The least number that is not below a level.
fn least_at(level: f64) -> f32 {
    let nearest = level as f32;
    if f64::from(nearest) < level { nearest.next_up() } else { nearest }
}

/// Area within a closed line of [`of_samples`], in squares of the sample spacing: positive with the inside within, negative
/// for a hole.
#[must_use]
pub fn signed_area(line: &[Crossing]) -> f64 {
    signed_area_of(line.iter().copied())
}

fn signed_area_of(mut line: impl Iterator<Item = Crossing>) -> f64 {
    let Some(first) = line.next() else { return 0.0 };
    let twice = |p: Crossing, q: Crossing| p.x * q.y - p.y * q.x;
    let (sum, last) = line.fold((0.0, first), |(sum, p), q| (sum + twice(p, q), q));
    // The minus sign turns rows upwards.
    -0.5 * (sum + twice(last, first))
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
    fn samples_are_at_a_level_or_beyond_it_as_numbers_of_either_size() {
        for level in [0.5, 0.1, 1.0 / 3.0, 127.5, 100.1, 1e-3, -0.7] {
            let least = least_at(level);
            assert!(f64::from(least) >= level && f64::from(least.next_down()) < level, "{level}");
        }
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
            let found = |count: usize, most: usize| {
                let (size, wanted) = ([values[0].len(), values.len()], WantedHoles { smallest: 1.0, count });
                let samples: Vec<f32> = values.iter().flatten().map(|value| *value as f32).collect();
                largest_of_samples(size, &samples, 2.0, wanted, most)
            };
            let largest = lines.iter().max_by(|a, b| signed_area(a).total_cmp(&signed_area(b)));
            let is_hole =
                |line: &&Vec<Crossing>| signed_area(line) <= -1.0 && line.iter().all(|crossing| !crossing.at_edge);
            let mut holes: Vec<Vec<Crossing>> = lines.iter().filter(is_hole).cloned().collect();
            holes.sort_by(|a, b| signed_area(a).total_cmp(&signed_area(b)));
            let longest = lines.iter().map(Vec::len).max().unwrap_or(0);
            let most = longest.max(holes.iter().map(Vec::len).sum());
            let all = |count: usize| {
                largest.map(|outer| LargestLines { outer: outer.clone(), holes: holes[..holes.len().min(count)].to_vec() })
            };
            prop_assert_eq!(found(100, most), Ok(all(100)));
            prop_assert_eq!(found(100, most.saturating_sub(1)).is_ok(), most == 0);
            prop_assert_eq!(found(1, longest), Ok(all(1)));
            prop_assert_eq!(found(0, longest), Ok(all(0)));
            prop_assert_eq!(found(0, longest.saturating_sub(1)).is_ok(), longest == 0);
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
