//! The map drawn anew where many frames have shown the outline to be.
use std::sync::Arc;

use nalgebra::Vector2;

use super::OutlineMap;
use crate::tuning::redrawing as tuning;

impl OutlineMap {
    /// The same cells where their offsets put the outline, with normals across the places of their neighbours, whose deviation along their
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
        let centres: Vec<_> = map.cells.iter().map(|cell| cell.centre).collect();
        map.field.build(&centres, map.spacing);
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
                let [one, other] = self.cells[at].neighbours;
                let next = if one == before { other } else { one };
                // An end has itself for a neighbour.
                *side = if next == at { [at, number] } else { [at, next] };
            }
        }
    }
}
