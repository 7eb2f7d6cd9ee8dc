//! One frame measured against the map, and the map grown by what it shows for the first time.
use freeform_curve_fit::Outline;
use nalgebra::{Matrix3, Point2};

use super::{
    arrow_information::{ArrowInformation, CellInformation, STATE, StateMatrix, StateVector, scaled_solution},
    contour::median,
    noise_level::STRETCHES,
    outline_map::OutlineMap,
    reading::{NO_CELL, Reading},
    unseen_direction::Unseen,
    withheld::with_hold,
};

/// Residuals within this many standard deviations agree with the map.
const AGREEING: f64 = 3.5;
/// Residuals below this many spacings agree too: corners lie off the straight cells by as much.
const BEND: f64 = 0.2;
/// Most linearisations per frame.
const MOST_ITERATIONS: usize = 6;
/// A step that moves points by less than this many standard deviations of the noise is the last.
const SETTLED: f64 = 0.03;
/// Share of what is known of a cell beyond which a point says nothing of the noise: the cell follows it.
const LARGEST_LEVERAGE: f64 = 0.8;
/// Fewest points beyond the known ends that make the map grow.
const FEWEST_NEW_POINTS: usize = 4;

/// What one frame said of the map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapUpdate {
    /// Whether it was taken.
    pub accepted: bool,
    /// Share of the points that lie on the known outline, of those that do not lie beyond its ends; in [0, 1].
    pub agreement: f64,
    /// Points that lie beyond the known ends of the outline.
    pub new_points: usize,
    /// Squared innovation of the pose in units of its covariance: about the number of parameters in the mean, if the motion has gone
    /// on as it was.
    pub innovation: f64,
    /// Linearisations taken.
    pub iterations: usize,
    /// Standard deviation of this frame's noise, image lengths; `None` where too few cells have been seen before.
    pub noise: Option<f64>,
    /// Robust spread of all points about the map, those left out included, image lengths; infinite where there are none.
    pub spread: f64,
}

/// Buffers that are reused from frame to frame.
#[derive(Debug, Clone, Default)]
pub(crate) struct Scratch {
    pub(crate) points: Vec<Point2<f64>>,
    /// Pieces of the contour that the points make.
    pub(crate) pieces: Vec<Piece>,
    /// Means of neighbouring points.
    pub(crate) smooth: Vec<Point2<f64>>,
    pub(crate) readings: Vec<Reading>,
    pub(crate) cells: Vec<CellInformation>,
    pub(crate) right: Vec<f64>,
    pub(crate) shifts: Vec<f64>,
    pub(crate) values: Vec<f64>,
}

/// A frame's solution for pose and motion.
pub(crate) struct Solution {
    /// Step from what was predicted.
    pub(crate) state: StateVector,
    pub(crate) pose: Matrix3<f64>,
    /// Directions that the outline does not show.
    unseen: Vec<Unseen>,
    /// Information on pose and motion with the frame, the outline given.
    dense: [[f64; STATE]; STATE],
    /// The same with the offsets eliminated.
    pub(crate) marginal: StateMatrix,
    iterations: usize,
}

/// A connected run of points.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Piece {
    pub(crate) start: usize,
    pub(crate) count: usize,
    pub(crate) closed: bool,
}

impl Piece {
    pub(crate) fn range(&self) -> std::ops::Range<usize> {
        self.start..self.start + self.count
    }
}

impl Scratch {
    /// Leaves at most about so many of the points.
    pub(crate) fn thin_out(&mut self, count: usize) {
        let stride = self.points.len().div_ceil(count).max(1);
        let mut kept = 0;
        for piece in &mut self.pieces {
            let start = kept;
            for i in piece.range().step_by(stride) {
                self.points[kept] = self.points[i];
                kept += 1;
            }
            (piece.start, piece.count) = (start, kept - start);
        }
        self.points.truncate(kept);
    }

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
        let update = self.update_loaded(&mut scratch, &accept);
        self.scratch = scratch;
        if update.accepted && update.new_points >= FEWEST_NEW_POINTS {
            self.grow();
        }
        update
    }

    fn update_loaded(&mut self, scratch: &mut Scratch, accept: &dyn Fn(&MapUpdate) -> bool) -> MapUpdate {
        let k = self.information.k;
        let unseen = self.unseen_in_image(&self.pose);
        let hold = self.hold(&unseen);
        let solution = match self.solve(scratch, &unseen, hold.as_ref()) {
            Ok(solution) => solution,
            Err(iterations) => return self.rejected(iterations),
        };
        let variance = self.comparable_noise().powi(2) * self.noise_level.correlation();
        self.innovation = self.solution_innovation(&solution, hold.as_ref(), variance);
        let Solution { state, pose, dense, marginal, iterations, .. } = solution;
        if self.is_compared {
            self.last_misfit = self.misfit(scratch);
            self.last_misfit.squares += self.innovation.squared;
        }
        let mut update = self.judge(scratch, iterations);
        let correlation = correlation(&scratch.readings, update.noise.map(|noise| noise / self.radius));
        update.accepted = accept(&update);
        if update.accepted {
            std::mem::swap(&mut self.information.cells, &mut scratch.cells);
            self.information.dense = dense;
            self.marginal = marginal;
            self.pose = pose;
            (0..k).for_each(|i| self.motion[i] += state[k + i]);
            self.cells.iter_mut().zip(&scratch.shifts).for_each(|(cell, shift)| cell.offset += shift);
            // The buffer holds the cells as they were.
            self.compare_innovations(&scratch.shifts, &scratch.cells);
            let units = 1.0 / (self.sigma * self.sigma);
            for r in scratch.readings.iter().filter(|r| r.weight > 0.0) {
                if let Some(factor) = without_leverage(r, self.information.cells[r.cell].own) {
                    self.cells[r.cell].scatter.take(r.residual * r.residual * units * factor);
                }
            }
            if let Some(noise) = update.noise {
                self.take_noise(noise / self.radius);
            }
            if let Some(ratio) = correlation {
                self.noise_level.take_correlation(ratio);
            }
        }
        update
    }

    /// Linearises and solves until the pose settles; the number of linearisations where there is no solution. `hold` is information that
    /// is added for the solution only.
    fn solve(&self, scratch: &mut Scratch, unseen: &[Unseen], hold: Option<&StateMatrix>) -> Result<Solution, usize> {
        let k = self.information.k;
        scratch.shifts.clear();
        scratch.shifts.resize(self.cells.len(), 0.0);
        let mut solution = Solution {
            state: StateVector::zeros(),
            pose: self.pose,
            unseen: unseen.to_vec(),
            dense: self.information.dense,
            marginal: self.marginal,
            iterations: 0,
        };
        let mut work = ArrowInformation::new(k);
        let mut settled = false;
        while solution.iterations < MOST_ITERATIONS && !settled {
            // A turn that is not seen is one about the middle as the frame has it.
            if solution.iterations > 0 && !solution.unseen.is_empty() {
                solution.unseen = self.unseen_in_image(&solution.pose);
            }
            self.read_points(scratch, &solution.pose, &solution.unseen, solution.iterations == 0);
            scratch.cells.clone_from(&self.information.cells);
            std::mem::swap(&mut work.cells, &mut scratch.cells);
            work.dense = self.information.dense;
            let right = self.accumulate(scratch, &mut work, &solution.state);
            let marginal = work.marginal();
            let reduced = reduce(&work, &scratch.right, right);
            let held = scaled_solution(&with_hold(&marginal, hold), &reduced, k);
            let next = held.filter(|next| next.iter().all(|e| e.is_finite()));
            if let Some(next) = next {
                scratch.take_solution(&work.cells, &(next - solution.state), &next, k);
            }
            std::mem::swap(&mut work.cells, &mut scratch.cells);
            let next = next.ok_or(solution.iterations)?;
            let step = (0..k).map(|i| (next[i] - solution.state[i]).abs()).fold(0.0, f64::max);
            let pose = self.model.flow(&next.as_slice()[..k], 1.0).into_inner() * self.pose;
            if !pose.iter().all(|e| e.is_finite()) || pose.determinant().abs() < 1e-12 {
                return Err(solution.iterations);
            }
            let iterations = solution.iterations + 1;
            let unseen = solution.unseen;
            solution = Solution { state: next, pose, unseen, dense: work.dense, marginal, iterations };
            settled = step < SETTLED * self.sigma;
        }
        Ok(solution)
    }

    fn rejected(&self, iterations: usize) -> MapUpdate {
        MapUpdate {
            accepted: false,
            agreement: 0.0,
            new_points: 0,
            innovation: f64::INFINITY,
            iterations,
            noise: None,
            spread: f64::INFINITY,
        }
    }

    fn judge(&self, scratch: &mut Scratch, iterations: usize) -> MapUpdate {
        let Scratch { readings, values, cells, .. } = scratch;
        let spread = spread(values, readings);
        let scale = spread.clamp(self.sigma, self.noise_level.tolerated(self.sigma));
        let tolerance = (AGREEING * scale).max(BEND * self.spacing);
        let (mut known, mut agreeing, mut new_points) = (0usize, 0usize, 0usize);
        values.clear();
        for r in readings.iter() {
            if r.cell == NO_CELL {
                new_points += 1;
                continue;
            }
            known += 1;
            agreeing += usize::from(r.residual.abs() < tolerance);
            if let Some(factor) = without_leverage(r, cells[r.cell].own).filter(|_| r.weight > 0.0) {
                values.push(r.residual.abs() * factor.sqrt());
            }
        }
        let enough = values.len() * 4 > readings.len();
        let noise = median(values).filter(|_| enough).map(|m| 1.4826 * m * self.radius);
        // Points beyond the ends may be anything: they count for a third.
        let total = known as f64 + new_points as f64 / 3.0;
        let agreement = if total > 0.0 { agreeing as f64 / total } else { 0.0 };
        let innovation = self.innovation.squared;
        MapUpdate {
            accepted: false,
            agreement,
            new_points,
            innovation,
            iterations,
            noise,
            spread: spread * self.radius,
        }
    }
}

/// What a squared residual would be without its point's own share of the information on the offset of its cell, in units of what it is;
/// `None` where that share is too large to tell.
fn without_leverage(reading: &Reading, own: f64) -> Option<f64> {
    let of_point = reading.weight * reading.slope * reading.slope;
    (of_point < LARGEST_LEVERAGE * own).then(|| own / (own - of_point))
}

/// Robust standard deviation of all residuals.
fn spread(values: &mut Vec<f64>, readings: &[Reading]) -> f64 {
    values.clear();
    values.extend(readings.iter().filter(|r| r.cell != NO_CELL).map(|r| r.residual.abs()));
    median(values).map_or(f64::INFINITY, |m| 1.4826 * m)
}

/// How many times the variance of the mean residual over a stretch of the contour is what independent errors give.
fn correlation(readings: &[Reading], noise: Option<f64>) -> Option<f64> {
    let length = readings.len() / STRETCHES;
    let noise = noise.filter(|noise| *noise > 0.0 && length >= 3)?;
    let (mut sum, mut count) = (0.0, 0.0);
    for stretch in readings.chunks_exact(length) {
        let used = stretch.iter().filter(|r| r.weight > 0.0);
        let (total, number) = used.fold((0.0, 0.0), |(total, number), r| (total + r.residual, number + 1.0));
        if 2.0 * number > length as f64 {
            sum += total * total / number;
            count += 1.0;
        }
    }
    (2.0 * count > STRETCHES as f64).then(|| sum / (count * noise * noise))
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
