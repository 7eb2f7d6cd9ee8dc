use nalgebra::{Matrix2, Point2, Rotation2, Vector2};

/// How the plane of the object comes to the picture. The origin stays the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum View {
    /// As it is.
    Flat,
    /// The plane is tilted by an angle in radians about an axis in the picture (given by its direction in radians), seen from a
    /// `distance` in sizes along the optical axis; infinite for an orthographic camera.
    Tilted { angle: f64, axis: f64, distance: f64 },
    /// Pixels are wider than high by this share, and taken to be square.
    Aspect(f64),
    /// Points at the distance r from the middle of the picture are moved outwards by `strength r^3`.
    Lens { strength: f64 },
    /// Rows are read one after another: a point at height y is seen `delay y` seconds later.
    RollingShutter { delay: f64 },
}

impl View {
    /// Where a point of the plane is in the picture.
    pub(super) fn image(self, p: &Point2<f64>) -> Point2<f64> {
        match self {
            Self::Flat | Self::RollingShutter { .. } => *p,
            Self::Tilted { angle, axis, distance } => {
                let along = Rotation2::new(axis);
                let q = along.inverse() * p;
                let nearer = 1.0 / (1.0 + q.y * angle.sin() / distance);
                along * Point2::new(q.x * nearer, q.y * angle.cos() * nearer)
            }
            Self::Aspect(wider) => Point2::new(p.x / (1.0 + wider), p.y),
            Self::Lens { strength } => p * (1.0 + strength * p.coords.norm_squared()),
        }
    }

    /// Derivative of the image at the origin: what it makes of velocities there.
    pub(super) fn derivative_at_origin(self) -> Matrix2<f64> {
        match self {
            Self::Flat | Self::RollingShutter { .. } | Self::Lens { .. } => Matrix2::identity(),
            Self::Tilted { angle, axis, .. } => {
                let along = Rotation2::new(axis).into_inner();
                along * Matrix2::from_diagonal(&Vector2::new(1.0, angle.cos())) * along.transpose()
            }
            Self::Aspect(wider) => Matrix2::from_diagonal(&Vector2::new(1.0 / (1.0 + wider), 1.0)),
        }
    }

    /// Seconds after the start of the frame at which a point of the picture is seen.
    pub(super) fn delay(self, p: &Point2<f64>) -> f64 {
        if let Self::RollingShutter { delay } = self { delay * p.y } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_derivative_at_the_origin_is_that_of_the_image() {
        for view in [
            View::Flat,
            View::Tilted { angle: 0.5, axis: 0.7, distance: 5.0 },
            View::Tilted { angle: 0.9, axis: -2.0, distance: f64::INFINITY },
            View::Aspect(0.1),
            View::Lens { strength: 0.02 },
        ] {
            let step = 1e-5;
            assert!(view.image(&Point2::origin()).coords.norm() < 1e-15);
            let column = |v: Vector2<f64>| {
                (view.image(&Point2::from(step * v)) - view.image(&Point2::from(-step * v))) / (2.0 * step)
            };
            let numeric = Matrix2::from_columns(&[column(Vector2::x()), column(Vector2::y())]);
            assert!((numeric - view.derivative_at_origin()).amax() < 1e-8, "{view:?}");
        }
    }
}
