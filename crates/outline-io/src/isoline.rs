use crate::field::Field;

/// Crossings keep this distance from the samples, in sample spacings, so that an isoline never touches itself there.
const SAMPLE_CLEARANCE: f64 = 1e-4;

/// A point where an isoline crosses the line between two neighbouring samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Crossing {
    /// Position in sample spacings from the first sample, to the right.
    pub(crate) x: f64,
    /// The same, downwards.
    pub(crate) y: f64,
    /// Whether the isoline has been closed here along the edge of the grid, half a spacing beyond its last samples.
    pub(crate) at_edge: bool,
}

/// A sample inside (at or above the level) and a neighbour that is not; the isoline passes between them with the inside
/// on its left, seen with y upwards.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Step {
    inside: (i64, i64),
    outside: (i64, i64),
}

/// All closed isolines at a level, by marching squares (Lorensen and Cline, Marching cubes, 1987, in the plane) followed
/// from cell to cell, with linear interpolation. What is at or above the level is on the left, seen with y upwards. The
/// grid is surrounded by samples below any level. Where two opposite corners of a cell are inside and two are not, the
/// inside corners are joined: the inside is connected over corners, as in 8-connected components.
pub(crate) fn isolines(field: &Field, level: f64) -> Vec<Vec<Crossing>> {
    let mut lines = Vec::new();
    // Every closed isoline has a highest point, where a sample outside stands above one inside.
    let mut done = vec![false; field.width * field.height];
    for y in 0..field.height {
        for x in 0..field.width {
            let (column, row) = (x as i64, y as i64);
            let start = Step { inside: (column, row), outside: (column, row - 1) };
            if !done[y * field.width + x] && is_step(field, level, start) {
                lines.push(follow(field, level, start, &mut done));
            }
        }
    }
    lines
}

fn is_inside(field: &Field, level: f64, (x, y): (i64, i64)) -> bool {
    field.get(x, y).is_some_and(|value| value >= level)
}

fn is_step(field: &Field, level: f64, step: Step) -> bool {
    is_inside(field, level, step.inside) && !is_inside(field, level, step.outside)
}

fn follow(field: &Field, level: f64, start: Step, done: &mut [bool]) -> Vec<Crossing> {
    let mut line = Vec::new();
    let mut step = start;
    loop {
        let (column, row) = step.inside;
        if step.outside == (column, row - 1) {
            done[row as usize * field.width + column as usize] = true;
        }
        line.push(crossing(field, level, step));
        step = next(field, level, step);
        if step == start {
            return line;
        }
    }
}

/// Crosses one cell.
fn next(field: &Field, level: f64, step: Step) -> Step {
    let Step { inside, outside } = step;
    let (dx, dy) = (outside.0 - inside.0, outside.1 - inside.1);
    let ahead = |(x, y): (i64, i64)| (x + dy, y - dx);
    if is_inside(field, level, ahead(outside)) {
        // Also where the corner ahead of `inside` is outside: the two inside corners are joined.
        Step { inside: ahead(outside), outside }
    } else if is_inside(field, level, ahead(inside)) {
        Step { inside: ahead(inside), outside: ahead(outside) }
    } else {
        Step { inside, outside: ahead(inside) }
    }
}

fn crossing(field: &Field, level: f64, step: Step) -> Crossing {
    let ((x0, y0), (x1, y1)) = (step.inside, step.outside);
    let (part, at_edge) = match (field.get(x0, y0), field.get(x1, y1)) {
        (Some(inside), Some(outside)) => {
            let part = (inside - level) / (inside - outside);
            (part.clamp(SAMPLE_CLEARANCE, 1.0 - SAMPLE_CLEARANCE), false)
        }
        _ => (0.5, true),
    };
    let between = |from: i64, to: i64| from as f64 + part * (to - from) as f64;
    Crossing { x: between(x0, x1), y: between(y0, y1), at_edge }
}

/// Area within a closed isoline: positive with the inside within, negative for a hole.
pub(crate) fn area(line: &[Crossing]) -> f64 {
    let next = line.iter().cycle().skip(1);
    // The minus sign turns y upwards.
    -0.5 * line.iter().zip(next).map(|(p, q)| p.x * q.y - p.y * q.x).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn field(rows: &[&[f32]]) -> Field {
        Field { width: rows[0].len(), height: rows.len(), values: rows.concat() }
    }

    #[test]
    fn corners_that_touch_are_joined() {
        let lines = isolines(&field(&[&[1.0, 0.0], &[0.0, 1.0]]), 0.5);
        assert_eq!(lines.len(), 1);
        let lines = isolines(&field(&[&[0.0, 1.0], &[1.0, 0.0]]), 0.5);
        assert_eq!(lines.len(), 1);
    }

    #[test]
    fn a_hole_has_negative_area() {
        let ring = field(&[
            &[0.0; 5],
            &[0.0, 1.0, 1.0, 1.0, 0.0],
            &[0.0, 1.0, 0.0, 1.0, 0.0],
            &[0.0, 1.0, 1.0, 1.0, 0.0],
            &[0.0; 5],
        ]);
        let areas: Vec<f64> = isolines(&ring, 0.5).iter().map(|line| area(line)).collect();
        assert_eq!(areas, [8.5, -0.5]);
    }

    #[test]
    fn a_grid_that_is_all_inside_is_closed_along_its_edge() {
        let lines = isolines(&field(&[&[1.0, 1.0], &[1.0, 1.0]]), 0.5);
        assert_eq!(lines.len(), 1);
        assert!(lines[0].iter().all(|crossing| crossing.at_edge));
        assert_eq!(area(&lines[0]), 3.5);
    }

    proptest! {
        #[test]
        fn isolines_are_simple_and_enclose_every_sample_inside(
            values in (1..9_usize, 1..9_usize).prop_flat_map(|(w, h)|
                prop::collection::vec(prop::collection::vec((0..5_u8).prop_map(f32::from), w), h)),
        ) {
            let grid = Field { width: values[0].len(), height: values.len(), values: values.concat() };
            let lines = isolines(&grid, 2.0);
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
