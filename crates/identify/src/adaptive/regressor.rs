use freeform_riccati::MotionModel;
use nalgebra::{SMatrix, Vector4};

/// The matrix W of the plant `X' = W(X) theta` in the N parameters of a motion model: equations 14 to 17 gathered by
/// parameter. X holds the real and imaginary parts of l and k of one conjugate pair (equation 13).
///
/// Under projective motion `l' = ... + c1 l k - c2 k` and `k' = ... + c1 k^2` come on top.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Regressor<const N: usize> {
    /// How a1, a2, a3, a4, b1, b2, c1, c2 depend on the parameters.
    projective_from_parameters: SMatrix<f64, 8, N>,
    model: MotionModel,
}

impl<const N: usize> Regressor<N> {
    /// The regressor of a model with N parameters.
    ///
    /// # Panics
    /// If the model has another number of parameters.
    #[must_use]
    pub fn new(model: MotionModel) -> Self {
        assert!(model.parameter_count() == N, "{model} motion in {N} parameters");
        let entries = [(0, 0), (0, 1), (1, 0), (1, 1), (0, 2), (1, 2), (2, 0), (2, 1)];
        let basis = model.basis();
        Self { projective_from_parameters: SMatrix::from_fn(|row, column| basis[column][entries[row]]), model }
    }

    /// The model whose parameters these are.
    #[must_use]
    pub const fn model(&self) -> MotionModel {
        self.model
    }

    /// For each parameter, whether it belongs to the linear part of the motion, on which l' depends without k.
    pub(crate) fn acts_on_slopes(&self) -> impl Iterator<Item = bool> + '_ {
        self.projective_from_parameters.column_iter().map(|column| column.fixed_rows::<4>(0).amax() > 0.0)
    }

    /// W at X: 4 by N.
    #[must_use]
    pub fn at(&self, x: &Vector4<f64>) -> SMatrix<f64, 4, N> {
        projective_columns(x) * self.projective_from_parameters
    }
}

/// The derivatives of X' with respect to a1, a2, a3, a4, b1, b2, c1, c2.
fn projective_columns(x: &Vector4<f64>) -> SMatrix<f64, 4, 8> {
    let (e1, e2, e3, e4) = (x[0], x[1], x[2], x[3]);
    let f = quadratic_terms(x);
    // Real and imaginary part of k^2.
    let (re, im) = (e3 * e3 - e4 * e4, 2.0 * e3 * e4);
    SMatrix::from_row_slice(&[
        e1, -1.0, f[0], -e1, 0.0, 0.0, f[2], -e3, //
        e2, 0.0, f[1], -e2, 0.0, 0.0, f[3], -e4, //
        e3, 0.0, f[2], 0.0, -1.0, -e1, re, 0.0, //
        e4, 0.0, f[3], 0.0, 0.0, -e2, im, 0.0,
    ])
}

/// The function f of equation 19: `(e1^2 - e2^2, 2 e1 e2, e1 e3 - e2 e4, e1 e4 + e2 e3)`, real and imaginary parts of
/// `l^2` and `l k`.
#[must_use]
pub fn quadratic_terms(x: &Vector4<f64>) -> Vector4<f64> {
    let (e1, e2, e3, e4) = (x[0], x[1], x[2], x[3]);
    Vector4::new(e1 * e1 - e2 * e2, 2.0 * e1 * e2, e1 * e3 - e2 * e4, e1 * e4 + e2 * e3)
}

#[cfg(test)]
mod tests {
    use freeform_riccati::{AffineMotion, RealVariables, line_rate};
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn the_regressor_times_the_parameters_is_the_rate_of_the_lines(
            x in prop::array::uniform4(-3.0..3.0_f64),
            p in prop::array::uniform6(-2.0..2.0_f64),
        ) {
            let x = Vector4::from(x);
            let motion = AffineMotion { a1: p[0], a2: p[1], a3: p[2], a4: p[3], b1: p[4], b2: p[5] };
            let rate = RealVariables::from(x).rate(&motion);
            let affine = Regressor::<6>::new(MotionModel::Affine).at(&x) * SMatrix::<f64, 6, 1>::from(p);
            prop_assert!((affine - rate).norm() < 1e-12);
            let rigid = AffineMotion { a1: 0.0, a2: p[0], a3: -p[0], a4: 0.0, b1: p[1], b2: p[2] };
            let product = Regressor::<3>::new(MotionModel::Rigid).at(&x) * SMatrix::<f64, 3, 1>::new(p[0], p[1], p[2]);
            prop_assert!((product - RealVariables::from(x).rate(&rigid)).norm() < 1e-12);
            let similar = AffineMotion { a1: p[0], a2: p[1], a3: -p[1], a4: p[0], b1: p[2], b2: p[3] };
            let parameters = SMatrix::<f64, 4, 1>::new(p[0], p[1], p[2], p[3]);
            let product = Regressor::<4>::new(MotionModel::Similarity).at(&x) * parameters;
            prop_assert!((product - RealVariables::from(x).rate(&similar)).norm() < 1e-12);
        }

        #[test]
        fn the_regressor_of_projective_motion_is_the_riccati_equation_with_perspective(
            x in prop::array::uniform4(-3.0..3.0_f64),
            p in prop::array::uniform8(-2.0..2.0_f64),
        ) {
            let x = Vector4::from(x);
            let product = Regressor::<8>::new(MotionModel::Projective).at(&x) * SMatrix::<f64, 8, 1>::from(p);
            let rate = line_rate(&MotionModel::Projective.generator(&p), &RealVariables::from(x).into());
            let expected = Vector4::new(rate.l.re, rate.l.im, rate.k.re, rate.k.im);
            prop_assert!((product - expected).norm() < 1e-11, "{product} {expected}");
        }
    }
}
