//! The map drawn anew where many frames have shown the outline to be.
use std::sync::Arc;

use nalgebra::Vector2;

use super::OutlineMap;
use crate::tuning::redrawing as tuning;

impl OutlineMap {
    /// The cells moved to where their offsets put the outline, with normals across the places of their neighbours, whose deviation along their
    /// normals is `noise`: offsets from this map are none.
    ///
    /// Normals come from a few frames, and a normal that errs takes part of what slides along the outline for a displacement. Places that
    /// many frames have shown tell them better.
    pub(crate) fn redrawn(&self, offsets: &[f64], noise: f64) -> Arc<Self> {
        let mut map = self.clone();
        for (cell, offset) in map.cells.iter_mut().zip(offsets) {
            cell.centre += *offset * cell.normal;
        }
        let reach = self.reach(noise);
        let normals: Vec<Vector2<f64>> = (0..map.cells.len()).map(|number| map.normal_across(number, reach)).collect();
        map.cells.iter_mut().zip(normals).for_each(|(cell, normal)| cell.normal = normal);
        map.prepare_association();
        Arc::new(map)
    }

    /// Neighbours on either side that make a normal exact enough.
    fn reach(&self, noise: f64) -> usize {
        // Sum of the squares of -n to n, which the slope of a line through evenly spaced places has its variance from.
        let squares = |n: usize| (n * (n + 1) * (2 * n + 1)) as f64 / 3.0;
        let is_enough = |n: &usize| noise <= tuning::NORMAL_NOISE * self.spacing * squares(*n).sqrt();
        (1..tuning::MOST_NEIGHBOURS).find(is_enough).unwrap_or(tuning::MOST_NEIGHBOURS)
    }

    /// Curvature of the outline at every cell: where it lies `t` along from the middle of a cell, it is `curvature t^2 / 2` off along the
    /// normal. 0 at ends.
    pub(crate) fn curvatures(&self) -> Vec<f64> {
        (0..self.cells.len()).map(|number| self.curvature(number)).collect()
    }

    fn curvature(&self, number: usize) -> f64 {
        let cell = &self.cells[number];
        let tangent = Vector2::new(-cell.normal.y, cell.normal.x);
        // The parabola of least squares through the places about the cell.
        let mut places = vec![(0.0, 0.0)];
        self.walk(number, tuning::NEIGHBOURS_OF_CURVATURE, |_, pair| {
            places.extend(pair.map(|other| {
                let apart = self.cells[other].centre - cell.centre;
                (tangent.dot(&apart), cell.normal.dot(&apart))
            }));
        });
        let count = places.len() as f64;
        let mean = places.iter().map(|(t, _)| t * t).sum::<f64>() / count;
        let (along, squares) = places.iter().fold((0.0, 0.0), |(along, squares), (t, z)| {
            let lever = t * t - mean;
            (along + lever * z, squares + lever * lever)
        });
        if squares > 0.0 { 2.0 * along / squares } else { 0.0 }
    }

    /// Normal of the line through the places of a cell's neighbours, so many on either side, where there are.
    fn normal_across(&self, number: usize, reach: usize) -> Vector2<f64> {
        let cell = &self.cells[number];
        let mut slope = Vector2::zeros();
        self.walk(number, reach, |steps, [a, b]| {
            slope += steps as f64 * (self.cells[a].centre - self.cells[b].centre);
        });
        let normal = Vector2::new(-slope.y, slope.x);
        let length = normal.norm();
        if length > 0.0 { normal * (normal.dot(&cell.normal).signum() / length) } else { cell.normal }
    }

    /// Walks from a cell both ways as long as there are cells on both sides: windows that are not symmetric would take a bend for a slope.
    fn walk(&self, number: usize, reach: usize, mut visit: impl FnMut(usize, [usize; 2])) {
        let cell = &self.cells[number];
        let mut sides = [[number, number]; 2];
        for (side, first) in sides.iter_mut().zip(cell.neighbours) {
            side[1] = first;
        }
        for steps in 1..=reach {
            let [[_, a], [_, b]] = sides;
            if a == b || a == number || b == number {
                break;
            }
            visit(steps, [a, b]);
            for side in &mut sides {
                let [before, at] = *side;
                let next = self.cells[at].beyond(before);
                *side = if next == at { [at, number] } else { [at, next] };
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Point2;

    use super::*;
    use crate::map::{Cell, nearest_field::NearestField, null_space::NullSpace};

    /// Cells around a circle, or along three quarters of it, whose normals are off by up to a twentieth.
    fn circle(radius: f64, count: usize, closed: bool) -> OutlineMap {
        let spacing = std::f64::consts::TAU * radius / count as f64;
        let number_of_cells = if closed { count } else { 3 * count / 4 };
        let cells = (0..number_of_cells)
            .map(|i| {
                let angle = std::f64::consts::TAU * i as f64 / count as f64;
                let off = angle + 0.05 * (7.0 * i as f64).sin();
                let neighbours = match (closed, i) {
                    (true, _) => [(i + count - 1) % count, (i + 1) % count],
                    (false, 0) => [0, 1],
                    (false, _) if i + 1 == number_of_cells => [i - 1, i],
                    (false, _) => [i - 1, i + 1],
                };
                let centre = Point2::new(radius * angle.cos(), radius * angle.sin());
                Cell { centre, normal: Vector2::new(off.cos(), off.sin()), neighbours }
            })
            .collect();
        OutlineMap {
            cells,
            field: NearestField::default(),
            bisectors: Vec::new(),
            has_ends: false,
            spacing,
            half_window: 2,
            step: spacing,
            most_seen: 0,
            null_space: NullSpace::default(),
            levers: None,
        }
    }

    #[test]
    fn a_map_drawn_anew_lies_where_the_offsets_put_it_with_the_normals_and_the_bend_of_the_outline() {
        for closed in [true, false] {
            let map = circle(2.0, 200, closed);
            let cells = map.cells().len();
            let drawn = map.redrawn(&vec![0.01; cells], 1e-3);
            for (number, (cell, curvature)) in drawn.cells().iter().zip(drawn.curvatures()).enumerate() {
                assert!((cell.centre.coords.norm() - 2.01).abs() < 1e-4);
                let is_inside = closed || (6..cells - 6).contains(&number);
                let off = cell.normal.perp(&cell.centre.coords.normalize()).abs();
                // Neighbours that were moved along normals that are off tell a little less.
                assert!(cell.normal.dot(&cell.centre.coords) > 0.0 && (!is_inside || off < 4e-3), "{number}: {off}");
                assert!(!is_inside || (curvature + 1.0 / 2.01).abs() < 0.02, "{number}: {curvature}");
                assert_eq!(drawn.nearest(&cell.centre), Some(number));
            }
            // An end has no neighbours on both sides, and keeps what it had.
            if !closed {
                assert_eq!((drawn.cells()[0].normal, drawn.curvatures()[0]), (map.cells()[0].normal, 0.0));
            }
        }
    }

    #[test]
    fn more_neighbours_are_asked_where_places_are_less_certain() {
        let map = circle(2.0, 200, true);
        let reach = [1e-5, 1e-3, 3e-3, 1.0].map(|noise| map.reach(noise));
        assert!(reach.is_sorted() && reach[0] == 1 && reach[3] == tuning::MOST_NEIGHBOURS, "{reach:?}");
    }
}
