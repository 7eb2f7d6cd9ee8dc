//! What a hypothesis begins with.
use freeform_riccati::MotionModel;
use nalgebra::{SMatrix, SVector};

use super::{
    centred::{CentredVector, by_rates, carry},
    course::Course,
    hypothesis::Hypothesis,
};

impl<const N: usize> Hypothesis<N> {
    /// Begins with mean and covariance of pose and motion, the motion being that of the step of so many seconds before.
    pub(super) fn begin(
        (course, model): (Course, MotionModel),
        (mean, covariance): (SVector<f64, N>, SMatrix<f64, N, N>),
        (pose_variance, seconds): (&CentredVector, f64),
    ) -> Self {
        let mut hypothesis = Self { course, mean, covariance };
        if course.has_run_straight() {
            hypothesis.take_way_as_straight(model, seconds);
        }
        if course.has_more_than_motion() {
            hypothesis.add_unknown(model, (pose_variance, seconds), 1.0);
        }
        if course.has_accelerations() {
            let k = Self::K;
            // The motion known so far is the mean over the step: half of it ago.
            for j in 0..k {
                let (u, a) = (k + j, 2 * k + j);
                let prior = hypothesis.covariance[(a, a)];
                hypothesis.covariance[(u, u)] += 0.25 * seconds * seconds * prior;
                hypothesis.covariance[(u, a)] = 0.5 * seconds * prior;
                hypothesis.covariance[(a, u)] = 0.5 * seconds * prior;
            }
        }
        hypothesis
    }

    /// Takes the way of the step that has led here, that of a constant generator so far, to have been straight: between the same two poses. Where an object
    /// turns by some tenths of a rad from frame to frame, the velocity at the end of an arc is many deviations off that along its chord.
    fn take_way_as_straight(&mut self, model: MotionModel, seconds: f64) {
        let k = Self::K;
        let motion = &self.mean.as_slice()[k..2 * k];
        // In centred order the rates come first, perspective or not.
        let (of_rates, count) = if model == MotionModel::Projective { (MotionModel::Affine, 6) } else { (model, k) };
        let back = of_rates.linear_flow_with_integral(&motion[..count], -seconds).1 / -seconds;
        let chord = back * self.mean.fixed_rows::<2>(2 * k - 2);
        let mut change = SMatrix::<f64, N, N>::identity();
        change.fixed_view_mut::<2, 2>(2 * k - 2, 2 * k - 2).copy_from(&back);
        for (j, by_rate) in by_rates(model, &(chord * (-0.5 * seconds))).enumerate() {
            change.fixed_view_mut::<2, 1>(2 * k - 2, k + j).copy_from(&by_rate);
        }
        self.mean.fixed_rows_mut::<2>(2 * k - 2).copy_from(&chord);
        carry(&change, &mut self.covariance, 2 * k);
    }

    /// Takes next to nothing to be known of the entries behind the motion, which depend on no others then; `share` of the variance is added.
    pub(super) fn add_unknown(
        &mut self,
        model: MotionModel,
        (pose_variance, seconds): (&CentredVector, f64),
        share: f64,
    ) {
        let k = Self::K;
        if let Course::ConstantVelocity { of, .. } = self.course {
            let rates = self.rates(model) * of.off_centroid();
            let added = share * rates * rates.transpose();
            let mut block = self.covariance.fixed_view_mut::<2, 2>(3 * k - 2, 3 * k - 2);
            block += added;
        } else {
            let prior = self.course.acceleration_prior(pose_variance, k, seconds);
            (2 * k..3 * k).for_each(|i| self.covariance[(i, i)] += share * prior[i - 2 * k]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::course::PointOfBody;

    /// Begun with an arc of so many rates and a velocity of the centroid, its velocity then.
    fn begun<const N: usize>(model: MotionModel, motion: &[f64], covariance: SMatrix<f64, N, N>) -> Hypothesis<N> {
        let mean = SVector::from_fn(|i, _| if (N / 3..2 * N / 3).contains(&i) { motion[i - N / 3] } else { 0.0 });
        let course = Course::straight(PointOfBody::NearCentroid);
        Hypothesis::begin((course, model), (mean, covariance), (&CentredVector::repeat(1.0), SECONDS))
    }

    const SECONDS: f64 = 0.1;

    fn check_chord<const N: usize>(model: MotionModel, motion: &[f64]) {
        let k = N / 3;
        let back = model.flow(motion, -SECONDS).into_inner();
        let chord = -back.fixed_view::<2, 1>(0, 2) / SECONDS;
        let found = begun::<N>(model, motion, SMatrix::zeros()).mean;
        assert!((found.fixed_rows::<2>(2 * k - 2) - chord).amax() < 1e-12, "{found} {chord}");
        for j in 0..k {
            let moved = |by: f64| {
                let mut motion = motion.to_vec();
                motion[j] += by;
                begun::<N>(model, &motion, SMatrix::zeros()).mean
            };
            let difference = (moved(1e-5) - moved(-1e-5)) / 2e-5;
            let error = SVector::<f64, N>::from_fn(|i, _| f64::from(u8::from(i == k + j)));
            let carried = begun::<N>(model, motion, error * error.transpose()).covariance;
            let column = carried.column(k + j) / carried[(k + j, k + j)].sqrt();
            // To the second order of a step, and of what is known beyond the motion nothing is asked.
            let (difference, column) = (difference.fixed_rows::<2>(2 * k - 2), column.fixed_rows::<2>(2 * k - 2));
            assert!((difference - column).amax() < 0.5 * SECONDS * SECONDS, "{j}: {difference} {column}");
        }
    }

    #[test]
    fn a_constant_velocity_begins_between_the_same_two_places_as_the_generator_that_was_believed() {
        check_chord::<9>(MotionModel::Rigid, &[1.5, 0.7, -0.4]);
        check_chord::<12>(MotionModel::Similarity, &[0.3, 1.5, 0.7, -0.4]);
        check_chord::<18>(MotionModel::Affine, &[0.4, 1.2, -0.9, -0.2, 0.7, -0.4]);
    }
}
