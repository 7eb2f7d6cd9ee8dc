//! Errors of a pose about the centroid, as hypotheses have them: the rates of a map that leaves the centroid where it is, and a shift after it.
//!
//! Frames tell the logarithm of the whole map, whose velocity goes along with the turn. The shifts of both differ by half the turn times the shift:
//! nothing where the object is near the place at which it was expected, and several deviations where its motion has changed at once.
use freeform_riccati::{MAX_PARAMETERS, MotionModel, map_point};
use nalgebra::{Matrix2, Point2, Vector2};

use super::{
    centred::{CentredVector, moved_by},
    perspective::{in_centred_order, in_order_of_model, local_of, without_shift},
};

/// The error that a logarithm about the centroid is.
pub(super) fn of_logarithm(model: MotionModel, logarithm: &CentredVector) -> Option<CentredVector> {
    if model != MotionModel::Projective {
        return with_shift(model, logarithm, |along, velocity| Some(along * velocity));
    }
    let map = model.flow(&in_order_of_model(logarithm), 1.0).into_inner();
    let shift = map_point(&map, &Point2::origin());
    let mut error = in_centred_order(&model.motion_between(&local_of(&map)?, 1.0)?);
    error.fixed_rows_mut::<2>(MAX_PARAMETERS - 2).copy_from(&shift.coords);
    Some(error)
}

/// The logarithm about the centroid of an error.
pub(super) fn logarithm_of(model: MotionModel, error: &CentredVector) -> Option<CentredVector> {
    if model != MotionModel::Projective {
        return with_shift(model, error, |along, shift| Some(along.try_inverse()? * shift));
    }
    let shift = error.fixed_rows::<2>(MAX_PARAMETERS - 2);
    let map = moved_by(shift[0], shift[1]) * without_shift(error, 1.0);
    Some(in_centred_order(&model.motion_between(&map, 1.0)?))
}

/// With the last two entries worked out from how far the rates carry a velocity.
fn with_shift(
    model: MotionModel,
    from: &CentredVector,
    shift: impl Fn(Matrix2<f64>, Vector2<f64>) -> Option<Vector2<f64>>,
) -> Option<CentredVector> {
    let k = model.parameter_count();
    let (_, along) = model.linear_flow_with_integral(&from.as_slice()[..k], 1.0);
    let mut to = *from;
    to.fixed_rows_mut::<2>(k - 2).copy_from(&shift(along, from.fixed_rows::<2>(k - 2).into_owned())?);
    Some(to)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::dynamics::centred::{CentredPose, centred_generator};

    proptest! {
        #[test]
        fn an_error_moves_the_centroid_by_its_shift_and_turns_the_object_about_it(
            numbers in prop::array::uniform8(-0.4_f64..0.4),
        ) {
            for model in MotionModel::ALL {
                let k = model.parameter_count();
                let logarithm = CentredVector::from_fn(|j, _| if j < k { numbers[j] } else { 0.0 });
                let error = of_logarithm(model, &logarithm).expect("small");
                let generator = centred_generator(model, &logarithm.as_slice()[..k]);
                let map = generator.exp();
                let shift = map_point(&map, &Point2::origin());
                prop_assert!((error.fixed_rows::<2>(k - 2) - shift.coords).amax() < 1e-9, "{model}");
                let local = CentredPose { pose: map, centroid: Point2::origin() }.local(model);
                let mut alone = error;
                alone.fixed_rows_mut::<2>(k - 2).fill(0.0);
                let mut expected = centred_generator(model, &alone.as_slice()[..k]).exp();
                expected /= expected[(2, 2)];
                prop_assert!((local - expected).amax() < 1e-9, "{model}: {local} {expected}");
                let back = logarithm_of(model, &error).expect("small");
                prop_assert!((back - logarithm).amax() < 1e-9, "{model}: {back} {logarithm}");
            }
        }
    }
}
