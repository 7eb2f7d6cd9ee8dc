//! Points measured side by side in the lanes of the processor, with few branches: affine poses, and points that count alike.
//!
//! In one pose a cell is a straight line in the image. What the points need to know of it is found once for each cell.
use freeform_riccati::{MotionModel, ParameterVector, map_point_by, pull_back_by};
use nalgebra::{Matrix3, Point2, Vector2};

use super::{
    CellLine, Columns, Frame, Jacobians, Lies, Measurement, NO_CELL, Pass, Piece, View,
    association::mean_of_neighbours, hidden::hide_points_of_pieces,
};
use crate::{
    map::{NullDirection, OutlineMap},
    tuning::measurement as tuning,
    vectors::{LANES, Lanes, vectorised},
};

impl View<'_> {
    /// The vectorised way of [`measure_one_by_one`](Self::measure_one_by_one), for affine poses and points that count alike; a test compares the two.
    pub(crate) fn measure_side_by_side(
        &self,
        frame: &mut Frame,
        inverse: &Matrix3<f64>,
        half_window: usize,
        pass: Pass,
    ) {
        let map = self.map;
        let Frame { points, values, shifts, pieces, places, columns, .. } = frame;
        let count = points.len();
        columns.make_room(count, map.cells().len());
        places.resize(count, Point2::origin());
        if pass == Pass::First && half_window == 0 {
            columns.weights.fill(0.0);
        }
        // Slices are near at hand in a loop, vectors are looked up each time.
        let (points, places) = (points.as_slice(), places.as_mut_slice());
        let Columns { own_places, lines, of_cells, own_lines, .. } = columns;
        let (own_places, lines) = (own_places.as_mut_slice(), lines.as_mut_slice());
        let by_offsets_of_cells = of_cells.by_offsets.as_mut_slice();
        let own_lines = own_lines.as_mut_slice();
        vectorised(
            #[inline(always)]
            || {
                write_lines(self, inverse, shifts, (lines, by_offsets_of_cells, own_lines));
                for (place, p) in own_places.iter_mut().zip(points.iter()) {
                    *place = map_point_by::<true>(inverse, p);
                }
            },
        );
        if half_window == 0 {
            places.copy_from_slice(own_places);
            columns.associate(map);
        } else {
            if pass == Pass::First {
                // What the points count with in the means.
                columns.associate(map);
                self.weigh_side_by_side(points, columns, values, pass);
            }
            columns.write_means_of_counted(pieces, places, half_window);
            columns.associate(map);
        }
        self.keep_to_sides(columns.numbers_and_weights(), pieces, places, half_window);
        self.weigh_side_by_side(points, columns, values, pass);
        if map.has_ends() {
            columns.leave_out_hidden(pieces);
        }
        let Columns { numbers, by_offsets, of_cells, .. } = columns;
        let by_offsets_of_cells = of_cells.by_offsets.as_slice();
        for (by_offset, number) in by_offsets.iter_mut().zip(numbers.iter()) {
            *by_offset = by_offsets_of_cells[*number as usize];
        }
    }

    /// Measurements of all points that have been measured side by side, with their Jacobians, null directions projected out.
    pub(crate) fn write_measurements(&self, frame: &mut Frame, null: &[NullDirection]) {
        let Frame { points, measurements, columns, .. } = frame;
        columns.jacobians = Jacobians::OfPoints;
        measurements.resize(points.len(), Measurement::NOTHING);
        let columns = &*columns;
        vectorised(
            #[inline(always)]
            || match self.belief.model {
                MotionModel::Rigid => {
                    write_jacobians(points, columns, measurements, |p, n| MotionModel::Rigid.normal_velocities(p, n));
                }
                MotionModel::Similarity => {
                    let velocities =
                        |p: &Point2<f64>, n: &Vector2<f64>| MotionModel::Similarity.normal_velocities(p, n);
                    write_jacobians(points, columns, measurements, velocities);
                }
                MotionModel::Affine => {
                    write_jacobians(points, columns, measurements, |p, n| MotionModel::Affine.normal_velocities(p, n));
                }
                MotionModel::Projective => {
                    let velocities =
                        |p: &Point2<f64>, n: &Vector2<f64>| MotionModel::Projective.normal_velocities(p, n);
                    write_jacobians(points, columns, measurements, velocities);
                }
            },
        );
        for direction in null {
            measurements.iter_mut().for_each(|m| direction.project_out(&mut m.jacobian));
        }
    }

    /// Residuals, and Tukey's weights.
    fn weigh_side_by_side(&self, points: &[Point2<f64>], columns: &mut Columns, values: &mut Vec<f64>, pass: Pass) {
        let sigma = self.noise.sigma;
        let near = vectorised(
            #[inline(always)]
            || write_residuals_and_weights(points, columns, sigma),
        );
        if (near as f64) < tuning::NEAR_ENOUGH * points.len() as f64 {
            let Columns { numbers, residuals, weights, lines, .. } = columns;
            values.clear();
            let none = (lines.len() - 1) as u32;
            let known = residuals.iter().zip(numbers.iter()).filter(|(_, number)| **number != none);
            values.extend(known.map(|(residual, _)| residual.abs()));
            let (scale, share) = self.scale_of_wide_frame(values, pass);
            for ((weight, residual), number) in weights.iter_mut().zip(residuals.iter()).zip(numbers.iter()) {
                *weight = weight_of(*residual, lines[*number as usize].0[3], 1.0 / scale) * share;
            }
        }
    }
}

impl Columns {
    /// Makes room for so many points, measured side by side with so many cells.
    fn make_room(&mut self, points: usize, cells: usize) {
        let Self { own_places, weighted, rows, numbers, residuals, weights, by_offsets, along, .. } = self;
        numbers.resize(points, 0);
        for column in [residuals, weights, by_offsets, along] {
            column.resize(points, 0.0);
        }
        own_places.resize(points, Point2::origin());
        weighted.resize(points, [0.0; LANES]);
        rows.resize(points, [0.0; LANES]);
        self.lines.resize(cells + 1, CellLine::NONE);
        self.of_cells.by_offsets.resize(cells + 1, 0.0);
        self.own_lines.resize(cells + 1, 0.0);
        self.jacobians = Jacobians::OfCells;
    }

    /// Takes the cells off points that are parts of hidden arcs, which are those of the pieces.
    fn leave_out_hidden(&mut self, pieces: &[Piece]) {
        let none = (self.lines.len() - 1) as u32;
        let lies = |columns: &Self, i: usize| Lies::of(columns.numbers[i] == none, columns.weights[i] > 0.0);
        hide_points_of_pieces(self, pieces, lies, |columns, i| {
            (columns.numbers[i], columns.residuals[i]) = (none, 0.0);
        });
    }

    /// Finds the cells nearest to the places of the points in the body frame.
    #[expect(
        clippy::map_clone,
        reason = "`copied` may become a function by itself, made for the least of all processors"
    )]
    fn associate(&mut self, map: &OutlineMap) {
        let (own_places, numbers) = (self.own_places.as_slice(), self.numbers.as_mut_slice());
        vectorised(
            #[inline(always)]
            || {
                let places = own_places.iter().map(
                    #[inline(always)]
                    |place| *place,
                );
                map.associate(places, numbers);
            },
        );
    }

    /// Means of neighbours of all points as places, and in the body frame those of the points that count, in place of these.
    fn write_means_of_counted(&mut self, pieces: &[Piece], places: &mut [Point2<f64>], half_window: usize) {
        let Self { own_places, weighted, weights, .. } = self;
        let (own_places, weighted) = (own_places.as_mut_slice(), weighted.as_mut_slice());
        vectorised(
            #[inline(always)]
            || {
                for (weighted, (q, weight)) in weighted.iter_mut().zip(own_places.iter().zip(weights.iter())) {
                    *weighted = [weight * q.x, weight * q.y, *weight, 0.0];
                }
                for piece in pieces {
                    let range = piece.range();
                    let (weighted, own) = (&weighted[range.clone()], &own_places[range.clone()]);
                    let places = &mut places[range];
                    if piece.closed {
                        write_means(weighted, half_window, own, places);
                        continue;
                    }
                    mean_of_neighbours(
                        weighted.len(),
                        #[inline(always)]
                        |i| weighted[i],
                        false,
                        half_window,
                        #[inline(always)]
                        |i, mean| places[i] = mean.unwrap_or(own[i]),
                    );
                }
                // The means where the points count, the points where they do not.
                for ((own, place), weight) in own_places.iter_mut().zip(places.iter()).zip(weights.iter()) {
                    *own = if *weight > 0.0 { *place } else { *own };
                }
            },
        );
    }
}

/// As [`mean_of_neighbours`], which a test compares it with, along a closed piece; the point itself where its neighbours count for nothing.
#[inline(always)]
fn write_means(weighted: &[Lanes], half_window: usize, own: &[Point2<f64>], places: &mut [Point2<f64>]) {
    let count = weighted.len();
    let w = half_window.min((count - 1) / 2);
    let mut sum = [0.0; LANES];
    for more in weighted[count - w..].iter().chain(&weighted[..=w]) {
        (0..LANES).for_each(|c| sum[c] += more[c]);
    }
    let mean = |sum: &Lanes, own: &Point2<f64>| {
        let [x, y, weight, _] = *sum;
        let inverse = 1.0 / weight;
        if weight > tuning::LEAST_WEIGHT { Point2::new(x * inverse, y * inverse) } else { *own }
    };
    places[0] = mean(&sum, &own[0]);
    // Points that come into the window and that leave it: at the start, and at the end, over the other end.
    let parts = [
        (1..w + 1, &weighted[w + 1..], &weighted[count - w..]),
        (w + 1..count - w, &weighted[2 * w + 1..], weighted),
        (count - w..count, weighted, &weighted[count - 2 * w - 1..]),
    ];
    for (range, coming, leaving) in parts {
        let of_points = places[range.clone()].iter_mut().zip(&own[range]);
        for ((place, own), (more, less)) in of_points.zip(coming.iter().zip(leaving)) {
            (0..LANES).for_each(|c| sum[c] += more[c] - less[c]);
            *place = mean(&sum, own);
        }
    }
}

/// What every cell is to the points in a pose, given by its inverse, with corrections of the offsets.
#[inline(always)]
fn write_lines(
    view: &View<'_>,
    inverse: &Matrix3<f64>,
    shifts: &[f64],
    (lines, by_offsets, own_lines): (&mut [CellLine], &mut [f64], &mut [f64]),
) {
    let (cells, offsets) = (view.map.cells(), &view.belief.offsets);
    let (origin, away) = (Point2::origin(), map_point_by::<true>(inverse, &Point2::origin()));
    let inflations = view.noise.inflations();
    let of_lines = lines.iter_mut().zip(own_lines.iter_mut()).zip(inflations);
    for (((line, own), inflation), ((cell, offset), shift)) in of_lines.zip(cells.iter().zip(offsets).zip(shifts)) {
        let pulled = pull_back_by::<true>(inverse, &origin, &away, &cell.normal);
        *own = cell.normal.dot(&(cell.centre - away));
        let at = *own + offset + shift;
        *line = CellLine([pulled.x, pulled.y, at, inflation]);
    }
    // Roots and quotients in vectors.
    let of_lines = lines.iter_mut().zip(own_lines.iter_mut());
    for ((CellLine([x, y, at, of_points]), own), by_offset) in of_lines.zip(by_offsets.iter_mut()) {
        // A unit step along the image normal moves the body point by |D' n| along n.
        let scale = 1.0 / (*x * *x + *y * *y).sqrt();
        (*x, *y, *at, *own) = (*x * scale, *y * scale, *at * scale, *own * scale);
        *of_points = (1.0 / *of_points).sqrt();
        *by_offset = scale;
    }
    lines[cells.len()] = CellLine::NONE;
    by_offsets[cells.len()] = 0.0;
    own_lines[cells.len()] = 0.0;
}

/// Distances of points from the lines of their cells, coordinates along these, and Tukey's weights for a deviation; how many of the points are
/// near.
#[inline(always)]
fn write_residuals_and_weights(points: &[Point2<f64>], columns: &mut Columns, sigma: f64) -> u64 {
    let (limit, scale) = (tuning::FULL_WEIGHT * sigma, 1.0 / sigma);
    let Columns { numbers, residuals, weights, along, lines, rows, .. } = columns;
    let (lines, rows) = (lines.as_slice(), rows.as_mut_slice());
    // What lies anywhere is looked up first: the loop after that runs in vectors.
    for (row, number) in rows.iter_mut().zip(numbers.iter()) {
        *row = lines[*number as usize].0;
    }
    let mut near = 0;
    let found = residuals.iter_mut().zip(along.iter_mut().zip(weights.iter_mut()));
    for ((residual, (along, weight)), (p, [x, y, at, inverse])) in found.zip(points.iter().zip(rows.iter())) {
        let off = x * p.x + y * p.y - at;
        *residual = off;
        *along = x * p.y - y * p.x;
        near += u64::from(off.abs() < limit);
        *weight = weight_of(off, *inverse, scale);
    }
    near
}

/// What a point with a residual counts for, by the inverse deviation of the points of its cell and the inverse of a deviation of all.
#[inline(always)]
fn weight_of(residual: f64, inverse: f64, scale: f64) -> f64 {
    tukeys_weight(residual * (inverse * scale)) * (inverse * inverse)
}

/// Tukey's weight of a residual in deviations.
#[inline(always)]
fn tukeys_weight(residual: f64) -> f64 {
    let excess = (residual.abs() - tuning::FULL_WEIGHT) * (1.0 / (tuning::NO_WEIGHT - tuning::FULL_WEIGHT));
    let beyond = if excess > 0.0 { excess } else { 0.0 };
    let kept = 1.0 - beyond * beyond;
    if excess < 1.0 { kept * kept } else { 0.0 }
}

/// The Jacobians of all points, and measurements of all that was found: the normal velocities that each parameter of the pose error gives the
/// feet of the points.
#[inline(always)]
fn write_jacobians(
    points: &[Point2<f64>],
    columns: &Columns,
    measurements: &mut [Measurement],
    velocities: impl Fn(&Point2<f64>, &Vector2<f64>) -> ParameterVector,
) {
    let lines = columns.lines.as_slice();
    let none = lines.len() - 1;
    for (measurement, (p, found)) in measurements.iter_mut().zip(points.iter().zip(columns.points())) {
        let line = &lines[found.cell];
        let normal = line.normal();
        let foot = p - (found.residual + line.at() - columns.own_lines[found.cell]) * normal;
        *measurement = Measurement {
            cell: if found.cell == none { NO_CELL } else { found.cell },
            residual: found.residual,
            by_offset: found.by_offset,
            jacobian: velocities(&foot, &normal),
            weight: found.weight,
        };
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    #[test]
    fn means_along_a_closed_piece_are_those_of_the_plain_way_bit_for_bit() {
        let mut rng = ChaCha8Rng::seed_from_u64(8);
        for (count, half_window) in [(1, 3), (2, 1), (3, 1), (4, 7), (5, 2), (9, 4), (40, 3), (41, 20), (41, 30)] {
            let mut draw = || rng.random_range(-1.0..1.0);
            let own: Vec<_> = (0..count).map(|_| Point2::new(draw(), draw())).collect();
            let weight = |i: usize| f64::from(u8::from(!(10..30).contains(&i)));
            let weighted: Vec<_> =
                own.iter().enumerate().map(|(i, q)| [weight(i) * q.x, weight(i) * q.y, weight(i), 0.0]).collect();
            let mut found = vec![Point2::origin(); count];
            write_means(&weighted, half_window, &own, &mut found);
            let mut expected = found.clone();
            let take = |i: usize, mean: Option<Point2<f64>>| expected[i] = mean.unwrap_or(own[i]);
            mean_of_neighbours(count, |i| weighted[i], true, half_window, take);
            assert_eq!(found, expected, "{count} {half_window}");
        }
    }
}
