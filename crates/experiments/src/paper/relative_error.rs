use freeform_riccati::ProjectiveMotion;

/// A motion has settled once the error of its rates (omega, or the matrix a) stays below this share of them...
pub(super) const SETTLED_RATES: f64 = 0.05;
/// ... and that of its velocity b below this share of it.
pub(super) const SETTLED_VELOCITY: f64 = 0.10;

/// How far an estimate is from the truth.
#[derive(Debug, Clone, Copy)]
pub(super) struct RelativeError {
    /// Norm of the error of the matrix (a1, a2; a3, a4) over its norm: for rigid motion that of omega over omega.
    pub(super) rates: f64,
    /// Length of the error of b over the length of b.
    pub(super) velocity: f64,
}

impl RelativeError {
    pub(super) fn of(found: &ProjectiveMotion, truth: &ProjectiveMotion) -> Self {
        let rates = |m: &ProjectiveMotion| nalgebra::Vector4::new(m.a1, m.a2, m.a3, m.a4);
        let velocity = |m: &ProjectiveMotion| nalgebra::Vector2::new(m.b1, m.b2);
        Self {
            rates: (rates(found) - rates(truth)).norm() / rates(truth).norm(),
            velocity: (velocity(found) - velocity(truth)).norm() / velocity(truth).norm(),
        }
    }

    /// Whether both are small.
    pub(super) fn is_settled(&self) -> bool {
        self.rates < SETTLED_RATES && self.velocity < SETTLED_VELOCITY
    }
}
