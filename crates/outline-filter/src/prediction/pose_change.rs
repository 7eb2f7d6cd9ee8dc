//! Changes of a motion by its rates and by the velocity of the object's centroid.
use freeform_riccati::{MAX_PARAMETERS, MotionModel, ParameterKind, map_point};
use nalgebra::{Matrix3, Point2, SMatrix};

/// One number for the rates of turning, growth and shear, and one for the velocities, both about the object's centroid. A thrown object
/// keeps the former, while the latter, which turn with it in the motions of the models, change all the time.
pub(crate) type ByKind = [f64; 2];

/// Which of the two a parameter of the motion belongs to.
pub(crate) fn kind_index(kind: ParameterKind) -> usize {
    usize::from(kind == ParameterKind::Velocity)
}

/// Motion parameters by the rates and velocities about the object's present centroid, which is given in the body frame.
pub(crate) fn centred_change(
    model: MotionModel,
    pose: &Matrix3<f64>,
    centroid: &Point2<f64>,
) -> Option<SMatrix<f64, MAX_PARAMETERS, MAX_PARAMETERS>> {
    let k = model.parameter_count();
    let centre = map_point(pose, centroid);
    let shift = Matrix3::new(1.0, 0.0, centre.x, 0.0, 1.0, centre.y, 0.0, 0.0, 1.0);
    let change = model.adjoint(&shift, &shift.try_inverse()?);
    Some(SMatrix::from_fn(|i, j| if i < k && j < k { change[i][j] } else { 0.0 }))
}
