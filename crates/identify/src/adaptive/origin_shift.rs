use freeform_decompose::Line;
use freeform_riccati::MotionModel;
use nalgebra::{Complex, Matrix3, Matrix4, SMatrix, Vector2, Vector4};

/// New coordinates whose origin lies at a point of the old ones, and what becomes there of all that an adaptive law holds.
///
/// Where x' = A x holds in the old coordinates, the same motion is `H A H^-1` in the new ones, H taking old to new: the
/// matrix (a1, a2; a3, a4) stays, and b becomes the velocity at the new origin. Lines keep their l; k becomes `k + x0 + l
/// y0`, so that X of equation 19 becomes `T X + t`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct OriginShift {
    origin: Vector2<f64>,
}

impl OriginShift {
    pub(crate) const fn to(origin: Vector2<f64>) -> Self {
        Self { origin }
    }

    pub(crate) fn line(&self, line: &Line) -> Line {
        Line { l: line.l, k: line.k + line.l * self.origin.y + Complex::from(self.origin.x) }
    }

    /// The matrix T.
    pub(crate) fn of_rates(&self) -> Matrix4<f64> {
        let mut matrix = Matrix4::identity();
        (matrix[(2, 0)], matrix[(3, 1)]) = (self.origin.y, self.origin.y);
        matrix
    }

    /// `T X + t`.
    pub(crate) fn state(&self, state: &Vector4<f64>) -> Vector4<f64> {
        self.of_rates() * state + Vector4::new(0.0, 0.0, self.origin.x, 0.0)
    }

    /// The matrix that takes the parameters of a model with N of them from old to new.
    pub(crate) fn of_parameters<const N: usize>(&self, model: MotionModel) -> SMatrix<f64, N, N> {
        let (new_from_old, old_from_new) =
            (Matrix3::new_translation(&-self.origin), Matrix3::new_translation(&self.origin));
        let columns = model.basis().iter().map(|e| model.parameters_of(&(new_from_old * e * old_from_new)));
        let mut matrix = SMatrix::<f64, N, N>::zeros();
        for (mut column, parameters) in matrix.column_iter_mut().zip(columns) {
            column.copy_from_slice(&parameters[..N]);
        }
        matrix
    }

    /// The matrix that takes the signals `(X, f(X), -1)` of the estimator (21) from old to new.
    pub(crate) fn of_signals(&self) -> SMatrix<f64, 9, 9> {
        let (x, y) = (self.origin.x, self.origin.y);
        let mut matrix = SMatrix::<f64, 9, 9>::identity();
        matrix.fixed_view_mut::<4, 4>(0, 0).copy_from(&self.of_rates());
        matrix[(2, 8)] = -x;
        // l k becomes l k + l x0 + l^2 y0.
        (matrix[(6, 0)], matrix[(7, 1)]) = (x, x);
        (matrix[(6, 4)], matrix[(7, 5)]) = (y, y);
        matrix
    }

    /// From the new coordinates back to the old.
    pub(crate) fn inverse(&self) -> Self {
        Self { origin: -self.origin }
    }
}
