//! What the measured poses of all frames have in common.
use freeform_riccati::{MAX_PARAMETERS, MotionModel, map_point};
use nalgebra::{Matrix2, Matrix3, Point2, SMatrix, SVector};

use super::centred::{CentredMatrix, CentredPose, LARGEST, as_map};

/// The outline as a whole lies where the first frame has shown it, with an error that all poses measured against it have in common: no
/// number of frames takes it off a pose that is counted from the first. It goes along with the object.
///
/// The outline is learnt on, by poses that one of the hypotheses expects. If that one is wrong they take the outline with them. Poses are
/// therefore counted from where it was when the hypotheses began.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct CommonError {
    model: MotionModel,
    /// About the middle, when the second frame was seen.
    covariance: CentredMatrix,
    /// Linear part of the pose then.
    linear: Matrix2<f64>,
    /// By which the outline as a whole has moved since then, in the body frame.
    shift: SVector<f64, MAX_PARAMETERS>,
}

impl CommonError {
    /// From what is believed after two frames: half of the covariance of the pose comes from the first.
    pub(super) fn of_two_frames<const N: usize>(
        model: MotionModel,
        covariance: &SMatrix<f64, N, N>,
        reference: &CentredPose,
    ) -> Self {
        let k = model.parameter_count();
        let half = CentredMatrix::from_fn(|i, j| if i < k && j < k { 0.5 * covariance[(i, j)] } else { 0.0 });
        Self { model, covariance: half, linear: reference.linear(), shift: SVector::zeros() }
    }

    /// Takes it off a covariance of the error of the pose and of the motion over a step from the first frame. What is left is that of
    /// the pose as it is measured, this error included, with which that of the motion is correlated.
    pub(super) fn take_off<const N: usize>(&self, covariance: &mut SMatrix<f64, N, N>, seconds: f64) {
        let k = self.model.parameter_count();
        for i in 0..k {
            for j in 0..k {
                let common = self.covariance[(i, j)];
                covariance[(i, j)] -= common;
                covariance[(i, k + j)] -= common / seconds;
                covariance[(k + i, j)] -= common / seconds;
            }
        }
    }

    /// Its covariance about the middle in a pose.
    pub(super) fn covariance_in(&self, pose: &CentredPose) -> Option<CentredMatrix> {
        let map = as_map(&(pose.linear() * self.linear.try_inverse()?));
        let (change, k) = (self.model.adjoint(&map, &map.try_inverse()?), self.model.parameter_count());
        let change = CentredMatrix::from_fn(|i, j| if i < k && j < k { change[i][j] } else { 0.0 });
        let turned = change * self.covariance * change.transpose();
        turned.iter().all(|entry| entry.is_finite()).then_some(turned)
    }

    /// Adds it to the covariance of what is measured with a probability, at these rates of the motion. The middle, too, is known no better
    /// than this, and what accelerates does so in the middle: at a point aside, the rates move it besides.
    pub(super) fn add_to<const N: usize>(
        &self,
        covariance: &mut SMatrix<f64, N, N>,
        pose: &CentredPose,
        (measured, accelerated): (f64, f64),
        rates: &Matrix2<f64>,
    ) -> Option<()> {
        let (common, k) = (self.covariance_in(pose)?, self.model.parameter_count());
        let mut of_pose = covariance.fixed_view_mut::<LARGEST, LARGEST>(0, 0);
        of_pose += common * measured;
        let of_middle = rates * common.fixed_view::<2, 2>(k - 2, k - 2) * rates.transpose();
        let mut of_velocity = covariance.fixed_view_mut::<2, 2>(2 * k - 2, 2 * k - 2);
        of_velocity += of_middle * accelerated;
        Some(())
    }

    /// Takes it that the outline as a whole has moved, in the body frame, and with it what later poses are measured against.
    pub(super) fn take_shift(&mut self, shift: &SVector<f64, MAX_PARAMETERS>) {
        self.shift += shift;
    }

    /// The error of a pose, on the left, by which the outline has moved.
    pub(super) fn shift_in(&self, pose: &Matrix3<f64>) -> SVector<f64, MAX_PARAMETERS> {
        let Some(inverse) = pose.try_inverse() else { return SVector::zeros() };
        let (change, k) = (self.model.adjoint(pose, &inverse), self.model.parameter_count());
        SVector::from_fn(|i, _| if i < k { (0..k).map(|j| change[i][j] * self.shift[j]).sum() } else { 0.0 })
    }

    /// Where a point of the outline was in the body frame before it moved.
    pub(super) fn before(&self, point: &Point2<f64>) -> Point2<f64> {
        map_point(&self.back(), point)
    }

    /// The pose in which the outline as it is now lies where it would have lain in the pose given before it moved.
    pub(super) fn of_outline_now(&self, pose: &Matrix3<f64>) -> Matrix3<f64> {
        pose * self.back()
    }

    fn back(&self) -> Matrix3<f64> {
        let k = self.model.parameter_count();
        self.model.flow(&(-self.shift).as_slice()[..k], 1.0).into_inner()
    }

    #[cfg(feature = "serde")]
    pub(super) fn is_sound(&self, model: MotionModel) -> bool {
        let numbers = self.covariance.iter().chain(&self.linear).chain(&self.shift);
        self.model == model && numbers.into_iter().all(|entry| entry.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reference() -> CentredPose {
        CentredPose { pose: Matrix3::identity(), middle: Point2::new(0.3, -0.2) }
    }

    fn of_two_frames() -> SMatrix<f64, 9, 9> {
        let one = SMatrix::<f64, 3, 3>::new(0.02, 0.001, 0.0, 0.001, 0.03, 0.002, 0.0, 0.002, 0.05);
        let mut covariance = SMatrix::zeros();
        for (row, column, factor) in [(0, 0, 2.0), (0, 3, 20.0), (3, 0, 20.0), (3, 3, 200.0)] {
            covariance.fixed_view_mut::<3, 3>(row, column).copy_from(&(one * factor));
        }
        covariance
    }

    #[test]
    fn what_is_left_of_two_frames_is_the_error_of_the_second_and_the_motion_between_both() {
        let mut covariance = of_two_frames();
        let one = covariance.fixed_view::<3, 3>(0, 0) * 0.5;
        let common = CommonError::of_two_frames(MotionModel::Rigid, &covariance, &reference());
        common.take_off(&mut covariance, 0.1);
        assert!((covariance.fixed_view::<3, 3>(0, 0) - one).amax() < 1e-15);
        // A step before, the error was that of the first frame alone, and independent of that of the second.
        let mut step = SMatrix::<f64, 9, 9>::identity();
        (0..3).for_each(|i| step[(i, 3 + i)] = -0.1);
        let first = step * covariance * step.transpose();
        assert!((first.fixed_view::<3, 3>(0, 0) - one).amax() < 1e-15);
        assert!((step * covariance).fixed_view::<3, 3>(0, 0).amax() < 1e-15);
    }

    #[test]
    fn it_goes_along_with_the_object() {
        let common = CommonError::of_two_frames(MotionModel::Rigid, &of_two_frames(), &reference());
        let turned = CentredPose {
            pose: MotionModel::Rigid.flow(&[-std::f64::consts::FRAC_PI_2, 3.0, 1.0], 1.0).into_inner(),
            ..reference()
        };
        let [here, there] = [reference(), turned].map(|pose| common.covariance_in(&pose).expect("a pose"));
        assert!((here[(0, 0)] - there[(0, 0)]).abs() < 1e-15);
        assert!((here[(1, 1)] - there[(2, 2)]).abs() < 1e-15 && (here[(2, 2)] - there[(1, 1)]).abs() < 1e-15);
    }

    #[test]
    fn a_pose_of_the_outline_that_has_moved_shows_its_points_where_they_were() {
        let mut common = CommonError::of_two_frames(MotionModel::Rigid, &of_two_frames(), &reference());
        common.take_shift(&SVector::from([0.02, 0.01, -0.03, 0.0, 0.0, 0.0, 0.0, 0.0]));
        let pose = MotionModel::Rigid.flow(&[0.7, 0.2, 0.1], 1.0).into_inner();
        let point = Point2::new(0.4, 0.5);
        let seen = map_point(&pose, &common.before(&point));
        assert!((seen - map_point(&common.of_outline_now(&pose), &point)).norm() < 1e-15);
        let error = common.shift_in(&pose);
        let moved = MotionModel::Rigid.flow(&error.as_slice()[..3], 1.0).into_inner() * common.of_outline_now(&pose);
        assert!((moved - pose).amax() < 1e-3);
    }
}
