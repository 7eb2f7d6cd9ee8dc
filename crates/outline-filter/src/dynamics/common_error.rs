//! What the measured poses of all frames have in common.
use freeform_riccati::{MAX_PARAMETERS, MotionModel, map_point};
use nalgebra::{Matrix2, Matrix3, Point2, SMatrix, SVector};

use crate::{
    prediction::{PoseMatrix, moved_covariance},
    tuning::map::FRAMES_OF_CENTROID,
};

use super::centred::{CentredMatrix, CentredPose, LARGEST, centred_order};
#[cfg(feature = "serde")]
use freeform_estimate::StateFormat;

/// The outline as a whole lies where the first frame has shown it, with an error that all poses measured against it have in common: no
/// number of frames takes it off a pose that is counted from the first. It goes along with the object.
///
/// The outline is learnt on, by poses that one of the hypotheses expects. If that one is wrong they take the outline with them. Poses are
/// therefore counted from where it was when the hypotheses began.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct CommonError {
    model: MotionModel,
    /// When the hypotheses began, or later where it was larger.
    largest: ErrorInPose,
    /// As the outline was known in the last frame in which others than a constant generator led; before that, when the hypotheses began.
    now: ErrorInPose,
    /// Motion of the body frame by which the outline as a whole has moved since then.
    shift: SVector<f64, MAX_PARAMETERS>,
}

/// An error of the body frame, as one of a pose.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct ErrorInPose {
    /// About the centroid.
    covariance: CentredMatrix,
    /// The pose, with the centroid for origin.
    local: Matrix3<f64>,
}

impl ErrorInPose {
    /// Its covariance about the centroid in another pose.
    fn covariance_in(&self, pose: &CentredPose, model: MotionModel) -> Option<CentredMatrix> {
        let map = pose.local(model) * self.local.try_inverse()?;
        let (change, k) = (model.adjoint(&map, &map.try_inverse()?), model.parameter_count());
        let order = centred_order(model);
        let change = CentredMatrix::from_fn(|i, j| if i < k && j < k { change[order[i]][order[j]] } else { 0.0 });
        let turned = change * self.covariance * change.transpose();
        turned.iter().all(|entry| entry.is_finite()).then_some(turned)
    }
}

impl CommonError {
    /// From the covariance of pose and motion, and the one that both have if the outline is known exactly: what the outline adds to that of
    /// the pose.
    pub(super) fn of_outline<const N: usize>(
        model: MotionModel,
        covariance: &SMatrix<f64, N, N>,
        given_outline: &SMatrix<f64, N, N>,
        reference: &CentredPose,
    ) -> Self {
        let k = model.parameter_count();
        let added = |i: usize, j: usize| covariance[(i, j)] - given_outline[(i, j)];
        let covariance = CentredMatrix::from_fn(|i, j| if i < k && j < k { added(i, j) } else { 0.0 });
        let error = ErrorInPose { covariance, local: reference.local(model) };
        Self { model, largest: error, now: error, shift: SVector::zeros() }
    }

    /// Adds it, as the outline is known now, to the covariance of what is measured with a probability, at these rates of the motion. The centroid,
    /// too, is known no better than this, and what accelerates does so in the centroid: at a point aside, the rates move it besides.
    pub(super) fn add_to<const N: usize>(
        &self,
        covariance: &mut SMatrix<f64, N, N>,
        pose: &CentredPose,
        (measured, accelerated): (f64, f64),
        rates: &Matrix2<f64>,
    ) -> Option<()> {
        let (common, k) = (self.now.covariance_in(pose, self.model)?, self.model.parameter_count());
        let mut of_pose = covariance.fixed_view_mut::<LARGEST, LARGEST>(0, 0);
        of_pose += common * measured;
        let of_centroid = rates * common.fixed_view::<2, 2>(k - 2, k - 2) * rates.transpose();
        let mut of_velocity = covariance.fixed_view_mut::<2, 2>(2 * k - 2, 2 * k - 2);
        of_velocity += of_centroid * accelerated;
        Some(())
    }

    /// Takes the covariance of another for that of now, of the same poses, and for the largest, where it is larger. It falls with the number of
    /// frames, as errors of offsets are taken to be independent, but to no less than what is left of the largest where the centroid is placed for the
    /// last time.
    pub(super) fn renew(&mut self, other: &Self, pose: &CentredPose) {
        self.now = other.now;
        let Some(largest) = self.largest.covariance_in(pose, self.model) else { return };
        let least = largest / *FRAMES_OF_CENTROID.end() as f64;
        if self.now.covariance.trace() > largest.trace() {
            self.largest = self.now;
        } else if self.now.covariance.trace() < least.trace() {
            self.now.covariance = least;
        }
    }

    /// The covariance of where the body frame lies beside the outline as it is known now, about the origin, as an error that all poses have: what the
    /// error of the outline was at its largest, less what it is now.
    pub(super) fn beyond_now(&self, pose: &CentredPose) -> Option<PoseMatrix> {
        if self.largest == self.now {
            return Some(PoseMatrix::zeros());
        }
        let model = self.model;
        let beyond = self.largest.covariance_in(pose, model)? - self.now.covariance_in(pose, model)?;
        let axes = (0.5 * (beyond + beyond.transpose())).symmetric_eigen();
        let positive = PoseMatrix::from_diagonal(&axes.eigenvalues.map(|value| value.max(0.0)));
        let change = pose.about_origin(model)? * axes.eigenvectors;
        Some(change * positive * change.transpose())
    }

    /// Where a point of the body frame was before the outline moved.
    pub(super) fn before(&self, point: &Point2<f64>) -> Point2<f64> {
        map_point(&self.way_back(), point)
    }

    /// Adds a displacement of the whole outline in the body frame, which later poses are measured against.
    pub(super) fn add_shift(&mut self, shift: &SVector<f64, MAX_PARAMETERS>) {
        self.shift += shift;
    }

    /// The error of a pose, on the left, by which the outline has moved.
    pub(super) fn shift_in(&self, pose: &Matrix3<f64>) -> SVector<f64, MAX_PARAMETERS> {
        let Some(inverse) = pose.try_inverse() else { return SVector::zeros() };
        let (change, k) = (self.model.adjoint(pose, &inverse), self.model.parameter_count());
        SVector::from_fn(|i, _| if i < k { (0..k).map(|j| change[i][j] * self.shift[j]).sum() } else { 0.0 })
    }

    /// The pose in which the outline as it is now lies where it would have lain in the pose given before it moved.
    pub(super) fn of_outline_now(&self, pose: &Matrix3<f64>) -> Matrix3<f64> {
        pose * self.way_back()
    }

    /// The map of the body frame from where the outline is now to where it was before it moved.
    fn way_back(&self) -> Matrix3<f64> {
        let k = self.model.parameter_count();
        self.model.flow(&(-self.shift).as_slice()[..k], 1.0).into_inner()
    }

    /// As the covariance of an error of the body frame, of one that has the outline as it is now: what all poses have in common, and what the outline
    /// has been moved by since the hypotheses began.
    pub(super) fn of_body_frame(&self, pose: &CentredPose) -> Option<PoseMatrix> {
        let model = self.model;
        let common = self.largest.covariance_in(pose, model)?;
        let change = pose.about_origin(model)?;
        let in_body = moved_covariance(model, &(change * common * change.transpose()), &pose.pose.try_inverse()?)?;
        Some(in_body + self.shift * self.shift.transpose())
    }

    #[cfg(feature = "serde")]
    pub(super) fn is_valid(&self, model: MotionModel) -> bool {
        let errors = || [&self.largest, &self.now].into_iter();
        let numbers = errors().flat_map(|error| error.covariance.iter().chain(&error.local)).chain(&self.shift);
        let is_in_bounds = numbers.into_iter().all(|entry| entry.abs() <= StateFormat::LARGEST_NUMBER);
        self.model == model && is_in_bounds && errors().all(|error| error.local.try_inverse().is_some())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reference() -> CentredPose {
        CentredPose { pose: Matrix3::identity(), centroid: Point2::new(0.3, -0.2) }
    }

    /// After two frames, a tenth of a second apart, whose poses have this covariance each; and the same with the outline given.
    fn of_two_frames() -> [SMatrix<f64, 9, 9>; 2] {
        let one = SMatrix::<f64, 3, 3>::new(0.02, 0.001, 0.0, 0.001, 0.03, 0.002, 0.0, 0.002, 0.05);
        [2.0, 1.0].map(|times| {
            let mut covariance = SMatrix::<f64, 9, 9>::zeros();
            for (row, column, factor) in [(0, 0, 1.0), (0, 3, 10.0), (3, 0, 10.0), (3, 3, 100.0)] {
                covariance.fixed_view_mut::<3, 3>(row, column).copy_from(&(one * factor * times));
            }
            covariance
        })
    }

    fn common_error() -> CommonError {
        let [covariance, given_outline] = of_two_frames();
        CommonError::of_outline(MotionModel::Rigid, &covariance, &given_outline, &reference())
    }

    #[test]
    fn after_two_frames_the_common_error_is_that_of_the_first() {
        let expected = of_two_frames()[1].fixed_view::<3, 3>(0, 0).into_owned();
        assert!((common_error().now.covariance.fixed_view::<3, 3>(0, 0) - expected).amax() < 1e-15);
    }

    #[test]
    fn in_the_body_frame_the_common_error_is_the_same_wherever_the_object_has_gone() {
        let quarter = MotionModel::Rigid.flow(&[-std::f64::consts::FRAC_PI_2, 3.0, 1.0], 1.0).into_inner();
        let turned = CentredPose { pose: quarter, ..reference() };
        let [here, there] = [reference(), turned].map(|pose| common_error().of_body_frame(&pose).expect("a pose"));
        assert!((here - there).amax() < 1e-14, "{here} {there}");
        // There it was the identity that the hypotheses began in.
        let from = reference().about_origin(MotionModel::Rigid).expect("a pose").fixed_view::<3, 3>(0, 0).into_owned();
        let expected = from * common_error().now.covariance.fixed_view::<3, 3>(0, 0) * from.transpose();
        assert!((here.fixed_view::<3, 3>(0, 0) - expected).amax() < 1e-14);
    }

    #[test]
    fn the_common_error_grows_as_the_outline_that_is_seen_becomes_another_and_never_shrinks() {
        let [covariance, given_outline] = of_two_frames();
        let shift = SVector::from_element(0.1);
        for (times, kept) in [(0.5, true), (3.0, false)] {
            let mut common = CommonError { shift, ..common_error() };
            let now = [covariance, given_outline].map(|covariance| covariance * times);
            common.renew(&CommonError::of_outline(MotionModel::Rigid, &now[0], &now[1], &reference()), &reference());
            let expected = common_error().largest.covariance * if kept { 1.0 } else { times };
            assert!((common.largest.covariance - expected).amax() < 1e-15 && common.shift == shift, "{times}");
        }
    }

    #[test]
    fn what_the_outline_is_known_better_by_than_at_first_is_left_with_the_body_frame() {
        let [covariance, given_outline] = of_two_frames();
        let mut common = common_error();
        assert!(common.beyond_now(&reference()).expect("a pose").amax() < 1e-15);
        let now = [covariance, given_outline].map(|covariance| covariance * 0.25);
        common.renew(&CommonError::of_outline(MotionModel::Rigid, &now[0], &now[1], &reference()), &reference());
        let change = reference().about_origin(MotionModel::Rigid).expect("a pose");
        let expected = change * (common.largest.covariance * 0.75) * change.transpose();
        let beyond = common.beyond_now(&reference()).expect("a pose");
        assert!((beyond - expected).amax() < 1e-14, "{beyond} {expected}");
        // In many frames no less than what the centroid has in error for good.
        let now = [covariance, given_outline].map(|covariance| covariance * 1e-6);
        common.renew(&CommonError::of_outline(MotionModel::Rigid, &now[0], &now[1], &reference()), &reference());
        assert!((common.now.covariance - common.largest.covariance / 64.0).amax() < 1e-15);
        // Nowhere less than none, where some of it is larger now and some smaller.
        common.now.covariance[(0, 0)] = 2.0 * common.largest.covariance[(0, 0)];
        let beyond = common.beyond_now(&reference()).expect("a pose");
        assert!(beyond.symmetric_eigenvalues().min() > -1e-14 && beyond.amax() > 1e-3, "{beyond}");
    }

    #[test]
    fn the_common_error_goes_along_with_the_object() {
        let quarter = MotionModel::Rigid.flow(&[-std::f64::consts::FRAC_PI_2, 3.0, 1.0], 1.0).into_inner();
        let turned = CentredPose { pose: quarter, ..reference() };
        let [here, there] = [reference(), turned]
            .map(|pose| common_error().now.covariance_in(&pose, MotionModel::Rigid).expect("a pose"));
        assert!((here[(0, 0)] - there[(0, 0)]).abs() < 1e-15);
        assert!((here[(1, 1)] - there[(2, 2)]).abs() < 1e-15 && (here[(2, 2)] - there[(1, 1)]).abs() < 1e-15);
    }

    #[test]
    fn a_pose_of_the_outline_that_has_moved_shows_its_points_where_they_were() {
        let mut common = common_error();
        let shift = [0.02, 0.01, -0.03];
        common.add_shift(&SVector::from([0.02, 0.01, -0.03, 0.0, 0.0, 0.0, 0.0, 0.0]));
        let pose = MotionModel::Rigid.flow(&[0.7, 0.2, 0.1], 1.0).into_inner();
        let point = Point2::new(0.4, 0.5);
        let moved = map_point(MotionModel::Rigid.flow(&shift, 1.0).matrix(), &point);
        assert!((common.before(&moved) - point).norm() < 1e-15);
        assert!((map_point(&common.of_outline_now(&pose), &moved) - map_point(&pose, &point)).norm() < 1e-15);
        let error = common.shift_in(&pose);
        let counted = MotionModel::Rigid.flow(&error.as_slice()[..3], 1.0).into_inner() * common.of_outline_now(&pose);
        assert!((counted - pose).amax() < 1e-3);
    }
}
