use nalgebra::{Matrix2, Matrix3, SMatrix, SVector, Vector2};

use crate::{
    generator::ParameterVector,
    motion_model::{MAX_PARAMETERS, MotionModel},
};

/// Distance from the identity below which the series converges fast.
const NEAR: f64 = 0.3;
/// Square roots taken at most; a turn by just less than half a circle needs four.
const MOST_ROOTS: usize = 40;

/// The generator X of least turn with `expm(X) = map` up to a factor, for a map of the plane that preserves orientation: square
/// roots (Denman and Beavers 1976) until the map is near the identity, then `log M = 2 artanh((M - I) (M + I)^-1)`. `None` where
/// there is none: a map that reflects, or turns by half a circle.
#[must_use]
pub fn logarithm(map: &Matrix3<f64>) -> Option<Matrix3<f64>> {
    let identity = Matrix3::identity();
    let determinant = map.determinant();
    let mut m = map / determinant.cbrt();
    if determinant.is_nan() || determinant <= 0.0 || !m.iter().all(|e| e.is_finite()) {
        return None;
    }
    let mut factor = 2.0;
    let mut roots = 0;
    while (m - identity).norm() > NEAR {
        if roots == MOST_ROOTS {
            return None;
        }
        m = square_root(&m)?;
        factor *= 2.0;
        roots += 1;
    }
    let z = (m - identity) * (m + identity).try_inverse()?;
    let squared = z * z;
    let (mut term, mut sum) = (z, z);
    for k in 1..=12 {
        term *= squared;
        sum += term / f64::from(2 * k + 1);
    }
    Some(sum * factor)
}

impl MotionModel {
    /// Parameters of the constant motion of this model that makes the map `change` in `seconds`, by a turn of less than half a circle: in
    /// closed form, but for projective motion. Of a map outside the model's group, one that is near. `None` where the numbers do not allow
    /// it, as for a reflection.
    #[must_use]
    pub fn motion_between(self, change: &Matrix3<f64>, seconds: f64) -> Option<ParameterVector> {
        let change = change / change[(2, 2)];
        if self == Self::Projective {
            return self.projective_motion_between(&change, seconds);
        }
        let k = self.parameter_count();
        let linear = change.fixed_view::<2, 2>(0, 0).into_owned();
        let mut generator = Matrix3::zeros();
        generator.fixed_view_mut::<2, 2>(0, 0).copy_from(&(self.linear_logarithm(&linear)? / seconds));
        let mut theta = self.parameters_of(&generator);
        let shift = Vector2::new(change[(0, 2)], change[(1, 2)]);
        if shift != Vector2::zeros() {
            // The shift is linear in the velocity.
            let moved_by = |b1: f64, b2: f64| {
                let mut unit = theta;
                (unit[k - 2], unit[k - 1]) = (b1, b2);
                self.flow(&unit[..k], seconds).into_inner()
            };
            let (by_b1, by_b2) = (moved_by(1.0, 0.0), moved_by(0.0, 1.0));
            let by_velocity = Matrix2::new(by_b1[(0, 2)], by_b2[(0, 2)], by_b1[(1, 2)], by_b2[(1, 2)]);
            // Of a map outside the group, what the motion makes of the point that the map takes to the origin.
            let within = by_b1.fixed_view::<2, 2>(0, 0) * linear.try_inverse()? * shift;
            let velocity = by_velocity.try_inverse()? * within;
            (theta[k - 2], theta[k - 1]) = (velocity.x, velocity.y);
        }
        theta.iter().all(|e| e.is_finite()).then_some(theta)
    }

    /// Logarithm of the nearest linear map of this model's group.
    fn linear_logarithm(self, linear: &Matrix2<f64>) -> Option<Matrix2<f64>> {
        let (c, s) = (linear[(0, 0)] + linear[(1, 1)], linear[(1, 0)] - linear[(0, 1)]);
        match self {
            Self::Rigid => {
                let turn = s.atan2(c);
                Some(Matrix2::new(0.0, -turn, turn, 0.0))
            }
            Self::Similarity => {
                let (growth, turn) = ((0.5 * c.hypot(s)).ln(), s.atan2(c));
                Some(Matrix2::new(growth, -turn, turn, growth))
            }
            Self::Affine | Self::Projective => {
                // A function of a 2x2 matrix is `f I + g (M - m I)`, m half its trace; the eigenvalues are m and a root to either side.
                let (half, determinant) = (0.5 * c, linear.determinant());
                let apart = 0.5 * (linear[(0, 0)] - linear[(1, 1)]);
                let squared = apart * apart + linear[(0, 1)] * linear[(1, 0)];
                let root = squared.abs().sqrt();
                let by_rest = if squared < 0.0 {
                    root.atan2(half) / root
                } else if half <= root {
                    // A reflection, or a turn by half a circle.
                    return None;
                } else if root > 0.0 {
                    (root / half).atanh() / root
                } else {
                    1.0 / half
                };
                let rest = linear - Matrix2::identity() * half;
                Some(Matrix2::identity() * (0.5 * determinant.ln()) + rest * by_rest)
            }
        }
    }

    /// By Newton's method on the flow, from the turn alone.
    fn projective_motion_between(self, change: &Matrix3<f64>, seconds: f64) -> Option<ParameterVector> {
        let k = self.parameter_count();
        let (c, s) = (change[(0, 0)] + change[(1, 1)], change[(1, 0)] - change[(0, 1)]);
        let mut start = Matrix3::zeros();
        let omega = -s.atan2(c) / seconds;
        (start[(0, 1)], start[(1, 0)]) = (omega, -omega);
        let mut theta = self.parameters_of(&start);
        for _ in 0..12 {
            let flow = self.flow(&theta[..k], seconds).into_inner();
            let rest = change * flow.try_inverse()?;
            let error = self.parameters_of(&(rest / rest[(2, 2)] - Matrix3::identity()));
            let by_motion = self.parameter_columns(self.flow_sensitivities(&theta[..k], seconds).into_iter());
            let matrix = SMatrix::<f64, MAX_PARAMETERS, MAX_PARAMETERS>::from_fn(|i, j| by_motion[i][j]);
            let step = matrix.lu().solve(&SVector::from(error))?;
            (0..k).for_each(|i| theta[i] += step[i]);
            if !theta.iter().all(|e| e.is_finite()) {
                return None;
            }
            if step.norm() * seconds < 1e-13 {
                break;
            }
        }
        Some(theta)
    }
}

fn square_root(m: &Matrix3<f64>) -> Option<Matrix3<f64>> {
    let (mut y, mut z) = (*m, Matrix3::identity());
    for _ in 0..30 {
        let (next_y, next_z) = (0.5 * (y + z.try_inverse()?), 0.5 * (z + y.try_inverse()?));
        let change = (next_y - y).norm();
        (y, z) = (next_y, next_z);
        if change <= 1e-15 * y.norm() {
            break;
        }
    }
    ((y * y - m).norm() <= 1e-9 * m.norm()).then_some(y)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn the_logarithm_undoes_the_flow_of_every_model(
            turn in -2.5_f64..2.5, rest in prop::array::uniform8(-0.4_f64..0.4), which in 0_usize..4,
        ) {
            let model = MotionModel::ALL[which];
            let k = model.parameter_count();
            let mut theta = rest;
            match model {
                MotionModel::Rigid => theta[0] = turn,
                MotionModel::Similarity => theta[1] = turn,
                _ => (theta[1], theta[2]) = (turn + rest[1], -turn + rest[2]),
            }
            let map = model.flow(&theta[..k], 1.0).into_inner();
            let found = model.parameters_of(&logarithm(&map).expect("a logarithm"));
            for (found, truth) in found.iter().zip(&theta).take(k) {
                prop_assert!((found - truth).abs() < 1e-8, "{found} for {truth}");
            }
        }
    }

    proptest! {
        #[test]
        fn the_motion_between_two_poses_leads_from_one_to_the_other(
            turn in -3.1_f64..3.1, rest in prop::array::uniform8(-0.4_f64..0.4), seconds in 0.01_f64..10.0, which in 0_usize..4,
        ) {
            let model = MotionModel::ALL[which];
            let k = model.parameter_count();
            let mut theta = rest;
            match model {
                MotionModel::Rigid => theta[0] = turn,
                MotionModel::Similarity => theta[1] = turn,
                MotionModel::Affine => (theta[1], theta[2]) = (0.9 * turn, -0.9 * turn),
                MotionModel::Projective => (theta[1], theta[2], theta[6], theta[7]) = (0.3 * turn, -0.3 * turn, 0.1, -0.1),
            }
            let theta = theta.map(|rate| rate / seconds);
            let found = model.motion_between(model.flow(&theta[..k], seconds).matrix(), seconds).expect("a motion");
            for (found, truth) in found.iter().zip(&theta).take(k) {
                prop_assert!((found - truth).abs() * seconds < 1e-9, "{found} for {truth}");
            }
            if model != MotionModel::Projective {
                let linear = model.flow(&theta[..k], seconds).matrix().fixed_view::<2, 2>(0, 0).into_owned();
                prop_assert!((model.linear_flow(&theta[..k], seconds) - linear).amax() < 1e-12);
            }
        }

        /// What is left of the map by the motion has no part in the group.
        #[test]
        fn of_a_map_outside_the_group_the_motion_leaves_what_the_group_does_not_have(
            linear in prop::array::uniform4(-0.4_f64..0.4), shift in prop::array::uniform2(-2.0_f64..2.0), which in 0_usize..2,
        ) {
            let model = MotionModel::ALL[which];
            let map = Matrix3::new(1.0 + linear[0], linear[1], shift[0], linear[2], 1.0 + linear[3], shift[1], 0.0, 0.0, 1.0);
            let theta = model.motion_between(&map, 0.5).expect("a motion");
            let flow = model.flow(&theta[..model.parameter_count()], 0.5).into_inner();
            let rest = map * flow.try_inverse().expect("a flow") - Matrix3::identity();
            let left = model.parameters_of(&rest);
            prop_assert!(left.iter().all(|e| e.abs() < 1e-12), "{left:?}");
        }
    }

    #[test]
    fn a_reflection_makes_no_affine_motion_and_what_is_not_finite_makes_none() {
        let reflection = Matrix3::new(-1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
        assert_eq!(MotionModel::Affine.motion_between(&reflection, 1.0), None);
        for model in MotionModel::ALL {
            assert_eq!(model.motion_between(&Matrix3::repeat(f64::NAN), 1.0), None, "{model}");
        }
    }

    #[test]
    fn a_reflection_and_a_half_turn_have_none() {
        assert_eq!(logarithm(&Matrix3::new(-1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)), None);
        assert_eq!(logarithm(&Matrix3::new(-1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 1.0)), None);
        assert_eq!(logarithm(&Matrix3::repeat(f64::NAN)), None);
    }
}
