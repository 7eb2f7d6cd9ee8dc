use nalgebra::Matrix3;

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
    use crate::motion_model::MotionModel;

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
