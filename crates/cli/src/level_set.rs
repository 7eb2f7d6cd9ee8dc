//! The zero level set of a fitted polynomial as polylines, for drawing.
use std::collections::HashMap;

use freeform_motion::curve_fit::{Fit, Outline};
use nalgebra::Point2;

/// Cells along the longer side of the area that is looked at.
const CELLS: usize = 160;

/// Steps of false position on each edge of a cell that the curve crosses.
const REFINEMENTS: usize = 3;

/// An edge of the grid: from the node in this column and row, to the right or upwards.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
struct Edge {
    column: usize,
    row: usize,
    upwards: bool,
}

/// An area of the image: lower left and upper right corner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Area {
    pub(crate) low: Point2<f64>,
    pub(crate) high: Point2<f64>,
}

impl Area {
    /// The smallest that holds all points; `None` for no points.
    pub(crate) fn around<'a>(mut points: impl Iterator<Item = &'a Point2<f64>>) -> Option<Self> {
        let first = *points.next()?;
        Some(
            points.fold(Self { low: first, high: first }, |area, p| Self {
                low: area.low.inf(p),
                high: area.high.sup(p),
            }),
        )
    }

    /// Whether a point lies in it.
    pub(crate) fn contains(&self, p: &Point2<f64>) -> bool {
        p >= &self.low && p <= &self.high
    }

    /// The smallest square about the same centre that holds it.
    pub(crate) fn square(&self) -> Self {
        let half = nalgebra::Vector2::repeat(0.5 * (self.high - self.low).max());
        let centre = nalgebra::center(&self.low, &self.high);
        Self { low: centre - half, high: centre + half }
    }

    /// Wider on all sides by a share of the longer side.
    pub(crate) fn widened(&self, share: f64) -> Self {
        let size = self.high - self.low;
        let margin = nalgebra::Vector2::repeat(share * size.max());
        Self { low: self.low - margin, high: self.high + margin }
    }
}

/// The parts of the curve `f = 0` within an area, closed ones with their first point repeated: marching squares (Lorensen
/// and Cline, Marching cubes, 1987, in the plane), the crossings refined by false position.
pub(crate) fn curve_of(fit: &Fit, area: &Area) -> Vec<Vec<Point2<f64>>> {
    let normalisation = fit.normalisation();
    let value = |p: &Point2<f64>| fit.working().evaluate(&normalisation.to_working(p));
    let size = area.high - area.low;
    let cell = size.max() / CELLS as f64;
    if !(cell > 0.0 && cell.is_finite()) {
        return Vec::new();
    }
    let count = |length: f64| ((length / cell).ceil() as usize).clamp(1, CELLS);
    let (columns, rows) = (count(size.x), count(size.y));
    let node = |column: usize, row: usize| {
        Point2::new(
            area.low.x + size.x * column as f64 / columns as f64,
            area.low.y + size.y * row as f64 / rows as f64,
        )
    };
    let values: Vec<f64> = (0..=rows)
        .flat_map(|row| (0..=columns).map(move |column| (column, row)))
        .map(|(c, r)| value(&node(c, r)))
        .collect();
    let at = |column: usize, row: usize| values[row * (columns + 1) + column];

    let mut links: HashMap<Edge, Vec<Edge>> = HashMap::new();
    let mut order = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let corners = [at(column, row), at(column + 1, row), at(column + 1, row + 1), at(column, row + 1)];
            let centre = corners.iter().sum::<f64>();
            let edges = [
                Edge { column, row, upwards: false },
                Edge { column: column + 1, row, upwards: true },
                Edge { column, row: row + 1, upwards: false },
                Edge { column, row, upwards: true },
            ];
            for (a, b) in pieces(&corners, centre) {
                for (from, to) in [(edges[a], edges[b]), (edges[b], edges[a])] {
                    let neighbours = links.entry(from).or_default();
                    if neighbours.is_empty() {
                        order.push(from);
                    }
                    neighbours.push(to);
                }
            }
        }
    }

    let crossing = |edge: &Edge| {
        let Edge { column, row, upwards } = *edge;
        let (far_column, far_row) = if upwards { (column, row + 1) } else { (column + 1, row) };
        let (from, to) = (node(column, row), node(far_column, far_row));
        crossing_between((from, at(column, row)), (to, at(far_column, far_row)), value)
    };
    chains(&links, &order).iter().map(|chain| chain.iter().map(crossing).collect()).collect()
}

/// Which parts of a curve are stray: no point of the outline has its nearest part of the curve there.
pub(crate) fn stray(parts: &[Vec<Point2<f64>>], outline: &Outline) -> Vec<bool> {
    let mut stray = vec![true; parts.len()];
    for p in outline.points() {
        let distance = |part: &[Point2<f64>]| part.iter().map(|q| (q - p).norm_squared()).fold(f64::INFINITY, f64::min);
        let distances = parts.iter().map(|part| distance(part)).enumerate();
        if let Some((nearest, _)) = distances.min_by(|a, b| a.1.total_cmp(&b.1)) {
            stray[nearest] = false;
        }
    }
    stray
}

/// Middles of the stray parts of the curve of an outline that lie within two of its sizes on all sides.
pub(crate) fn stray_parts(fit: &Fit, outline: &Outline) -> Vec<Point2<f64>> {
    let Some(area) = Area::around(outline.points()) else { return Vec::new() };
    let parts = curve_of(fit, &area.widened(2.0));
    let middle =
        |part: &Vec<Point2<f64>>| Area::around(part.iter()).map(|area| nalgebra::center(&area.low, &area.high));
    let found = parts.iter().zip(stray(&parts, outline)).filter(|(_, stray)| *stray);
    found.filter_map(|(part, _)| middle(part)).collect()
}

/// Which edges of a cell are joined: edges 0 to 3 are the lower, right, upper and left one, corners go round likewise.
fn pieces(corners: &[f64; 4], centre: f64) -> impl Iterator<Item = (usize, usize)> {
    let inside = corners.map(|value| value < 0.0);
    let crossed: Vec<usize> = (0..4).filter(|&k| inside[k] != inside[(k + 1) % 4]).collect();
    let joined: [Option<(usize, usize)>; 2] = match crossed[..] {
        [a, b] => [Some((a, b)), None],
        // Two opposite corners inside: the value in the middle tells whether they are joined.
        [_, _, _, _] if (centre < 0.0) == inside[0] => [Some((0, 1)), Some((2, 3))],
        [_, _, _, _] => [Some((3, 0)), Some((1, 2))],
        _ => [None, None],
    };
    joined.into_iter().flatten()
}

/// Follows the links; open chains first, so that none is entered in its middle.
fn chains(links: &HashMap<Edge, Vec<Edge>>, order: &[Edge]) -> Vec<Vec<Edge>> {
    let mut seen = std::collections::HashSet::new();
    let ends = order.iter().filter(|edge| links[edge].len() == 1);
    let mut result = Vec::new();
    for start in ends.chain(order) {
        if !seen.insert(*start) {
            continue;
        }
        let mut chain = vec![*start];
        let mut present = *start;
        while let Some(next) = links[&present].iter().find(|next| !seen.contains(*next)) {
            seen.insert(*next);
            chain.push(*next);
            present = *next;
        }
        if links[start].len() == 2 && links[&present].contains(start) {
            chain.push(*start);
        }
        result.push(chain);
    }
    result
}

/// Where a function changes sign between two points.
fn crossing_between(
    (mut from, mut from_value): (Point2<f64>, f64),
    (mut to, mut to_value): (Point2<f64>, f64),
    value: impl Fn(&Point2<f64>) -> f64,
) -> Point2<f64> {
    let secant = |from: &Point2<f64>, a: f64, to: &Point2<f64>, b: f64| {
        let share = a / (a - b);
        from + (to - from) * if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.5 }
    };
    for _ in 0..REFINEMENTS {
        let middle = secant(&from, from_value, &to, to_value);
        let middle_value = value(&middle);
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
    use freeform_motion::curve_fit::{Degree, FitSettings, Fitter, Outline};

    use super::*;

    fn fitted_ellipse() -> Fit {
        let angle = |i: i32| std::f64::consts::TAU * f64::from(i) / 200.0;
        let points = (0..200).map(|i| Point2::new(5.0 + 2.0 * angle(i).cos(), angle(i).sin())).collect();
        let settings = FitSettings { degree: Degree::Conic, ..FitSettings::default() };
        let outline = Outline::closed(points).expect("an ellipse");
        Fitter::new(settings).expect("settings").fit(&outline).expect("a conic")
    }

    #[test]
    fn the_curve_of_an_ellipse_is_one_closed_line_on_its_zero_set() {
        let fit = fitted_ellipse();
        let area = Area { low: Point2::new(2.0, -2.0), high: Point2::new(8.0, 2.0) };
        let curve = curve_of(&fit, &area);
        assert_eq!(curve.len(), 1);
        assert_eq!(curve[0].first(), curve[0].last());
        assert!(curve[0].len() > 200);
        for p in &curve[0] {
            let value = fit.working().evaluate(&fit.normalisation().to_working(p));
            assert!(value.abs() < 1e-5, "{p}: {value}");
        }
    }

    #[test]
    fn a_curve_that_leaves_the_area_ends_at_its_edge() {
        let area = Area { low: Point2::new(5.0, -2.0), high: Point2::new(8.0, 2.0) };
        let curve = curve_of(&fitted_ellipse(), &area);
        assert_eq!(curve.len(), 1);
        let (first, last) = (curve[0][0], curve[0][curve[0].len() - 1]);
        assert!((first.x - 5.0).abs() < 1e-9 && (last.x - 5.0).abs() < 1e-9 && first != last);
    }
}
