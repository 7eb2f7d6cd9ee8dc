//! One frame taken into curve, pose and motion.
use freeform_curve_fit::{MAX_COEFFICIENTS, Outline};
use freeform_riccati::{Lift, MotionModel};
use nalgebra::{Matrix3, SMatrix};

use super::{
    filter::WholeCurveFilter,
    state_information::{Linearised, MAX_STATE},
};
use crate::{estimate::MAX_PARAMETERS, motion_algebra::Coordinates};

/// Most linearisations of a frame.
const MOST_ITERATIONS: usize = 10;
/// A step that moves points by less than this share of the level-set offset, in the root mean square, is the last.
const SETTLED: f64 = 0.03;
/// Frames that the noise along the normals is taken from.
const NOISE_FRAMES: f64 = 8.0;
/// Frames before the covariance of the scores is learnt.
const FIRST_FRAMES: usize = 2;
/// Frames that the usual misfit looks back on.
const MISFIT_MEMORY: f64 = 50.0;
/// Eigenvalue of the pose information, as a share of the mean, below which a direction of the pose cannot be seen.
const DEGENERATE: f64 = 0.003;

pub(super) type PoseMatrix = SMatrix<f64, MAX_PARAMETERS, MAX_PARAMETERS>;

/// A frame linearised about the curve, and its scores.
pub(super) struct LinearisedFrame {
    pub(super) information: Linearised,
    pub(super) score: [f64; MAX_COEFFICIENTS],
    pub(super) pose_score: Coordinates,
}

/// State after a frame that may still be rejected.
pub(super) struct Trial {
    pub(super) pose: Matrix3<f64>,
    pub(super) motion: Coordinates,
    pub(super) coefficients: [f64; MAX_COEFFICIENTS],
    pub(super) frame: LinearisedFrame,
    /// Score of the pose that is left after the update.
    pub(super) left: Coordinates,
    pub(super) innovation: f64,
    /// Root mean square distance that points have moved by, in level-set offsets.
    pub(super) surprise: f64,
    pub(super) iterations: usize,
}

impl WholeCurveFilter {
    /// Iterated Gauss-Newton on curve, pose and motion for the loaded frame.
    pub(super) fn try_frame(&mut self, outline: &Outline, pose: Matrix3<f64>, motion: Coordinates) -> Option<Trial> {
        let model = self.settings.model;
        let (n, k) = (self.settings.degree.coefficient_count(), model.parameter_count());
        let mut shift = [0.0; MAX_STATE];
        let (mut at, mut coefficients) = (pose, self.coefficients);
        let (mut innovation, mut iterations) = (0.0, 0);
        loop {
            self.sums.measure(outline, &at.try_inverse()?, Some((&coefficients[..n], self.usual_square)));
            let points = self.sums.count as f64;
            let frame = self.linearised(model, &coefficients);
            if iterations == 0 {
                innovation = self.certainty.innovation(&frame.information.pose, points, &frame.pose_score);
            }
            let scores = (&frame.score[..n], &frame.pose_score);
            let step = self.information.solve(&self.sums.gram, &frame.information, scores, &shift)?;
            let mut left = frame.pose_score;
            for (j, left) in left.iter_mut().enumerate().take(k) {
                let by_curve: f64 = frame.information.slopes[j][..n].iter().zip(&step).map(|(s, d)| s * d).sum();
                let by_pose: f64 = (0..k).map(|i| frame.information.pose[j][i] * step[n + i]).sum();
                *left -= by_curve + by_pose;
            }
            shift.iter_mut().zip(&step).for_each(|(sum, d)| *sum += d);
            (0..n).for_each(|i| coefficients[i] += step[i]);
            at = pose * model.flow(&shift[n..n + k], 1.0).into_inner();
            if !at.iter().all(|e| e.is_finite()) || at.determinant().abs() < 1e-9 {
                return None;
            }
            iterations += 1;
            let moved = displacement(&frame.information, &step[n..n + k], points);
            if moved < SETTLED || iterations == MOST_ITERATIONS {
                let mut motion = motion;
                (0..k).for_each(|j| motion[j] += shift[n + k + j]);
                let surprise = displacement(&frame.information, &shift[n..n + k], points);
                return Some(Trial { pose: at, motion, coefficients, frame, left, innovation, surprise, iterations });
            }
        }
    }

    pub(super) fn take(&mut self, trial: &Trial, predicted: bool) {
        self.information.keep();
        (self.pose, self.motion, self.coefficients) = (trial.pose, trial.motion, trial.coefficients);
        if self.certainty.noise_frames() < NOISE_FRAMES {
            self.certainty.take_noise(self.sums.noise());
        }
        let learning = predicted && self.frames >= FIRST_FRAMES;
        let left = learning.then_some(&trial.left);
        self.certainty.update(&trial.frame.information.pose, self.sums.count as f64, left);
        let weight = 1.0 / (self.frames as f64 + 1.0).min(MISFIT_MEMORY);
        self.usual_misfit += weight * (self.sums.misfit - self.usual_misfit);
        self.usual_square += weight * (self.sums.mean_square - self.usual_square);
        if (self.frames + 1).is_power_of_two() {
            self.find_seen_directions(&trial.frame.information);
        }
    }

    /// The measured frame linearised about a curve: how its score and the curve change with the pose.
    pub(super) fn linearised(&self, model: MotionModel, coefficients: &[f64; MAX_COEFFICIENTS]) -> LinearisedFrame {
        let (degree, n) = (self.settings.degree, self.settings.degree.coefficient_count());
        let k = model.parameter_count();
        let mut rates = [[0.0; MAX_COEFFICIENTS]; MAX_PARAMETERS];
        for (rate, generator) in rates.iter_mut().zip(model.basis()) {
            Lift::new(degree, *generator).apply(&coefficients[..n], &mut rate[..n]);
        }
        if model == self.settings.model && self.seen != PoseMatrix::identity() {
            let whole = rates;
            for (i, rate) in rates.iter_mut().enumerate().take(k) {
                rate.fill(0.0);
                for (j, other) in whole.iter().enumerate().take(k) {
                    rate.iter_mut().zip(other).for_each(|(r, o)| *r += self.seen[(i, j)] * o);
                }
            }
        }
        let mut score = [0.0; MAX_COEFFICIENTS];
        score[..n].copy_from_slice(&self.sums.projection[..n]);
        let mut slopes = [[0.0; MAX_COEFFICIENTS]; MAX_PARAMETERS];
        for (i, column) in self.sums.gram.chunks_exact(n).enumerate() {
            score[..n].iter_mut().zip(column).for_each(|(e, g)| *e -= coefficients[i] * g);
            for (slope, rate) in slopes.iter_mut().zip(&rates).take(k) {
                slope[..n].iter_mut().zip(column).for_each(|(s, g)| *s += rate[i] * g);
            }
        }
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut pose = [[0.0; MAX_PARAMETERS]; MAX_PARAMETERS];
        let mut pose_score = [0.0; MAX_PARAMETERS];
        for i in 0..k {
            (0..k).for_each(|j| pose[i][j] = dot(&rates[i][..n], &slopes[j][..n]));
            pose_score[i] = dot(&rates[i][..n], &score[..n]);
        }
        LinearisedFrame { information: Linearised { slopes, pose }, score, pose_score }
    }

    /// Finds the directions of the pose that a frame shows, the body frame being centred and of unit size.
    pub(super) fn find_seen_directions(&mut self, frame: &Linearised) {
        let k = self.settings.model.parameter_count();
        let pose = PoseMatrix::from_fn(|i, j| frame.pose[i][j]);
        let limit = DEGENERATE * pose.trace() / k as f64;
        let eigen = pose.symmetric_eigen();
        let mut seen = PoseMatrix::identity();
        for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
            if *value < limit && vector.rows(0, k).norm() > 0.5 {
                seen -= vector * vector.transpose();
            }
        }
        self.seen = seen;
    }
}

/// Root mean square distance that a step of the pose moves points by, in level-set offsets: f changes by 1 over an offset, in
/// each of three levels.
fn displacement(frame: &Linearised, step: &[f64], points: f64) -> f64 {
    let squares: f64 = step
        .iter()
        .enumerate()
        .map(|(i, a)| step.iter().enumerate().map(|(j, b)| a * frame.pose[i][j] * b).sum::<f64>())
        .sum();
    (squares.max(0.0) / (3.0 * points.max(1.0))).sqrt()
}
