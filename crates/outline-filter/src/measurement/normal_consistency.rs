//! Normal-consistency check: which side of a thin part a point belongs to.
use nalgebra::Point2;

use super::{Measurement, NO_CELL, Piece, View};
use crate::{map::OutlineMap, tuning::measurement as tuning};

/// A piece of the contour with the cells found for its points, and the window that tells its direction.
struct Course<'a> {
    map: &'a OutlineMap,
    /// In the body frame.
    places: &'a [Point2<f64>],
    closed: bool,
    reach: usize,
}

impl Course<'_> {
    /// Number of the point so many places on from point i, back where `forth` is false, if there is one.
    fn beside(&self, i: usize, steps: usize, forth: bool) -> Option<usize> {
        let count = self.places.len();
        match (self.closed, forth) {
            // Most are on this side of the start; a division for each would be most of the work.
            (true, true) if i + steps < count => Some(i + steps),
            (true, true) => Some((i + steps) % count),
            (true, false) if steps <= i => Some(i - steps),
            (true, false) => Some((i + count - steps % count) % count),
            (false, true) => Some(i + steps).filter(|j| *j < count),
            (false, false) => i.checked_sub(steps),
        }
    }

    /// Positive where the contour passes point i with the normal of the cell on its right.
    fn along(&self, i: usize, cell: usize) -> f64 {
        let place = |forth| self.places[self.beside(i, self.reach, forth).unwrap_or(i)];
        self.map.cells()[cell].normal.perp(&(place(true) - place(false)))
    }

    /// The cell nearest to point i that its neighbours lead to and that runs the right way.
    fn cell_on_side(&self, measurements: &[Measurement], i: usize, sign: f64) -> Option<usize> {
        let q = self.places[i];
        let led_to = [false, true].into_iter().filter_map(|forth| {
            let near = (1..=tuning::FURTHEST_NEIGHBOUR * self.reach).map_while(|steps| self.beside(i, steps, forth));
            let mut known = near.filter(|j| is_known(&measurements[*j]));
            let start = known.find(|j| sign * self.along(*j, measurements[*j].cell) > 0.0)?;
            let cell = self.map.nearest_from(measurements[start].cell, &q);
            (sign * self.along(i, cell) > 0.0 && !self.map.is_beyond_end(cell, &q)).then_some(cell)
        });
        let distance = |cell: &usize| (self.map.cells()[*cell].centre - q).norm_squared();
        led_to.min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }
}

fn is_known(measurement: &Measurement) -> bool {
    measurement.cell != NO_CELL && measurement.weight > 0.0
}

impl View<'_> {
    /// Gives points whose cell runs against the contour one that does not, on from the cells of the points before and after them.
    /// `places` say where along the outline the points of the frame lie, in the body frame; they may run either way around it.
    ///
    /// Where the object is not much thicker than the noise, the nearest cell may be on the other side. The smaller one of two residuals
    /// falls less than it should as the pose comes nearer, and the information would be overrated.
    pub(super) fn keep_to_sides(
        &self,
        measurements: &mut [Measurement],
        pieces: &[Piece],
        places: &[Point2<f64>],
        half_window: usize,
    ) {
        let reach = half_window.max(tuning::FEWEST_NEIGHBOURS);
        for piece in pieces {
            let measurements = &mut measurements[piece.range()];
            let course = Course { map: self.map, places: &places[piece.range()], closed: piece.closed, reach };
            if measurements.len() <= 2 * reach {
                continue;
            }
            let (mut forth, mut total) = (0usize, 0usize);
            for (i, measurement) in measurements.iter().enumerate().filter(|(_, r)| is_known(r)) {
                forth += usize::from(course.along(i, measurement.cell) > 0.0);
                total += 1;
            }
            let (most, sign) = if 2 * forth > total { (forth, 1.0) } else { (total - forth, -1.0) };
            if most == total || (most as f64) < tuning::SURE_DIRECTION * total as f64 {
                continue;
            }
            for i in 0..measurements.len() {
                let cell = measurements[i].cell;
                if is_known(&measurements[i]) && sign * course.along(i, cell) < 0.0 {
                    measurements[i].cell = course.cell_on_side(measurements, i, sign).unwrap_or(cell);
                }
            }
        }
    }
}
