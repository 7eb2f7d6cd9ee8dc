//! One frame measured against the map, and the map grown by what it shows for the first time.
use freeform_curve_fit::Outline;
use nalgebra::{Matrix3, Point2, Vector2};

use super::{
    arrow_information::{ArrowInformation, CellInformation, STATE, StateMatrix, StateVector},
    contour::{SmoothPiece, median},
    outline_map::{Cell, OutlineMap, Unseen},
};
use crate::{
    estimate::MAX_PARAMETERS,
    motion_algebra::{Coordinates, map_point, normal_velocities, pull_back},
};

/// Residuals up to this many standard deviations count in full...
const FULL_WEIGHT: f64 = 3.0;
/// ...and beyond this many not at all, with Tukey's biweight between.
const NO_WEIGHT: f64 = 6.0;
/// Residuals within this many standard deviations agree with the map.
const AGREEING: f64 = 3.5;
/// Residuals below this many spacings agree too: corners lie off the straight cells by as much.
const BEND: f64 = 0.2;
/// Without noise the innovation is what straight cells leave, in spacings.
const CELL_ERROR: f64 = 0.1;
/// Most linearisations per frame.
const MOST_ITERATIONS: usize = 6;
/// A step that moves points by less than this many standard deviations of the noise is the last.
const SETTLED: f64 = 0.03;
/// With this share of the points near the prediction, their spread need not be looked at before they are weighted.
const NEAR_ENOUGH: f64 = 0.75;
/// Points further than this many spacings beyond a known end belong to what is not known yet.
const BEYOND_END: f64 = 0.75;
/// Places further than this many spacings from all cells are new.
const UNCOVERED: f64 = 1.1;
/// Fewest points beyond the known ends that make the map grow.
const FEWEST_NEW_POINTS: usize = 4;
/// Shortest run of new places that is taken.
const SHORTEST_RUN: usize = 2;

/// What one frame said of the map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapUpdate {
    /// Whether it was taken.
    pub accepted: bool,
    /// Share of the points that lie on the known outline, of those that do not lie beyond its ends; in [0, 1].
    pub agreement: f64,
    /// Points that lie beyond the known ends of the outline.
    pub new_points: usize,
    /// Squared innovation of pose and motion in units of its predicted covariance: about the number of parameters in the mean, if
    /// the motion has gone on as it was.
    pub innovation: f64,
    /// Linearisations taken.
    pub iterations: usize,
    /// Standard deviation of this frame's noise, image lengths; `None` where too few cells have been seen before.
    pub noise: Option<f64>,
}

/// What becomes of one point.
#[derive(Debug, Clone, Copy)]
struct Reading {
    /// Its cell, or `usize::MAX`.
    cell: usize,
    residual: f64,
    /// How fast the residual falls as the offset grows.
    slope: f64,
    row: Coordinates,
    weight: f64,
}

const NO_CELL: usize = usize::MAX;

/// Buffers that are reused from frame to frame.
#[derive(Debug, Clone, Default)]
pub(crate) struct Scratch {
    pub(crate) points: Vec<Point2<f64>>,
    readings: Vec<Reading>,
    cells: Vec<CellInformation>,
    right: Vec<f64>,
    shifts: Vec<f64>,
    values: Vec<f64>,
}

impl Scratch {
    /// Offsets that go with a solution for pose and motion, and what it leaves of the residuals.
    fn take_solution(&mut self, cells: &[CellInformation], step: &StateVector, state: &StateVector, k: usize) {
        self.values.clear();
        for ((shift, cell), right) in self.shifts.iter_mut().zip(cells).zip(&self.right) {
            let before = *shift;
            if cell.own > 0.0 {
                let along: f64 = (0..2 * k).map(|i| cell.coupling[i] * state[i]).sum();
                *shift = (right - along) / cell.own;
            }
            self.values.push(*shift - before);
        }
        for reading in self.readings.iter_mut().filter(|r| r.cell != NO_CELL) {
            let along: f64 = (0..k).map(|i| reading.row[i] * step[i]).sum();
            reading.residual -= along + reading.slope * self.values[reading.cell];
        }
    }
}

impl OutlineMap {
    /// Measures an outline and takes it if `accept` says so of the result; otherwise nothing changes.
    pub fn update(&mut self, outline: &Outline, accept: impl Fn(&MapUpdate) -> bool) -> MapUpdate {
        self.load(outline);
        let mut scratch = std::mem::take(&mut self.scratch);
        let update = self.update_loaded(&mut scratch, accept);
        self.scratch = scratch;
        if update.accepted && update.new_points >= FEWEST_NEW_POINTS {
            self.grow(outline);
        }
        update
    }

    fn update_loaded(&mut self, scratch: &mut Scratch, accept: impl Fn(&MapUpdate) -> bool) -> MapUpdate {
        let k = self.information.k;
        let unseen = self.unseen_in_image(&self.pose);
        scratch.shifts.clear();
        scratch.shifts.resize(self.cells.len(), 0.0);
        let mut state = StateVector::zeros();
        let mut pose = self.pose;
        let mut work = ArrowInformation::new(k);
        let mut marginal = self.marginal;
        let mut iterations = 0;
        let mut settled = false;
        while iterations < MOST_ITERATIONS && !settled {
            self.read_points(scratch, &pose, &unseen, iterations == 0);
            scratch.cells.clone_from(&self.information.cells);
            std::mem::swap(&mut work.cells, &mut scratch.cells);
            work.dense = self.information.dense;
            let right = self.accumulate(scratch, &mut work, &state);
            marginal = work.marginal();
            let reduced = reduce(&work, &scratch.right, right);
            let Some(next) = solve(&marginal, &reduced, k) else {
                std::mem::swap(&mut work.cells, &mut scratch.cells);
                return self.rejected(iterations);
            };
            scratch.take_solution(&work.cells, &(next - state), &next, k);
            let step = (0..k).map(|i| (next[i] - state[i]).abs()).fold(0.0, f64::max);
            state = next;
            pose = self.model.flow(&state.as_slice()[..k], 1.0).into_inner() * self.pose;
            if !pose.iter().all(|e| e.is_finite()) || pose.determinant().abs() < 1e-12 {
                std::mem::swap(&mut work.cells, &mut scratch.cells);
                return self.rejected(iterations);
            }
            iterations += 1;
            settled = step < SETTLED * self.sigma;
            std::mem::swap(&mut work.cells, &mut scratch.cells);
        }
        let mut update = self.judge(scratch, &state, iterations);
        update.accepted = accept(&update);
        if update.accepted {
            std::mem::swap(&mut self.information.cells, &mut scratch.cells);
            self.information.dense = work.dense;
            self.marginal = marginal;
            self.pose = pose;
            (0..k).for_each(|i| self.motion[i] += state[k + i]);
            self.cells.iter_mut().zip(&scratch.shifts).for_each(|(cell, shift)| cell.offset += shift);
            if let Some(noise) = update.noise {
                self.take_noise(noise / self.radius);
            }
        }
        update
    }

    fn rejected(&self, iterations: usize) -> MapUpdate {
        MapUpdate { accepted: false, agreement: 0.0, new_points: 0, innovation: f64::INFINITY, iterations, noise: None }
    }

    /// Nearest cell of every point and the linearised distance from it, with robust weights.
    fn read_points(&self, scratch: &mut Scratch, pose: &Matrix3<f64>, unseen: &[Unseen], first: bool) {
        let inverse = pose.try_inverse().unwrap_or_else(Matrix3::identity);
        let Scratch { points, readings, values, shifts, .. } = scratch;
        readings.clear();
        readings.extend(points.iter().map(|p| self.read(p, &inverse, unseen, shifts)));
        let mut scale = self.sigma;
        let limit = FULL_WEIGHT * scale;
        let near = readings.iter().filter(|r| r.residual.abs() < limit).count();
        if first && (near as f64) < NEAR_ENOUGH * readings.len() as f64 {
            // A prediction that is off by more than the noise must not lose the points it has to be corrected by.
            values.clear();
            values.extend(readings.iter().filter(|r| r.cell != NO_CELL).map(|r| r.residual.abs()));
            scale = scale.max(1.4826 * median(values).unwrap_or(0.0));
        }
        let scale = 1.0 / scale;
        for reading in readings {
            let excess = (reading.residual.abs() * scale - FULL_WEIGHT) / (NO_WEIGHT - FULL_WEIGHT);
            reading.weight = match excess {
                _ if reading.cell == NO_CELL => 0.0,
                e if e <= 0.0 => 1.0,
                e if e < 1.0 => (1.0 - e * e).powi(2),
                _ => 0.0,
            };
        }
    }

    fn read(&self, p: &Point2<f64>, inverse: &Matrix3<f64>, unseen: &[Unseen], shifts: &[f64]) -> Reading {
        let q = map_point(inverse, p);
        let none = Reading { cell: NO_CELL, residual: 0.0, slope: 0.0, row: [0.0; MAX_PARAMETERS], weight: 0.0 };
        let Some(number) = self.nearest_cell(&q).filter(|number| !self.is_beyond_end(*number, &q)) else { return none };
        let cell = &self.cells[number];
        let z = cell.normal.dot(&(q - cell.centre)) - cell.offset - shifts[number];
        // A unit step along the image normal moves the body point by |D' n| along n.
        let pulled = pull_back(inverse, p, &q, &cell.normal);
        let slope = 1.0 / pulled.norm();
        let normal = pulled * slope;
        let residual = z * slope;
        let foot = p - residual * normal;
        let mut row = normal_velocities(self.model, &foot, &normal);
        for Unseen { direction, dual } in unseen {
            let along: f64 = row.iter().zip(direction).map(|(a, b)| a * b).sum();
            row.iter_mut().zip(dual).for_each(|(r, d)| *r -= along * d);
        }
        Reading { cell: number, residual, slope, row, weight: 1.0 }
    }

    /// Number of the cell nearest to a body point.
    pub(crate) fn nearest_cell(&self, q: &Point2<f64>) -> Option<usize> {
        let mut number = self.field.lookup(q)?;
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
                return Some(number);
            }
            number = better;
        }
    }

    /// Whether a body point lies beyond a known end of the outline, its nearest cell given.
    fn is_beyond_end(&self, number: usize, q: &Point2<f64>) -> bool {
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
    fn accumulate(&self, scratch: &mut Scratch, work: &mut ArrowInformation, state: &StateVector) -> StateVector {
        scratch.right.clear();
        scratch.right.resize(self.cells.len(), 0.0);
        match self.information.k {
            3 => accumulate_sized::<3>(scratch, work, state),
            4 => accumulate_sized::<4>(scratch, work, state),
            6 => accumulate_sized::<6>(scratch, work, state),
            _ => accumulate_sized::<8>(scratch, work, state),
        }
    }

    fn judge(&self, scratch: &mut Scratch, state: &StateVector, iterations: usize) -> MapUpdate {
        let Scratch { readings, values, cells, .. } = scratch;
        let tolerance = (AGREEING * self.sigma).max(BEND * self.spacing);
        let (mut known, mut agreeing, mut new_points) = (0usize, 0usize, 0usize);
        values.clear();
        for r in readings.iter() {
            if r.cell == NO_CELL {
                new_points += 1;
                continue;
            }
            known += 1;
            agreeing += usize::from(r.residual.abs() < tolerance);
            let leverage = r.weight * r.slope * r.slope / cells[r.cell].own;
            if r.weight > 0.0 && leverage < 0.8 {
                values.push(r.residual.abs() / (1.0 - leverage).sqrt());
            }
        }
        let enough = values.len() * 4 > readings.len();
        let noise = median(values).filter(|_| enough).map(|m| 1.4826 * m * self.radius);
        // Points beyond the ends may be anything: they count for a third.
        let total = known as f64 + new_points as f64 / 3.0;
        let agreement = if total > 0.0 { agreeing as f64 / total } else { 0.0 };
        let innovation =
            (state.transpose() * self.marginal * state).x / self.sigma.max(CELL_ERROR * self.spacing).powi(2);
        MapUpdate { accepted: false, agreement, new_points, innovation, iterations, noise }
    }

    /// Adds cells for the parts of the loaded outline that the map does not have yet, and measures them.
    pub(crate) fn grow(&mut self, outline: &Outline) {
        let first_new = self.cells.len();
        let contours: Vec<_> = self.contours(outline).collect();
        let scale = self.pose.fixed_view::<2, 2>(0, 0).determinant().abs().sqrt();
        let sigma = self.sigma / scale;
        for mut contour in contours {
            if let Some(piece) = contour.resampled(sigma, self.half_window, self.spacing) {
                self.add_places(&piece, first_new);
            }
        }
        if self.cells.len() == first_new {
            return;
        }
        let centres: Vec<_> = self.cells.iter().map(|cell| cell.centre).collect();
        self.field.build(&centres, self.spacing);
        self.information.cells.resize(self.cells.len(), CellInformation::NOTHING);
        let w = self.half_window as f64;
        let levers = (w * (w + 1.0) * (2.0 * w + 1.0) / 3.0).sqrt();
        let normal_noise = (self.sigma / (levers * 0.5 * self.spacing)).min(0.2);
        self.find_unseen_directions(normal_noise);
        let mut scratch = std::mem::take(&mut self.scratch);
        self.measure_new_cells(&mut scratch, first_new);
        self.scratch = scratch;
    }

    /// Appends the runs of places that no cell covers, linked along the contour.
    fn add_places(&mut self, piece: &SmoothPiece, first_new: usize) {
        let count = piece.places.len();
        let covering: Vec<Option<usize>> =
            piece.places.iter().map(|place| self.covering(&place.centre, first_new)).collect();
        let new = |i: usize| covering[i].is_none();
        if !(0..count).any(new) {
            return;
        }
        if (0..count).all(new) {
            let base = self.cells.len();
            for (i, place) in piece.places.iter().enumerate() {
                let neighbours = if piece.closed {
                    [base + (i + count - 1) % count, base + (i + 1) % count]
                } else {
                    [base + i.saturating_sub(1), base + (i + 1).min(count - 1)]
                };
                self.cells.push(Cell { centre: place.centre, normal: place.normal, offset: 0.0, neighbours });
            }
            return;
        }
        // Start behind a covered place, so that no run wraps around.
        let start = if piece.closed { (0..count).find(|i| !new(*i)).unwrap_or(0) } else { 0 };
        let order: Vec<usize> = (0..count).map(|i| (start + i) % count).collect();
        for run in order.chunk_by(|a, b| new(*a) == new(*b)) {
            if !new(run[0]) || run.len() < SHORTEST_RUN {
                continue;
            }
            let base = self.cells.len();
            for (i, place) in run.iter().map(|i| piece.places[*i]).enumerate() {
                let neighbours = [base + i.saturating_sub(1), base + (i + 1).min(run.len() - 1)];
                self.cells.push(Cell { centre: place.centre, normal: place.normal, offset: 0.0, neighbours });
            }
            let (head, tail) = (run[0], run[run.len() - 1]);
            let wraps = |i: usize, on: bool| {
                if on && (piece.closed || i != 0) { covering[(i + count - 1) % count] } else { None }
            };
            self.link(wraps(head, true), base, 0);
            let after = (tail + 1 < count || piece.closed).then(|| covering[(tail + 1) % count]).flatten();
            let last = self.cells.len() - 1;
            self.link(after, last, 1);
        }
    }

    /// Joins a new end cell to the end of the known outline next to it.
    fn link(&mut self, old: Option<usize>, new: usize, side: usize) {
        let Some(mut old) = old else { return };
        // The free end is at most a few cells on.
        for _ in 0..4 {
            if let Some(free) = (0..2).find(|s| self.cells[old].neighbours[*s] == old) {
                self.cells[old].neighbours[free] = new;
                self.cells[new].neighbours[side] = old;
                return;
            }
            let target = self.cells[new].centre;
            let distance = |n: &usize| (self.cells[*n].centre - target).norm_squared();
            let [a, b] = self.cells[old].neighbours;
            old = if distance(&a) < distance(&b) { a } else { b };
        }
    }

    /// The cell that covers a place, among those older than `first_new`.
    fn covering(&self, place: &Point2<f64>, first_new: usize) -> Option<usize> {
        if first_new == 0 {
            return None;
        }
        let number = self.nearest_cell(place)?;
        let cell = &self.cells[number];
        let at = cell.centre + cell.offset * cell.normal;
        ((at - place).norm() < UNCOVERED * self.spacing).then_some(number)
    }

    /// Takes the loaded points on cells from `first_new` on as their first measurement.
    fn measure_new_cells(&mut self, scratch: &mut Scratch, first_new: usize) {
        let unseen = self.unseen_in_image(&self.pose);
        scratch.shifts.clear();
        scratch.shifts.resize(self.cells.len(), 0.0);
        self.read_points(scratch, &self.pose, &unseen, false);
        scratch.readings.retain(|r| r.cell != NO_CELL && r.cell >= first_new);
        let mut work = self.information.clone();
        self.accumulate(scratch, &mut work, &StateVector::zeros());
        for (number, right) in scratch.right.iter().enumerate().skip(first_new) {
            if work.cells[number].own > 0.0 {
                self.cells[number].offset += right / work.cells[number].own;
            }
        }
        self.information = work;
        self.marginal = self.information.marginal();
    }
}

fn accumulate_sized<const K: usize>(
    scratch: &mut Scratch,
    work: &mut ArrowInformation,
    state: &StateVector,
) -> StateVector {
    let mut right = StateVector::zeros();
    let mut dense = [[0.0; K]; K];
    for Reading { cell, residual, slope, row, weight } in &scratch.readings {
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

/// Right-hand side with the offsets eliminated.
fn reduce(work: &ArrowInformation, right_of_cells: &[f64], mut right: StateVector) -> StateVector {
    for (cell, r) in work.cells.iter().zip(right_of_cells) {
        if cell.own > 0.0 && *r != 0.0 {
            let factor = r / cell.own;
            (0..STATE).for_each(|i| right[i] -= factor * cell.coupling[i]);
        }
    }
    right
}

/// Solves `m x = b`, scaled to unit diagonal on the way; entries beyond the state stay zero.
fn solve(m: &StateMatrix, b: &StateVector, k: usize) -> Option<StateVector> {
    let scale = m.diagonal().map(|d| if d > 0.0 { 1.0 / d.sqrt() } else { 1.0 });
    let scaled = StateMatrix::from_fn(|i, j| m[(i, j)] * scale[i] * scale[j]);
    let solution = (scaled + StateMatrix::identity() * 1e-14).cholesky()?.solve(&b.component_mul(&scale));
    let mut x = solution.component_mul(&scale);
    (2 * k..STATE).for_each(|i| x[i] = 0.0);
    x.iter().all(|e| e.is_finite()).then_some(x)
}
