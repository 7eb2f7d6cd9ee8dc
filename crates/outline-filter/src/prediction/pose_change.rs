//! Changes of a motion by its rates and by the velocity of the object's centroid.
use freeform_riccati::{MAX_PARAMETERS, MotionModel, ParameterKind, map_point};
use nalgebra::{Matrix3, Point2, SMatrix};

/// One entry for each two parameters of a pose.
pub(crate) type PoseMatrix = SMatrix<f64, MAX_PARAMETERS, MAX_PARAMETERS>;

/// One number for the rates of turning, growth and shear, and one for the velocities, both about the object's centroid. A thrown object
/// keeps the former, while the latter, which turn with it in the motions of the models, change all the time.
pub(crate) type ByKind = [f64; 2];

/// When in a step the motion has changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum TimeOfChange {
    /// At its beginning: small changes in every step, of which innovations tell the size.
    Beginning,
    /// At any time, or all the time: one large change, of which the pose at the end leaves a quarter of the variance untold.
    Any,
}

/// Which of the two a parameter of the motion belongs to.
pub(crate) fn kind_index(kind: ParameterKind) -> usize {
    usize::from(kind == ParameterKind::Velocity)
}

/// Motion parameters by the rates and velocities about the object's present centroid, which is given in the body frame.
pub(crate) fn centred_change(model: MotionModel, pose: &Matrix3<f64>, centroid: &Point2<f64>) -> Option<PoseMatrix> {
    let centre = map_point(pose, centroid);
    let shift = Matrix3::new(1.0, 0.0, centre.x, 0.0, 1.0, centre.y, 0.0, 0.0, 1.0);
    Some(adjoint_matrix(model, &shift, &shift.try_inverse()?))
}

/// The adjoint of a map, with nothing beyond the parameters of the model.
pub(crate) fn adjoint_matrix(model: MotionModel, map: &Matrix3<f64>, inverse: &Matrix3<f64>) -> PoseMatrix {
    let (change, k) = (model.adjoint(map, inverse), model.parameter_count());
    PoseMatrix::from_fn(|i, j| if i < k && j < k { change[i][j] } else { 0.0 })
}

/// A covariance of errors in some coordinates as one in those that a map takes them to; `None` where that is beyond any number.
pub(crate) fn moved_covariance(model: MotionModel, covariance: &PoseMatrix, map: &Matrix3<f64>) -> Option<PoseMatrix> {
    let change = adjoint_matrix(model, map, &map.try_inverse()?);
    let moved = change * covariance * change.transpose();
    moved.iter().all(|entry| entry.is_finite()).then_some(moved)
}
