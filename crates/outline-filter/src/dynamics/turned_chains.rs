//! Covariances of affine motion that accelerates, moved on without a matrix of the transition, most of whose entries are zero.
use nalgebra::Matrix2;

use crate::vectors::vectorised;

/// Rates of affine motion: the entries of a linear map, row by row.
pub(super) const RATES: usize = 4;

/// How a linear map carries rates: `T A T^-1` by A, in columns.
pub(super) type Carried = [[f64; RATES]; RATES];

pub(super) fn carried_by(map: &Matrix2<f64>) -> Carried {
    let inverse = map.try_inverse().unwrap_or(*map);
    std::array::from_fn(|of| std::array::from_fn(|to| map[(to / 2, of / 2)] * inverse[(of % 2, to % 2)]))
}

/// `F P F'` of the covariance of affine motion that accelerates for the time `dt`, given by its columns, over a step that carries the rates by
/// `turn`. Half of the motion comes before that and half after it, so that of the rates
/// `F = [[T, (I + T) dt / 2, I dt^2 / 2], [0, I, I dt], [0, 0, I]]`; what belongs to the centroid is not carried.
pub(super) fn carry_turned_chains<const N: usize>(p: &mut [[f64; N]; N], turn: &Matrix2<f64>, dt: f64) {
    debug_assert_eq!(N, 3 * (RATES + 2));
    let carried = carried_by(turn);
    vectorised(
        #[inline(always)]
        || carry(p, &carried, dt),
    );
}

#[inline(always)]
fn carry<const N: usize>(p: &mut [[f64; N]; N], carried: &Carried, dt: f64) {
    let (k, half, of_acceleration) = (N / 3, 0.5 * dt, 0.5 * dt * dt);
    for column in p.iter_mut() {
        let mut moved = *column;
        for i in 0..k {
            moved[i] = if i < RATES { half } else { dt } * column[k + i] + of_acceleration * column[2 * k + i];
            moved[k + i] = column[k + i] + dt * column[2 * k + i];
        }
        for (j, carried) in carried.iter().enumerate() {
            let before = column[j] + half * column[k + j];
            for i in 0..RATES {
                moved[i] += carried[i] * before;
            }
        }
        for i in RATES..k {
            moved[i] += column[i];
        }
        *column = moved;
    }
    let (errors, others) = p.split_at_mut(k);
    let (motions, accelerations) = others.split_at_mut(k);
    let before: [[f64; N]; RATES] = std::array::from_fn(|j| {
        let (error, motion) = (&errors[j], &motions[j]);
        std::array::from_fn(|i| error[i] + half * motion[i])
    });
    for (j, ((error, motion), acceleration)) in errors.iter_mut().zip(motions).zip(accelerations).enumerate() {
        let (mut moved, by_motion) = (*error, if j < RATES { half } else { dt });
        let (of_motion, of_error) = (*motion, if j < RATES { 0.0 } else { 1.0 });
        for i in 0..N {
            moved[i] = of_error * moved[i] + by_motion * of_motion[i] + of_acceleration * acceleration[i];
        }
        if j < RATES {
            for (before, carried) in before.iter().zip(carried) {
                let factor = carried[j];
                for i in 0..N {
                    moved[i] += factor * before[i];
                }
            }
        }
        *error = moved;
        let mut moved = of_motion;
        for i in 0..N {
            moved[i] += dt * acceleration[i];
        }
        *motion = moved;
    }
}

#[cfg(test)]
mod tests {
    use freeform_riccati::MotionModel;
    use nalgebra::{Point2, SMatrix, SVector, Vector2};
    use proptest::prelude::*;

    use super::*;
    use crate::dynamics::{
        CentredPose,
        centred::{CentredVector, as_map, carried},
        course::Course,
        hypothesis::Hypothesis,
        step::Step,
        usual_step::Units,
    };

    proptest! {
        #[test]
        fn covariances_of_affine_motion_that_accelerates_are_moved_on_as_by_matrices(
            numbers in prop::collection::vec(-1.0_f64..1.0, 40), dt in 0.1_f64..2.0,
        ) {
            let turn = Matrix2::new(1.0 + 0.4 * numbers[0], numbers[1], numbers[2], 1.2 + 0.1 * numbers[3]);
            prop_assume!(turn.determinant() > 0.1);
            let root = SMatrix::<f64, 18, 18>::from_fn(|i, j| (7.0 * numbers[(3 * i + 5 * j) % 40]).sin());
            let covariance = root * root.transpose();
            let course = Course::Accelerating { level: 0.1, rates: true };
            let hypothesis = Hypothesis::<18> { course, mean: SVector::zeros(), covariance };
            let at = CentredPose { pose: as_map(&Matrix2::identity()), centroid: Point2::origin() };
            let variance = CentredVector::zeros();
            let step = Step::new((MotionModel::Affine, dt), [&at, &at], Units::of_usual_step(&variance, dt)).expect("poses");
            let none = Vector2::zeros();
            let (along, pushed) = (Matrix2::identity() * dt, Matrix2::zeros());
            let transition = hypothesis.transition(&step, (&turn, &along, &pushed), (&none, &none));
            let expected = carried(&transition, &covariance, 18);
            let mut found = covariance;
            carry_turned_chains(&mut found.data.0, &turn, dt);
            prop_assert!((found - expected).amax() < 1e-11 * expected.amax(), "{}", (found - expected).amax());
        }
    }
}
