use nalgebra::{Matrix3, SMatrix, SVector};

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
    /// Parameters of the constant motion of this model that makes the map `change` in `seconds`, by a turn of less than half a circle: by
    /// Newton's method on the flow, from the closed form of a similarity. Of a map outside the model's group, one that is near. `None`
    /// where the numbers do not allow it.
    #[must_use]
    pub fn motion_between(self, change: &Matrix3<f64>, seconds: f64) -> Option<ParameterVector> {
        let k = self.parameter_count();
        let (c, s) = (change[(0, 0)] + change[(1, 1)], change[(1, 0)] - change[(0, 1)]);
        let mut start = Matrix3::zeros();
        let omega = -s.atan2(c) / seconds;
        (start[(0, 1)], start[(1, 0)]) = (omega, -omega);
        let mut theta = self.parameters_of(&start);
        for _ in 0..12 {
            let flow = self.flow(&theta[..k], seconds).into_inner();
            let rest = change / change[(2, 2)] * flow.try_inverse()?;
            let error = self.parameters_of(&(rest / rest[(2, 2)] - Matrix3::identity()));
            let by_motion = self.parameter_columns(self.flow_sensitivities(&theta[..k], seconds).into_iter());
            let matrix = SMatrix::<f64, MAX_PARAMETERS, MAX_PARAMETERS>::from_fn(|i, j| {
                if i < k && j < k { by_motion[i][j] } else { f64::from(u8::from(i == j)) }
            });
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
        fn it_undoes_the_flow_of_every_model(
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

    #[test]
    fn a_reflection_and_a_half_turn_have_none() {
        assert_eq!(logarithm(&Matrix3::new(-1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)), None);
        assert_eq!(logarithm(&Matrix3::new(-1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 1.0)), None);
        assert_eq!(logarithm(&Matrix3::repeat(f64::NAN)), None);
    }
}
