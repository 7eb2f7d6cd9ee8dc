//! Points of a frame read off against the cells of the map.
use freeform_riccati::{MAX_PARAMETERS, ParameterVector, is_affine, map_point_by, pull_back_by};
use nalgebra::{Matrix3, Point2, Vector2};

use super::{
    arrow_information::{ArrowInformation, StateVector},
    contour::median,
    map_update::Scratch,
    outline_map::OutlineMap,
    unseen_direction::Unseen,
};

/// Residuals up to this many standard deviations count in full...
const FULL_WEIGHT: f64 = 3.0;
/// ...and beyond this many not at all, with Tukey's biweight between.
const NO_WEIGHT: f64 = 6.0;
/// With this share of the points near the prediction, their spread need not be looked at before they are weighted.
const NEAR_ENOUGH: f64 = 0.75;
/// Standard deviation that the place of a point along the outline may have, in spacings.
const PLACE_NOISE: f64 = 0.13;
/// Share of all points that the mean is taken over at most.
const WIDEST_WINDOW: f64 = 0.04;
/// Points further than this many spacings beyond a known end belong to what is not known yet.
const BEYOND_END: f64 = 0.75;

/// Without noise residuals are what straight cells leave, in spacings.
pub(crate) const CELL_ERROR: f64 = 0.1;

pub(crate) const NO_CELL: usize = usize::MAX;

/// What becomes of one point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Reading {
    /// Its cell, or `usize::MAX`.
    pub(crate) cell: usize,
    pub(crate) residual: f64,
    /// How fast the residual falls as the offset grows.
    pub(crate) slope: f64,
    pub(crate) row: ParameterVector,
    pub(crate) weight: f64,
}

impl Reading {
    const NOTHING: Self = Self { cell: NO_CELL, residual: 0.0, slope: 0.0, row: [0.0; MAX_PARAMETERS], weight: 0.0 };
}

impl OutlineMap {
    /// The cell of every point and the linearised distance from it, with robust weights.
    ///
    /// A point belongs to the cell that it was seen of, not to the nearest: noise along the outline moves a point out of a bend, so
    /// that its distance from the nearest cell is too large by about `curvature sigma^2 / 2`, which thousands of points add up.
    /// The mean of its neighbours along the contour has little of that noise, and its nearest cell is taken.
    pub(crate) fn read_points(&self, scratch: &mut Scratch, pose: &Matrix3<f64>, unseen: &[Unseen], first: bool) {
        let inverse = pose.try_inverse().unwrap_or_else(Matrix3::identity);
        let half_window = self.half_window_of_places(pose, scratch.points.len());
        if first {
            scratch.readings.clear();
            scratch.readings.resize(scratch.points.len(), Reading::NOTHING);
        }
        if is_affine(&inverse) {
            self.read_points_by::<true>(scratch, &inverse, half_window, unseen, first);
        } else {
            self.read_points_by::<false>(scratch, &inverse, half_window, unseen, first);
        }
    }

    fn read_points_by<const AFFINE: bool>(
        &self,
        scratch: &mut Scratch,
        inverse: &Matrix3<f64>,
        half_window: usize,
        unseen: &[Unseen],
        first: bool,
    ) {
        let Scratch { points, readings, values, shifts, pieces, smooth, .. } = scratch;
        smooth.clear();
        if half_window == 0 {
            smooth.extend_from_slice(points);
        } else {
            if first {
                // What the points count with in the means.
                self.find_cells::<AFFINE>(readings, inverse, points, points);
                for (reading, p) in readings.iter_mut().zip(points.iter()) {
                    self.measure::<AFFINE>(reading, p, inverse, shifts);
                }
                self.weigh(readings, values, first);
            }
            for piece in pieces.iter() {
                smooth_piece(&points[piece.range()], &readings[piece.range()], piece.closed, half_window, smooth);
            }
        }
        self.find_cells::<AFFINE>(readings, inverse, points, smooth);
        self.keep_to_sides::<AFFINE>(readings, pieces, smooth, inverse, half_window);
        for (reading, p) in readings.iter_mut().zip(points.iter()) {
            let normal = self.measure::<AFFINE>(reading, p, inverse, shifts);
            self.linearise(reading, p, &normal, unseen);
        }
        self.weigh(readings, values, first);
    }

    /// Points on either side whose mean says which cell a point belongs to: enough for the noise to be small against a cell, and few
    /// against the outline.
    fn half_window_of_places(&self, pose: &Matrix3<f64>, count: usize) -> usize {
        let scale = pose.fixed_view::<2, 2>(0, 0).determinant().abs().sqrt();
        let needed = (self.sigma / (scale * self.spacing * PLACE_NOISE)).powi(2);
        let most = count as f64 * WIDEST_WINDOW;
        (0.5 * (needed.min(most) - 1.0)).round().max(0.0) as usize
    }

    /// The cells of points, by the means of their neighbours where they count and by themselves where they do not.
    fn find_cells<const AFFINE: bool>(
        &self,
        readings: &mut [Reading],
        inverse: &Matrix3<f64>,
        points: &[Point2<f64>],
        smooth: &[Point2<f64>],
    ) {
        let body_place =
            |reading: &Reading, p, place| map_point_by::<AFFINE>(inverse, if reading.weight > 0.0 { place } else { p });
        // A first look at all of them waits for none; which way to go from there cannot be foreseen.
        for (reading, (p, place)) in readings.iter_mut().zip(points.iter().zip(smooth)) {
            reading.cell = self.field.lookup(&body_place(reading, p, place)).unwrap_or(NO_CELL);
        }
        for (reading, (p, place)) in readings.iter_mut().zip(points.iter().zip(smooth)) {
            if reading.cell != NO_CELL {
                let q = body_place(reading, p, place);
                let number = self.nearest_from(reading.cell, &q);
                reading.cell = if self.is_beyond_end(number, &q) { NO_CELL } else { number };
            }
        }
    }

    /// Tukey's weights.
    fn weigh(&self, readings: &mut [Reading], values: &mut Vec<f64>, first: bool) {
        let mut scale = self.sigma;
        let limit = FULL_WEIGHT * scale;
        let near = readings.iter().filter(|r| r.residual.abs() < limit).count();
        let mut share = 1.0;
        if (near as f64) < NEAR_ENOUGH * readings.len() as f64 {
            values.clear();
            values.extend(readings.iter().filter(|r| r.cell != NO_CELL).map(|r| r.residual.abs()));
            scale = scale.max(1.4826 * median(values).unwrap_or(0.0));
            if !first {
                // A frame with more noise than most counts for less. A prediction that is off by more than the noise, though, must not
                // lose the points it has to be corrected by.
                scale = scale.min(self.noise_level.tolerated(self.sigma));
                share = (self.sigma / scale).powi(2);
            }
        }
        let scale = 1.0 / scale;
        for reading in readings {
            if reading.cell == NO_CELL {
                reading.weight = 0.0;
                continue;
            }
            let variance = self.cells[reading.cell].scatter.variance;
            let residual = if variance > 1.0 { reading.residual / variance.sqrt() } else { reading.residual };
            let excess = (residual.abs() * scale - FULL_WEIGHT) / (NO_WEIGHT - FULL_WEIGHT);
            reading.weight = match excess {
                e if e <= 0.0 => 1.0,
                e if e < 1.0 => (1.0 - e * e).powi(2),
                _ => 0.0,
            } * share
                / variance;
        }
    }

    /// Distance of an image point from its cell. Returns the normal of the outline in the image.
    #[inline(always)]
    fn measure<const AFFINE: bool>(
        &self,
        reading: &mut Reading,
        p: &Point2<f64>,
        inverse: &Matrix3<f64>,
        shifts: &[f64],
    ) -> Vector2<f64> {
        if reading.cell == NO_CELL {
            (reading.residual, reading.slope) = (0.0, 0.0);
            return Vector2::zeros();
        }
        let cell = &self.cells[reading.cell];
        let q = map_point_by::<AFFINE>(inverse, p);
        let z = cell.normal.dot(&(q - cell.centre)) - cell.offset - shifts[reading.cell];
        // A unit step along the image normal moves the body point by |D' n| along n.
        let pulled = pull_back_by::<AFFINE>(inverse, p, &q, &cell.normal);
        reading.slope = 1.0 / pulled.norm();
        reading.residual = z * reading.slope;
        pulled * reading.slope
    }

    /// How the distance changes with the pose.
    #[inline]
    fn linearise(&self, reading: &mut Reading, p: &Point2<f64>, normal: &Vector2<f64>, unseen: &[Unseen]) {
        if reading.cell == NO_CELL {
            reading.row = [0.0; MAX_PARAMETERS];
            return;
        }
        let foot = p - reading.residual * normal;
        reading.row = self.model.normal_velocities(&foot, normal);
        unseen.iter().for_each(|unseen| unseen.take_off(&mut reading.row));
    }

    /// Number of the cell nearest to a body point.
    pub(crate) fn nearest_cell(&self, q: &Point2<f64>) -> Option<usize> {
        self.field.lookup(q).map(|near| self.nearest_from(near, q))
    }

    /// The cell nearest to a body point, from one near it.
    #[inline(always)]
    pub(crate) fn nearest_from(&self, near: usize, q: &Point2<f64>) -> usize {
        let mut number = near;
        let mut distance = (self.cells[number].centre - q).norm_squared();
        loop {
            let mut better = number;
            for neighbour in self.cells[number].neighbours {
                let d = (self.cells[neighbour].centre - q).norm_squared();
                if d < distance {
                    (better, distance) = (neighbour, d);
                }
            }
            if better == number {
                return number;
            }
            number = better;
        }
    }

    /// Whether a body point lies beyond a known end of the outline, its nearest cell given.
    pub(crate) fn is_beyond_end(&self, number: usize, q: &Point2<f64>) -> bool {
        let cell = &self.cells[number];
        let [a, b] = cell.neighbours;
        if a != number && b != number {
            return false;
        }
        let tangent = Vector2::new(-cell.normal.y, cell.normal.x);
        let along = tangent.dot(&(q - cell.centre));
        let known = if a == number { b } else { a };
        let to_known = tangent.dot(&(self.cells[known].centre - cell.centre));
        along.abs() > BEYOND_END * self.spacing && (known == number || along * to_known < 0.0)
    }

    /// Adds the readings to the information; returns the right-hand side of pose and motion, and leaves those of the offsets.
    pub(crate) fn accumulate(
        &self,
        scratch: &mut Scratch,
        work: &mut ArrowInformation,
        state: &StateVector,
    ) -> StateVector {
        scratch.right.clear();
        scratch.right.resize(self.cells.len(), 0.0);
        match self.information.k {
            3 => accumulate_sized::<3>(scratch, work, state),
            4 => accumulate_sized::<4>(scratch, work, state),
            6 => accumulate_sized::<6>(scratch, work, state),
            _ => accumulate_sized::<8>(scratch, work, state),
        }
    }
}

fn accumulate_sized<const K: usize>(
    scratch: &mut Scratch,
    work: &mut ArrowInformation,
    state: &StateVector,
) -> StateVector {
    let mut right = StateVector::zeros();
    let mut dense = [[0.0; K]; K];
    for Reading { cell, residual, slope, row, weight, .. } in &scratch.readings {
        if *weight == 0.0 {
            continue;
        }
        let mut along = 0.0;
        (0..K).for_each(|i| along += row[i] * state[i]);
        let target = residual + along + slope * scratch.shifts[*cell];
        let information = &mut work.cells[*cell];
        let weighted = weight * slope;
        for i in 0..K {
            let wi = weight * row[i];
            for j in 0..K {
                dense[i][j] += wi * row[j];
            }
            right[i] += wi * target;
            information.coupling[i] += weighted * row[i];
        }
        information.own += weighted * slope;
        scratch.right[*cell] += weighted * target;
    }
    for (sum, row) in work.dense.iter_mut().zip(&dense) {
        sum.iter_mut().zip(row).for_each(|(s, d)| *s += d);
    }
    right
}

/// Mean of the neighbours of every point along a piece of the contour, weighted, the point itself included.
fn smooth_piece(
    points: &[Point2<f64>],
    readings: &[Reading],
    closed: bool,
    half_window: usize,
    smooth: &mut Vec<Point2<f64>>,
) {
    let count = points.len();
    let w = half_window.min((count - 1) / 2);
    let weighted = |i: usize| (readings[i].weight * points[i].coords).push(readings[i].weight);
    // Less than two rounds on, where a remainder would be most of the work.
    let at = |i: usize| weighted(if i < count { i } else { i - count });
    let mut sum = nalgebra::Vector3::zeros();
    if closed {
        // The window of the first point reaches back over the end.
        (count - w..=count + w).for_each(|i| sum += at(i));
    } else {
        sum += at(0);
    }
    for (i, point) in points.iter().enumerate() {
        if i > 0 && closed {
            sum += at(i + w) - at(i + count - w - 1);
        } else if i > 0 {
            // Symmetric windows, narrower towards the ends: a lopsided mean lies off along the contour.
            let (before, now) = (w.min(i - 1).min(count - i), w.min(i).min(count - 1 - i));
            sum = if now > before {
                sum + at(2 * i - 1) + at(2 * i)
            } else if now < before {
                sum - at(i - 1 - before) - at(i - before)
            } else {
                sum + at(i + now) - at(i - 1 - before)
            };
        }
        smooth.push(if sum.z > 1e-3 { Point2::from(sum.xy() * (1.0 / sum.z)) } else { *point });
    }
}
