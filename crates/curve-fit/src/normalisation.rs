use nalgebra::{Affine2, Matrix3, Point2, Vector2};

/// Centred, scaled coordinates of one outline: `working = (image - centre) / radius`. Fits are made there, where the
/// least-squares problem is well-conditioned, and mapped back exactly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Normalisation {
    /// Centre in image coordinates: the mean of the points.
    pub centre: Point2<f64>,
    /// Root mean square distance of the points from the centre, in image units; positive.
    pub radius: f64,
}

impl Normalisation {
    /// An image point in working coordinates.
    #[must_use]
    pub fn to_working(&self, p: &Point2<f64>) -> Point2<f64> {
        Point2::from((p - self.centre) / self.radius)
    }

    /// A working point in image coordinates.
    #[must_use]
    pub fn to_image(&self, p: &Point2<f64>) -> Point2<f64> {
        self.centre + self.radius * p.coords
    }

    /// The map from working to image coordinates: a scaling and a shift.
    #[must_use]
    pub fn image_from_working(&self) -> Affine2<f64> {
        let shift = Vector2::new(self.centre.x, self.centre.y);
        let scaling = Matrix3::new_nonuniform_scaling(&Vector2::repeat(self.radius));
        Affine2::from_matrix_unchecked(scaling.append_translation(&shift))
    }
}
