//! Points measured side by side in the lanes of the processor, with few branches: affine poses, and points that count alike.
//!
//! In one pose a cell is a straight line in the image. What the points need to know of it is found once for each cell.
use freeform_riccati::{MotionModel, ParameterVector, map_point_by, pull_back_by};
use nalgebra::{Matrix3, Point2, Vector2};

use super::{Frame, Measurement, NO_CELL, Pass, Piece, View, association::mean_of_neighbours};
use crate::{
    map::NullDirection,
    tuning::measurement as tuning,
    vectors::{LANES, Lanes, vectorised},
};

/// The outline at a cell in the image of one frame.
#[derive(Debug, Clone, Copy)]
struct CellLine {
    normal: Vector2<f64>,
    /// Where it lies along the normal.
    at: f64,
    by_offset: f64,
    /// Of the points of the cell, over that of the noise: the inverse deviation, and its square.
    inverse_deviation: f64,
    share: f64,
}

impl CellLine {
    /// Of a point without a cell: it has no distance and does not count.
    const NONE: Self =
        Self { normal: Vector2::new(0.0, 0.0), at: 0.0, by_offset: 0.0, inverse_deviation: 1.0, share: 0.0 };
}

/// Numbers of the points of a frame, by columns; buffers that are reused from frame to frame.
#[derive(Debug, Clone, Default)]
pub(crate) struct Columns {
    /// The points in the body frame; in the end the means of their neighbours where they count.
    own_places: Vec<Point2<f64>>,
    /// Coordinates in the body frame times weights, and these; a fourth number, which is none, makes it a whole vector.
    weighted: Vec<Lanes>,
    /// Of the cells; the number of cells for none.
    numbers: Vec<u32>,
    residuals: Vec<f64>,
    weights: Vec<f64>,
    /// Of every cell, and one for none.
    lines: Vec<CellLine>,
}

impl View<'_> {
    /// The vectorised way of [`measure_one_by_one`](Self::measure_one_by_one), for affine poses and points that count alike; a test compares the two.
    pub(crate) fn measure_side_by_side(
        &self,
        frame: &mut Frame,
        inverse: &Matrix3<f64>,
        half_window: usize,
        null: &[NullDirection],
        pass: Pass,
    ) {
        let map = self.map;
        let Frame { points, measurements, values, shifts, pieces, places, columns, .. } = frame;
        columns.make_room(points.len(), map.cells().len());
        places.resize(points.len(), Point2::origin());
        let Columns { own_places, weighted, numbers, residuals, weights, lines } = columns;
        match pass {
            Pass::First if half_window == 0 => weights.fill(0.0),
            // They will be found.
            Pass::First => {}
            Pass::Again => weights.iter_mut().zip(measurements.iter()).for_each(|(weight, m)| *weight = m.weight),
        }
        // Slices are near at hand in a loop, vectors are looked up each time.
        let (own_places, places, weighted) =
            (own_places.as_mut_slice(), places.as_mut_slice(), weighted.as_mut_slice());
        let (numbers, residuals, weights) = (numbers.as_mut_slice(), residuals.as_mut_slice(), weights.as_mut_slice());
        let (points, lines) = (points.as_slice(), lines.as_mut_slice());
        vectorised(
            #[inline(always)]
            || {
                write_lines(self, inverse, shifts, lines);
                for (place, p) in own_places.iter_mut().zip(points.iter()) {
                    *place = map_point_by::<true>(inverse, p);
                }
            },
        );
        if half_window == 0 {
            places.copy_from_slice(own_places);
            vectorised(
                #[inline(always)]
                || map.associate(places.iter().copied(), numbers),
            );
        } else {
            if pass == Pass::First {
                // What the points count with in the means.
                vectorised(
                    #[inline(always)]
                    || map.associate(own_places.iter().copied(), numbers),
                );
                self.weigh_side_by_side((points, numbers, lines), (residuals, weights), values, pass);
            }
            vectorised(
                #[inline(always)]
                || {
                    write_places((pieces, half_window), (weights, weighted), own_places, places);
                    map.associate(own_places.iter().copied(), numbers);
                },
            );
        }
        self.keep_to_sides((numbers, weights), pieces, places, half_window);
        self.weigh_side_by_side((points, numbers, lines), (residuals, weights), values, pass);
        let found = Found { points, numbers, residuals, weights, lines };
        vectorised(
            #[inline(always)]
            || found.write_jacobians_of(self.belief.model, measurements),
        );
        for direction in null {
            measurements.iter_mut().for_each(|m| direction.project_out(&mut m.jacobian));
        }
    }

    /// Residuals, and Tukey's weights.
    fn weigh_side_by_side(
        &self,
        (points, numbers, lines): (&[Point2<f64>], &[u32], &[CellLine]),
        (residuals, weights): (&mut [f64], &mut [f64]),
        values: &mut Vec<f64>,
        pass: Pass,
    ) {
        let sigma = self.noise.sigma;
        let near = vectorised(
            #[inline(always)]
            || write_residuals_and_weights((points, numbers, lines), (residuals, weights), sigma),
        );
        if (near as f64) < tuning::NEAR_ENOUGH * points.len() as f64 {
            values.clear();
            let none = (lines.len() - 1) as u32;
            let known = residuals.iter().zip(numbers).filter(|(_, number)| **number != none);
            values.extend(known.map(|(residual, _)| residual.abs()));
            let (scale, share) = self.scale_of_wide_frame(values, pass);
            for ((weight, residual), number) in weights.iter_mut().zip(residuals.iter()).zip(numbers) {
                *weight = weight_of(*residual, &lines[*number as usize], 1.0 / scale) * share;
            }
        }
    }
}

/// Weighs points in the body frame, and writes the means of their neighbours in `places`, and in their own place where they count.
#[inline(always)]
fn write_places(
    (pieces, half_window): (&[Piece], usize),
    (weights, weighted): (&[f64], &mut [Lanes]),
    own_places: &mut [Point2<f64>],
    places: &mut [Point2<f64>],
) {
    for (weighted, (q, weight)) in weighted.iter_mut().zip(own_places.iter().zip(weights)) {
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
    for ((own, place), weight) in own_places.iter_mut().zip(places.iter()).zip(weights) {
        *own = if *weight > 0.0 { *place } else { *own };
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
fn write_lines(view: &View<'_>, inverse: &Matrix3<f64>, shifts: &[f64], lines: &mut [CellLine]) {
    let (cells, offsets) = (view.map.cells(), &view.belief.offsets);
    let (origin, away) = (Point2::origin(), map_point_by::<true>(inverse, &Point2::origin()));
    for (number, (line, ((cell, offset), shift))) in
        lines.iter_mut().zip(cells.iter().zip(offsets).zip(shifts)).enumerate()
    {
        // A unit step along the image normal moves the body point by |D' n| along n.
        let pulled = pull_back_by::<true>(inverse, &origin, &away, &cell.normal);
        let by_offset = 1.0 / pulled.norm();
        let at = cell.normal.dot(&(cell.centre - away)) + offset + shift;
        let share = 1.0 / view.noise.inflation(number);
        *line = CellLine {
            normal: pulled * by_offset,
            at: at * by_offset,
            by_offset,
            inverse_deviation: share.sqrt(),
            share,
        };
    }
    lines[cells.len()] = CellLine::NONE;
}

/// Distances of points from the lines of their cells, and Tukey's weights for a deviation; how many of the points are near.
#[inline(always)]
fn write_residuals_and_weights(
    (points, numbers, lines): (&[Point2<f64>], &[u32], &[CellLine]),
    (residuals, weights): (&mut [f64], &mut [f64]),
    sigma: f64,
) -> usize {
    let (limit, scale) = (tuning::FULL_WEIGHT * sigma, 1.0 / sigma);
    let mut near = [0.0; LANES];
    let (residuals, last_residuals) = residuals.as_chunks_mut::<LANES>();
    let (weights, last_weights) = weights.as_chunks_mut::<LANES>();
    let (points, last_points) = points.as_chunks::<LANES>();
    let (numbers, last_numbers) = numbers.as_chunks::<LANES>();
    for ((residuals, weights), (points, numbers)) in residuals.iter_mut().zip(weights).zip(points.iter().zip(numbers)) {
        let lines: [&CellLine; LANES] = std::array::from_fn(|lane| &lines[numbers[lane] as usize]);
        let [x, y, at]: [Lanes; 3] =
            [lines.map(|line| line.normal.x), lines.map(|line| line.normal.y), lines.map(|line| line.at)];
        let [inverse, of_cell]: [Lanes; 2] = [lines.map(|line| line.inverse_deviation), lines.map(|line| line.share)];
        for lane in 0..LANES {
            let residual = x[lane] * points[lane].x + y[lane] * points[lane].y - at[lane];
            residuals[lane] = residual;
            near[lane] += if residual.abs() < limit { 1.0 } else { 0.0 };
            weights[lane] = tukeys_weight(residual * (inverse[lane] * scale)) * of_cell[lane];
        }
    }
    let mut all: f64 = near.iter().sum();
    let last = last_points.iter().zip(last_numbers);
    for ((residual, weight), (p, number)) in last_residuals.iter_mut().zip(last_weights).zip(last) {
        let line = &lines[*number as usize];
        *residual = line.normal.x * p.x + line.normal.y * p.y - line.at;
        all += if residual.abs() < limit { 1.0 } else { 0.0 };
        *weight = weight_of(*residual, line, scale);
    }
    all as usize
}

/// What a point with a residual counts for, by the inverse of a deviation.
#[inline(always)]
fn weight_of(residual: f64, line: &CellLine, scale: f64) -> f64 {
    tukeys_weight(residual * (line.inverse_deviation * scale)) * line.share
}

/// Tukey's weight of a residual in deviations.
#[inline(always)]
fn tukeys_weight(residual: f64) -> f64 {
    let excess = (residual.abs() - tuning::FULL_WEIGHT) * (1.0 / (tuning::NO_WEIGHT - tuning::FULL_WEIGHT));
    let beyond = if excess > 0.0 { excess } else { 0.0 };
    let kept = 1.0 - beyond * beyond;
    if excess < 1.0 { kept * kept } else { 0.0 }
}

/// What has been found of the points of a frame.
struct Found<'a> {
    points: &'a [Point2<f64>],
    numbers: &'a [u32],
    residuals: &'a [f64],
    weights: &'a [f64],
    lines: &'a [CellLine],
}

impl Found<'_> {
    /// [`write_jacobians`](Self::write_jacobians) of a model, which is known before the loop over the points.
    #[inline(always)]
    fn write_jacobians_of(&self, model: MotionModel, measurements: &mut [Measurement]) {
        match model {
            MotionModel::Rigid => {
                self.write_jacobians(measurements, |p, n| MotionModel::Rigid.normal_velocities(p, n));
            }
            MotionModel::Similarity => {
                self.write_jacobians(measurements, |p, n| MotionModel::Similarity.normal_velocities(p, n));
            }
            MotionModel::Affine => {
                self.write_jacobians(measurements, |p, n| MotionModel::Affine.normal_velocities(p, n));
            }
            MotionModel::Projective => {
                self.write_jacobians(measurements, |p, n| MotionModel::Projective.normal_velocities(p, n));
            }
        }
    }

    /// The Jacobians of all points, and measurements of all that was found: the normal velocities that each parameter of the pose error gives the
    /// feet of the points.
    #[inline(always)]
    fn write_jacobians(
        &self,
        measurements: &mut [Measurement],
        velocities: impl Fn(&Point2<f64>, &Vector2<f64>) -> ParameterVector,
    ) {
        let none = (self.lines.len() - 1) as u32;
        let of_points = self.points.iter().zip(self.numbers).zip(self.residuals.iter().zip(self.weights));
        for (measurement, ((p, number), (residual, weight))) in measurements.iter_mut().zip(of_points) {
            let line = &self.lines[*number as usize];
            let foot = p - *residual * line.normal;
            *measurement = Measurement {
                cell: if *number == none { NO_CELL } else { *number as usize },
                residual: *residual,
                by_offset: line.by_offset,
                jacobian: velocities(&foot, &line.normal),
                weight: *weight,
            };
        }
    }
}

impl Columns {
    /// Room for so many points and cells.
    fn make_room(&mut self, points: usize, cells: usize) {
        self.own_places.resize(points, Point2::origin());
        self.weighted.resize(points, [0.0; LANES]);
        self.numbers.resize(points, 0);
        self.residuals.resize(points, 0.0);
        self.weights.resize(points, 0.0);
        self.lines.resize(cells + 1, CellLine::NONE);
    }

    /// Sets the cells to those of measurements, with their weights.
    pub(super) fn set_cells(&mut self, measurements: &[Measurement]) {
        self.numbers.clear();
        self.numbers.extend(measurements.iter().map(|m| if m.cell == NO_CELL { u32::MAX } else { m.cell as u32 }));
        self.weights.clear();
        self.weights.extend(measurements.iter().map(|m| m.weight));
    }

    /// The numbers of the cells, to be changed, and the weights.
    pub(super) fn numbers_and_weights(&mut self) -> (&mut [u32], &[f64]) {
        (&mut self.numbers, &self.weights)
    }

    /// Gives measurements their cells back.
    pub(super) fn hand_cells_back(&self, measurements: &mut [Measurement]) {
        for (measurement, number) in measurements.iter_mut().zip(&self.numbers).filter(|(m, _)| m.cell != NO_CELL) {
            measurement.cell = *number as usize;
        }
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
