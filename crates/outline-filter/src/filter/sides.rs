//! Which side of a thin part a point belongs to.
use freeform_riccati::map_point_by;
use nalgebra::{Matrix3, Point2};

use super::{
    map_update::Piece,
    outline_map::OutlineMap,
    reading::{NO_CELL, Reading},
};

/// Fewest points on either side that the direction of the contour is told from.
const FEWEST_NEIGHBOURS: usize = 2;
/// Share of the points whose cells must run the same way along the contour: most, or nothing can be said of the rest.
const SURE: f64 = 0.8;
/// Points before and after one that are looked at for the side it is on, in windows.
const FURTHEST: usize = 8;

/// A piece of the contour with the cells found for its points, and the window that tells its direction.
struct Course<'a, const AFFINE: bool> {
    map: &'a OutlineMap,
    inverse: &'a Matrix3<f64>,
    places: &'a [Point2<f64>],
    closed: bool,
    reach: usize,
}

impl<const AFFINE: bool> Course<'_, AFFINE> {
    /// Number of the point so many places on from point i, back where `forth` is false, if there is one.
    fn beside(&self, i: usize, steps: usize, forth: bool) -> Option<usize> {
        let count = self.places.len();
        match (self.closed, forth) {
            (true, true) => Some((i + steps) % count),
            (true, false) => Some((i + count - steps % count) % count),
            (false, true) => Some(i + steps).filter(|j| *j < count),
            (false, false) => i.checked_sub(steps),
        }
    }

    /// Positive where the contour passes point i with the normal of the cell on its right.
    fn along(&self, i: usize, cell: usize) -> f64 {
        let place = |forth| self.places[self.beside(i, self.reach, forth).unwrap_or(i)];
        let in_body = |place| map_point_by::<AFFINE>(self.inverse, &place);
        self.map.cells[cell].normal.perp(&(in_body(place(true)) - in_body(place(false))))
    }

    /// The cell nearest to point i that its neighbours lead to and that runs the right way.
    fn cell_on_side(&self, readings: &[Reading], i: usize, sign: f64) -> Option<usize> {
        let q = map_point_by::<AFFINE>(self.inverse, &self.places[i]);
        let led_to = [false, true].into_iter().filter_map(|forth| {
            let near = (1..=FURTHEST * self.reach).map_while(|steps| self.beside(i, steps, forth));
            let mut known = near.filter(|j| is_known(&readings[*j]));
            let start = known.find(|j| sign * self.along(*j, readings[*j].cell) > 0.0)?;
            let cell = self.map.nearest_from(readings[start].cell, &q);
            (sign * self.along(i, cell) > 0.0 && !self.map.is_beyond_end(cell, &q)).then_some(cell)
        });
        let distance = |cell: &usize| (self.map.cells[*cell].centre - q).norm_squared();
        led_to.min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }
}

fn is_known(reading: &Reading) -> bool {
    reading.cell != NO_CELL && reading.weight > 0.0
}

impl OutlineMap {
    /// Gives points whose cell runs against the contour one that does not, on from the cells of the points before and after them.
    /// `places` say where along the outline the points of the frame lie, which may run either way around it.
    ///
    /// Where the object is not much thicker than the noise, the nearest cell may be on the other side. The smaller one of two residuals
    /// falls less than it should as the pose comes nearer, and the information would be overrated.
    pub(crate) fn keep_to_sides<const AFFINE: bool>(
        &self,
        readings: &mut [Reading],
        pieces: &[Piece],
        places: &[Point2<f64>],
        inverse: &Matrix3<f64>,
        half_window: usize,
    ) {
        let reach = half_window.max(FEWEST_NEIGHBOURS);
        for piece in pieces {
            let readings = &mut readings[piece.range()];
            let course =
                Course::<AFFINE> { map: self, inverse, places: &places[piece.range()], closed: piece.closed, reach };
            if readings.len() <= 2 * reach {
                continue;
            }
            let (mut forth, mut total) = (0usize, 0usize);
            for (i, reading) in readings.iter().enumerate().filter(|(_, r)| is_known(r)) {
                forth += usize::from(course.along(i, reading.cell) > 0.0);
                total += 1;
            }
            let (most, sign) = if 2 * forth > total { (forth, 1.0) } else { (total - forth, -1.0) };
            if most == total || (most as f64) < SURE * total as f64 {
                continue;
            }
            for i in 0..readings.len() {
                let cell = readings[i].cell;
                if is_known(&readings[i]) && sign * course.along(i, cell) < 0.0 {
                    readings[i].cell = course.cell_on_side(readings, i, sign).unwrap_or(cell);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use freeform_curve_fit::Outline;
    use freeform_riccati::MotionModel;
    use nalgebra::Vector2;

    use super::*;
    use crate::filter::map_update::Scratch;

    /// A strip of length 1 and thickness 0.04, anticlockwise; a tenth of its upper side is `dip` lower.
    fn strip(dip: f64) -> Vec<Point2<f64>> {
        let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 0.04), (0.0, 0.04)].map(|(x, y)| Point2::new(x, y));
        let mut points = Vec::new();
        for (i, from) in corners.iter().enumerate() {
            let to = corners[(i + 1) % 4];
            let count = if i % 2 == 0 { 200 } else { 8 };
            points.extend((0..count).map(|k| from + (to - from) * f64::from(k) / f64::from(count)));
        }
        for p in points.iter_mut().filter(|p| p.y == 0.04 && (p.x - 0.45).abs() < 0.05) {
            *p -= Vector2::new(0.0, dip);
        }
        points
    }

    fn normals_of(points: Vec<Point2<f64>>) -> Vec<(Point2<f64>, Vector2<f64>)> {
        let outline = |points| Outline::closed(points).expect("an outline");
        let mut map = OutlineMap::new(MotionModel::Rigid, &outline(strip(0.0))).expect("a map");
        map.sigma = 0.05;
        map.load(&outline(points.clone()));
        let mut scratch: Scratch = std::mem::take(&mut map.scratch);
        scratch.shifts.resize(map.cells.len(), 0.0);
        map.read_points(&mut scratch, &Matrix3::identity(), &[], true);
        points.into_iter().zip(&scratch.readings).map(|(p, reading)| (p, map.cells[reading.cell].normal)).collect()
    }

    #[test]
    fn points_nearer_to_the_other_side_of_a_thin_part_stay_on_their_own_whichever_way_the_contour_runs() {
        for reversed in [false, true] {
            let mut points = strip(0.03);
            if reversed {
                points.reverse();
            }
            let middle = |p: &Point2<f64>| (p.x - 0.45).abs() < 0.04;
            let found = normals_of(points);
            let dipped: Vec<_> = found.iter().filter(|(p, _)| middle(p) && (p.y - 0.01).abs() < 1e-9).collect();
            let lower: Vec<_> = found.iter().filter(|(p, _)| middle(p) && p.y == 0.0).collect();
            assert!(dipped.len() > 10 && lower.len() > 10);
            assert!(dipped.iter().all(|(_, n)| n.y > 0.9), "reversed {reversed}: {dipped:?}");
            assert!(lower.iter().all(|(_, n)| n.y < -0.9), "reversed {reversed}");
        }
    }
}
