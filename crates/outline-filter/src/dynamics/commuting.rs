//! Hypotheses of models whose turns and growth commute, moved on in closed form: their logarithms add up.
use std::f64::consts::{PI, TAU};

use freeform_riccati::MotionModel;
use nalgebra::{Matrix2, Vector2};

use super::{
    centred::{LARGEST, parts},
    course::Course,
    hypothesis::Hypothesis,
    step::{Step, turned_along},
};
use crate::vectors::vectorised;

impl<const N: usize> Hypothesis<N> {
    /// As [`predict_any`](Self::predict_any), which a test compares it with, for rigid and similarity motion.
    pub(super) fn predict_commuting(&mut self, step: &Step<'_>) {
        let (model, k, dt) = (step.model, Self::K, step.seconds);
        debug_assert!(model <= MotionModel::Similarity);
        if self.course.accelerates() {
            let covariance = &mut self.covariance.data.0;
            vectorised(
                #[inline(always)]
                || carry_chains(covariance, dt),
            );
            for j in 0..k {
                let [error, motion, acceleration] = [0, 1, 2].map(|at| self.mean[at * k + j]);
                self.mean[j] = error + dt * (motion + 0.5 * dt * acceleration);
                self.mean[k + j] = motion + dt * acceleration;
            }
        } else {
            let motion = &self.mean.as_slice()[k..2 * k];
            let v = parts(&model.generator(motion)).1;
            let changes = self.course.has_accelerations();
            let change_of = |j: usize| if changes { self.mean[2 * k + j] } else { 0.0 };
            // Half way through the step.
            let rates: [f64; LARGEST] =
                std::array::from_fn(|j| if j < k - 2 { motion[j] + 0.5 * dt * change_of(j) } else { 0.0 });
            let (turn, along) = model.linear_flow_with_integral(&rates[..k], dt);
            let turning = Vector2::new(self.mean[3 * k - 2], self.mean[3 * k - 1]);
            let pushed = self.pushed_along(step);
            let (shift, later) = match self.course {
                Course::ConstantVelocity { .. } => {
                    (v * dt + turned_along(&along, dt) * turning, v + turn * turning - turning)
                }
                _ if changes => (along * v + pushed * turning, turn * v + along * turning),
                _ => (along * v, turn * v),
            };
            self.carry_turned([&turn, &along, &pushed], [&v, &later], dt);
            self.set_velocity(&turn, &shift, &later);
            for (j, rate) in rates.iter().enumerate().take(k - 2) {
                self.mean[j] += dt * rate;
                self.mean[k + j] += if changes { dt * self.mean[2 * k + j] } else { 0.0 };
            }
        }
        self.add_change_of_accelerations(step);
        for j in 0..k - 2 {
            self.mean[j] += step.turned_by[j];
        }
        self.mean[k - 2] += step.centre.x;
        self.mean[k - 1] += step.centre.y;
        // Turns that differ by a round are the same; most are small, and stay.
        let turn = &mut self.mean[k - 3];
        if turn.abs() >= PI {
            *turn -= TAU * (*turn / TAU).round();
        }
    }

    /// Adds the way that the centroid has gone in a step, and sets the velocity after it.
    fn set_velocity(&mut self, turn: &Matrix2<f64>, shift: &Vector2<f64>, later: &Vector2<f64>) {
        let k = Self::K;
        for i in 0..2 {
            self.mean[k - 2 + i] += shift[i];
            self.mean[2 * k - 2 + i] = later[i];
        }
        if self.course.is_constant_velocity() {
            let turning = Vector2::new(self.mean[3 * k - 2], self.mean[3 * k - 1]);
            self.mean.fixed_rows_mut::<2>(3 * k - 2).copy_from(&(turn * turning));
        }
    }
}

/// `F P F'` of parameters that accelerate one by one: of each, `F = [[1, dt, dt^2 / 2], [0, 1, dt], [0, 0, 1]]`.
#[inline(always)]
fn carry_chains<const N: usize>(p: &mut [[f64; N]; N], dt: f64) {
    let (k, half) = (N / 3, 0.5 * dt * dt);
    for column in p.iter_mut() {
        for j in 0..k {
            column[j] += dt * column[k + j] + half * column[2 * k + j];
            column[k + j] += dt * column[2 * k + j];
        }
    }
    let (errors, others) = p.split_at_mut(k);
    let (motions, accelerations) = others.split_at_mut(k);
    for ((error, motion), acceleration) in errors.iter_mut().zip(motions).zip(accelerations) {
        for i in 0..N {
            error[i] += dt * motion[i] + half * acceleration[i];
            motion[i] += dt * acceleration[i];
        }
    }
}

#[cfg(test)]
mod tests {
    use freeform_riccati::MAX_PARAMETERS;
    use nalgebra::{Matrix3, Point2, SMatrix, SVector};
    use proptest::prelude::*;

    use super::*;
    use crate::dynamics::{CentredPose, centred::CentredVector, course::PointOfBody, usual_step::Units};

    const COURSES: [Course; 10] = [
        Course::ConstantGenerator,
        Course::straight(PointOfBody::NearCentroid),
        Course::straight(PointOfBody::Any),
        Course::ConstantVelocity { of: PointOfBody::Any, deviations: 2.0 },
        Course::Shaken { deviations: 4.0 },
        Course::Accelerating { level: 1e-1, rates: true },
        Course::Accelerating { level: 1e1, rates: false },
        Course::ChangingGenerator { level: 1e1 },
        Course::SteadyChange { turns: true },
        Course::SteadyChange { turns: false },
    ];

    /// It is pushed by none but its turn: of the velocity of the point that runs straight, `-A V` is a push that stays.
    #[test]
    fn a_body_that_spins_about_a_point_aside_which_runs_straight_has_a_generator_that_changes_steadily() {
        let still = CentredPose { pose: Matrix3::identity(), centroid: Point2::origin() };
        let variance = CentredVector::repeat(1.0);
        let (seconds, omega, aside, straight) = (0.7, 2.0, Vector2::new(0.4, -0.1), Vector2::new(0.3, 0.5));
        let step = Step::new((MotionModel::Rigid, seconds), [&still, &still], Units::of_usual_step(&variance, seconds))
            .expect("poses");
        let rates = parts(&MotionModel::Rigid.generator(&[omega, 0.0, 0.0])).0;
        let (velocity, push) = (straight + rates * aside, -(rates * straight));
        let mut mean = SVector::<f64, 9>::zeros();
        mean[3] = omega;
        mean.fixed_rows_mut::<2>(4).copy_from(&velocity);
        mean.fixed_rows_mut::<2>(7).copy_from(&push);
        let course = Course::ChangingGenerator { level: 1.0 };
        let mut hypothesis = Hypothesis::<9> { course, mean, covariance: SMatrix::identity() };
        for number in 1..=5 {
            assert!(hypothesis.predict(&step));
            let time = f64::from(number) * seconds;
            let turned = MotionModel::Rigid.linear_flow(&[omega, 0.0, 0.0], time) * aside;
            let [place, later] = [1, 4].map(|at| Vector2::new(hypothesis.mean[at], hypothesis.mean[at + 1]));
            assert!((place - (straight * time + turned - aside)).norm() < 1e-12, "{number}: {place}");
            assert!((later - (straight + rates * turned)).norm() < 1e-12, "{number}: {later}");
        }
    }

    /// Largest difference between the two ways, for a model of N / 3 parameters.
    fn difference<const N: usize>(model: MotionModel, numbers: &[f64], course: Course) -> f64 {
        let k = N / 3;
        let pose = |numbers: &[f64]| CentredPose {
            pose: model.flow(&numbers[..k], 1.0).into_inner(),
            centroid: Point2::new(0.1, -0.3),
        };
        let (from, to) = (pose(&numbers[..MAX_PARAMETERS]), pose(&numbers[MAX_PARAMETERS..]));
        let variance = CentredVector::from_fn(|j, _| 0.1 + numbers[j].abs());
        let step = Step::new((model, 0.7), [&from, &to], Units::of_usual_step(&variance, 0.7)).expect("poses");
        let root = SMatrix::<f64, N, N>::from_fn(|i, j| (7.0 * numbers[(3 * i + 5 * j) % numbers.len()]).sin());
        let in_use = |i: usize| course.has_more_than_motion() || i < 2 * k;
        let mean = SVector::<f64, N>::from_fn(|i, _| if in_use(i) { numbers[i] } else { 0.0 });
        let covariance = root * root.transpose();
        let covariance = SMatrix::from_fn(|i, j| if in_use(i) && in_use(j) { covariance[(i, j)] } else { 0.0 });
        let mut plain = Hypothesis::<N> { course, mean, covariance };
        let mut closed = plain.clone();
        assert!(plain.predict_any(&step));
        closed.predict_commuting(&step);
        (plain.mean - closed.mean).amax().max((plain.covariance - closed.covariance).amax())
    }

    proptest! {
        #[test]
        fn hypotheses_are_moved_on_in_closed_form_as_by_matrices(
            numbers in prop::collection::vec(-1.4_f64..1.4, 2 * MAX_PARAMETERS), which in 0..COURSES.len(),
        ) {
            let course = COURSES[which];
            let rigid = difference::<9>(MotionModel::Rigid, &numbers, course);
            let similarity = difference::<12>(MotionModel::Similarity, &numbers, course);
            prop_assert!(rigid.max(similarity) < 1e-11, "{course:?}: {rigid} {similarity}");
        }
    }

    #[test]
    fn a_turn_of_more_than_half_a_circle_is_one_the_other_way() {
        let pose = CentredPose { pose: Matrix3::identity(), centroid: Point2::origin() };
        let variance = CentredVector::repeat(1.0);
        let step =
            Step::new((MotionModel::Rigid, 1.0), [&pose, &pose], Units::of_usual_step(&variance, 1.0)).expect("poses");
        let mut hypothesis =
            Hypothesis::<9> { course: COURSES[3], mean: SVector::zeros(), covariance: SMatrix::identity() };
        hypothesis.mean[3] = 4.0;
        hypothesis.predict_commuting(&step);
        assert!((hypothesis.mean[0] - (4.0 - TAU)).abs() < 1e-15);
    }
}
