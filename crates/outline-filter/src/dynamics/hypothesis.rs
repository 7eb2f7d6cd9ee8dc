//! One hypothesis of dynamics: pose, motion and accelerations about the object's centroid, moved on and measured.
use freeform_riccati::{MotionModel, map_point};
use nalgebra::{Matrix2, SMatrix, SVector, Vector2};

use crate::vectors::vectorised;

use super::{
    centred::{CentredMatrix, CentredPose, CentredVector, LARGEST, as_map, carry, centred_generator, parts},
    course::Course,
    step::{Step, pushed_along, turned_along},
    turned_chains::carry_turned_chains,
};

/// State of one hypothesis for a model of k parameters, N = 3 k. Entry `j` is the error of the reference pose, `k + j` the motion, `2 k + j`
/// its acceleration; all about the centroid: rates first, then the velocity of the centroid.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Hypothesis<const N: usize> {
    pub(super) course: Course,
    pub(super) mean: SVector<f64, N>,
    pub(super) covariance: SMatrix<f64, N, N>,
}

/// What a frame tells of the pose by itself, about the centroid of the reference pose.
#[derive(Debug, Clone, Copy)]
pub(super) struct CentredMeasurement {
    /// [Root](super::correction::root_of) of the information.
    pub(super) root: CentredMatrix,
    /// Error of the reference pose as measured.
    pub(super) deviation: CentredVector,
    /// As that of [`PoseMeasurement`](crate::update::PoseMeasurement).
    pub(super) noise_inflation: f64,
}

impl CentredMeasurement {
    /// Numbers of the pose that the frame tells something of.
    pub(super) fn rank(&self) -> usize {
        self.root.diagonal().iter().filter(|entry| **entry > 0.0).count()
    }
}

/// Comparison of a measurement with a prediction.
#[derive(Debug, Clone, Copy)]
pub(super) struct Innovation {
    pub(super) log_likelihood: f64,
    /// Score of the pose, about the centroid, in its own standard deviations.
    pub(super) standardised: CentredVector,
}

impl<const N: usize> Hypothesis<N> {
    /// Number of parameters.
    pub(super) const K: usize = N / 3;

    /// Number of entries in use.
    pub(super) fn size(&self) -> usize {
        if self.course.has_more_than_motion() { N } else { 2 * Self::K }
    }

    /// Number of entries that mean the same in others: what a course has alone is not among them.
    pub(super) fn shared(&self) -> usize {
        if self.course.is_constant_velocity() { 2 * Self::K } else { self.size() }
    }

    /// Rates of the motion, as a linear map.
    pub(super) fn rates(&self, model: MotionModel) -> Matrix2<f64> {
        parts(&centred_generator(model, &self.mean.as_slice()[Self::K..2 * Self::K])).0
    }

    /// How far a push beside the turn takes the centroid over a step, the rates being those half way through it; nowhere where there is none.
    pub(super) fn pushed_along(&self, step: &Step<'_>) -> Matrix2<f64> {
        let (k, dt) = (Self::K, step.seconds);
        if !(self.course.has_accelerations() && self.course.turns()) {
            return Matrix2::zeros();
        }
        let half_way =
            CentredVector::from_fn(|j, _| if j < k { self.mean[k + j] + 0.5 * dt * self.mean[2 * k + j] } else { 0.0 });
        pushed_along(&parts(&centred_generator(step.model, &half_way.as_slice()[..k])).0, dt)
    }

    /// Moves on by a step; whether the numbers allow it.
    pub(super) fn predict(&mut self, step: &Step<'_>) -> bool {
        match step.model {
            MotionModel::Rigid | MotionModel::Similarity => self.predict_commuting(step),
            MotionModel::Affine if self.predict_any(step) => {}
            MotionModel::Projective if self.predict_in_perspective(step) => {}
            MotionModel::Affine | MotionModel::Projective => return false,
        }
        let (mean, covariance) = (&self.mean.data.0[0], &self.covariance.data.0);
        vectorised(
            #[inline(always)]
            || {
                // A sum is finite only if all of its members are.
                let mut sum = *mean;
                for column in covariance {
                    for i in 0..N {
                        sum[i] += column[i];
                    }
                }
                sum.iter().sum::<f64>().is_finite()
            },
        )
    }

    /// The plain way, for all models but projective motion; whether the numbers allow it. Where turns and growth commute there is
    /// [another](Self::predict_commuting).
    pub(super) fn predict_any(&mut self, step: &Step<'_>) -> bool {
        let (model, k, dt) = (step.model, Self::K, step.seconds);
        let rates = k - 2;
        let entry = |at: usize| CentredVector::from_fn(|j, _| if j < k { self.mean[at * k + j] } else { 0.0 });
        let [error, motion, mut acceleration] = [entry(0), entry(1), entry(2)];
        let turning = Vector2::new(acceleration[k - 2], acceleration[k - 1]);
        if self.course.is_constant_velocity() {
            acceleration.fill(0.0);
        }
        let v = parts(&model.generator(&motion.as_slice()[..k])).1;
        let w = parts(&model.generator(&acceleration.as_slice()[..k])).1;
        let of_rates = |of: &CentredVector, seconds: f64| model.linear_flow(&of.as_slice()[..k], seconds);
        let of_motion = || model.linear_flow_with_integral(&motion.as_slice()[..k], dt);
        let pushed = self.pushed_along(step);
        let (turn, along, shift, later) = match self.course {
            Course::ConstantGenerator | Course::Shaken { .. } => {
                let (turn, along) = of_motion();
                (turn, along, along * v, turn * v)
            }
            Course::ChangingGenerator { .. } | Course::SteadyChange { turns: true } => {
                let half_way = motion + 0.5 * dt * acceleration;
                let (turn, along) = model.linear_flow_with_integral(&half_way.as_slice()[..k], dt);
                (turn, along, along * v + pushed * w, turn * v + along * w)
            }
            Course::ConstantVelocity { .. } => {
                let (turn, along) = of_motion();
                let beyond = turned_along(&along, dt) * turning;
                (turn, along, v * dt + beyond, v + turn * turning - turning)
            }
            Course::Accelerating { .. } | Course::SteadyChange { turns: false } => {
                // No part of the velocity turns with the object.
                let along = Matrix2::identity() * dt;
                (of_rates(&(motion + 0.5 * dt * acceleration), dt), along, v * dt + 0.5 * dt * dt * w, v + dt * w)
            }
        };
        let relative = turn * of_rates(&error, 1.0) * step.turned;
        let Some(off) = model.motion_between(&as_map(&relative), 1.0) else { return false };
        let centre = step.centre + Vector2::new(error[k - 2], error[k - 1]) + shift;
        if self.course.accelerates() && model == MotionModel::Affine {
            carry_turned_chains(&mut self.covariance.data.0, &turn, dt);
        } else if model == MotionModel::Affine {
            self.carry_turned([&turn, &along, &pushed], [&v, &later], dt);
        } else {
            let (transition, size) = (self.transition(step, (&turn, &along, &pushed), (&v, &later)), self.size());
            carry(&transition, &mut self.covariance, size);
        }
        for j in 0..rates {
            self.mean[j] = off[j];
            self.mean[k + j] += dt * acceleration[j];
        }
        (self.mean[k - 2], self.mean[k - 1]) = (centre.x, centre.y);
        (self.mean[2 * k - 2], self.mean[2 * k - 1]) = (later.x, later.y);
        if self.course.is_constant_velocity() {
            self.mean.fixed_rows_mut::<2>(3 * k - 2).copy_from(&(turn * turning));
        }
        self.add_change_of_accelerations(step);
        true
    }

    /// Lets accelerations have changed at random during a step.
    pub(super) fn add_change_of_accelerations(&mut self, step: &Step<'_>) {
        let Some(level) = self.course.level() else { return };
        let k = Self::K;
        let covariance = &mut self.covariance.data.0;
        for j in self.course.first_changing(k)..k {
            let variance = level * step.pose_variance[j];
            for (row, shares) in step.by_change.iter().enumerate() {
                for (column, share) in shares.iter().enumerate() {
                    covariance[column * k + j][row * k + j] += share * variance;
                }
            }
        }
    }

    /// Propagation of errors over a step: `turn` is the linear part of the motion over it, `along` its integral and `pushed` how far a
    /// [push takes it](Self::pushed_along), v is the velocity before it, and `later` that after it.
    pub(super) fn transition(
        &self,
        step: &Step<'_>,
        (turn, along, pushed): (&Matrix2<f64>, &Matrix2<f64>, &Matrix2<f64>),
        (v, later): (&Vector2<f64>, &Vector2<f64>),
    ) -> SMatrix<f64, N, N> {
        let (model, k, dt) = (step.model, Self::K, step.seconds);
        let rates = k - 2;
        let mut f = step.pose_transition(turn);
        match self.course {
            course if course.turns() => {
                let mean_velocity = 0.5 * (v + later);
                for i in 0..2 {
                    for j in 0..2 {
                        f[(rates + i, k + rates + j)] = along[(i, j)];
                        f[(k + rates + i, k + rates + j)] = turn[(i, j)];
                    }
                }
                for (j, basis) in model.basis().iter().enumerate().take(rates) {
                    let by_rate = parts(basis).0 * mean_velocity;
                    for i in 0..2 {
                        f[(k + rates + i, k + j)] = dt * by_rate[i];
                        f[(rates + i, k + j)] = 0.5 * dt * dt * by_rate[i];
                    }
                }
            }
            Course::ConstantVelocity { .. } => {
                let (less, beyond) = (turn - Matrix2::identity(), turned_along(along, dt));
                for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    let (row, column) = (rates + i, 2 * k + rates + j);
                    f[(row, column)] = beyond[(i, j)];
                    f[(k + row, column)] = less[(i, j)];
                    f[(2 * k + row, column)] = turn[(i, j)];
                }
            }
            _ => {}
        }
        if self.course.has_accelerations() {
            for j in 0..k {
                f[(j, 2 * k + j)] = 0.5 * dt * dt;
                f[(k + j, 2 * k + j)] = dt;
            }
        }
        if self.course.has_accelerations() && self.course.turns() {
            for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                f[(rates + i, 2 * k + rates + j)] = pushed[(i, j)];
                f[(k + rates + i, 2 * k + rates + j)] = along[(i, j)];
            }
            // The rates half way through the step are larger by half of what they change.
            for (i, j) in (0..2).flat_map(|i| (0..rates).map(move |j| (i, j))) {
                f[(k + rates + i, 2 * k + j)] = 0.5 * dt * f[(k + rates + i, k + j)];
                f[(rates + i, 2 * k + j)] = 0.5 * dt * f[(rates + i, k + j)];
            }
        }
        f
    }

    /// Compares a measurement of the pose with what was predicted, and corrects it; `None` where the numbers do not allow it.
    pub(super) fn update(&mut self, measurement: &CentredMeasurement) -> Option<Innovation> {
        match Self::K {
            3 => self.update_sized::<3>(measurement),
            4 => self.update_sized::<4>(measurement),
            6 => self.update_sized::<6>(measurement),
            _ => self.update_sized::<LARGEST>(measurement),
        }
    }

    /// Projects a null direction, given with its dual, out of mean and covariance.
    pub(super) fn hold(&mut self, direction: &CentredVector, dual: &CentredVector) {
        match Self::K {
            3 => self.hold_sized::<3>(direction, dual),
            4 => self.hold_sized::<4>(direction, dual),
            6 => self.hold_sized::<6>(direction, dual),
            _ => self.hold_sized::<LARGEST>(direction, dual),
        }
    }

    /// The projection is the same for pose, motion and accelerations, and mixes none of them: its products by zero are left out.
    fn hold_sized<const K: usize>(&mut self, direction: &CentredVector, dual: &CentredVector) {
        // By columns.
        let projection: [[f64; K]; K] =
            std::array::from_fn(|j| std::array::from_fn(|i| f64::from(u8::from(i == j)) - direction[i] * dual[j]));
        // What lies beyond the entries in use is none, and stays so.
        let blocks = self.size() / K;
        let (mean, covariance) = (&mut self.mean.data.0[0], &mut self.covariance.data.0);
        vectorised(
            #[inline(always)]
            || {
                *mean = projected(&projection, mean, blocks);
                let mut columns = [[0.0; N]; N];
                for j in 0..blocks * K {
                    columns[j] = projected(&projection, &covariance[j], blocks);
                }
                for block in 0..blocks {
                    for row in 0..K {
                        let mut sum = [0.0; N];
                        for j in 0..K {
                            let (column, share) = (&columns[block * K + j], projection[j][row]);
                            for i in 0..N {
                                sum[i] += column[i] * share;
                            }
                        }
                        covariance[block * K + row] = sum;
                    }
                }
            },
        );
    }

    /// The velocity of the centroid taken at another point of the object.
    pub(super) fn move_centroid(&mut self, model: MotionModel, from: &CentredPose, to: &CentredPose) {
        let k = Self::K;
        let apart = map_point(&from.pose, &to.centroid) - from.centre();
        let carried = self.rates(model) * apart;
        self.mean[2 * k - 2] += carried.x;
        self.mean[2 * k - 1] += carried.y;
        let carried = match self.course {
            Course::ConstantVelocity { .. } => carried,
            _ => parts(&centred_generator(model, &self.mean.as_slice()[2 * k..3 * k])).0 * apart,
        };
        self.mean[3 * k - 2] += carried.x;
        self.mean[3 * k - 1] += carried.y;
    }
}

/// A vector whose first parts of the size of a projection, given by its columns, so many, are each projected; no other has entries.
#[inline(always)]
fn projected<const K: usize, const N: usize>(projection: &[[f64; K]; K], vector: &[f64; N], parts: usize) -> [f64; N] {
    let mut projected = [0.0; N];
    for block in 0..parts {
        for j in 0..K {
            let entry = vector[block * K + j];
            for i in 0..K {
                projected[block * K + i] += projection[j][i] * entry;
            }
        }
    }
    projected
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a course that has accelerations, and of one that has none.
    fn check<const N: usize>() {
        check_course::<N>(Course::Accelerating { level: 0.1, rates: true });
        check_course::<N>(Course::ConstantGenerator);
    }

    fn check_course<const N: usize>(course: Course) {
        let k = N / 3;
        let used = if course.has_accelerations() { N } else { 2 * k };
        let (direction, dual) = (
            CentredVector::from_fn(|i, _| if i < k { (0.7 + i as f64).sin() } else { 0.0 }),
            CentredVector::from_fn(|i, _| if i < k { (1.9 * i as f64).cos() } else { 0.0 }),
        );
        let mean = SVector::<f64, N>::from_fn(|i, _| if i < used { (0.3 + 1.1 * i as f64).sin() } else { 0.0 });
        let entry = |i: usize, j: usize| (0.2 * (i * j + i + j) as f64).cos();
        let covariance = SMatrix::<f64, N, N>::from_fn(|i, j| if i.max(j) < used { entry(i, j) } else { 0.0 });
        let mut hypothesis = Hypothesis { course, mean, covariance };
        hypothesis.hold(&direction, &dual);
        let mut projection = SMatrix::<f64, N, N>::identity();
        for (block, i, j) in (0..3).flat_map(|b| (0..k).flat_map(move |i| (0..k).map(move |j| (b * k, i, j)))) {
            projection[(block + i, block + j)] -= direction[i] * dual[j];
        }
        assert_eq!(hypothesis.mean, projection * mean, "{k} parameters");
        assert_eq!(hypothesis.covariance, projection * covariance * projection.transpose(), "{k} parameters");
    }

    #[test]
    fn projecting_block_by_block_is_projecting_with_the_whole_matrix_to_the_last_bit() {
        check::<9>();
        check::<12>();
        check::<18>();
        check::<24>();
    }
}
