use nalgebra::{Affine2, Matrix2, Matrix3, Point2, Vector2};

/// Centred, scaled coordinates of one outline: `image = centre + radius stretch working`. Fits are made there, where the
/// least-squares problem is well-conditioned, and mapped back exactly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Normalisation {
    /// Centre in image coordinates: the mean of the points.
    pub centre: Point2<f64>,
    /// Root mean square distance of the points from the centre, in image units; positive. For an affine normalisation the root
    /// of the area that the unit square of the working coordinates has in the image.
    pub radius: f64,
    /// The identity, or what an affine normalisation takes out of the outline: a matrix of determinant 1 or -1.
    pub stretch: Matrix2<f64>,
}

impl Normalisation {
    /// A shift and a scaling: without a stretch.
    #[must_use]
    pub fn similarity(centre: Point2<f64>, radius: f64) -> Self {
        Self { centre, radius, stretch: Matrix2::identity() }
    }

    /// From the map of working to image coordinates. `None` where it is singular or not finite.
    #[must_use]
    pub fn affine(image_from_working: &Affine2<f64>) -> Option<Self> {
        let matrix = image_from_working.matrix();
        let linear = matrix.fixed_view::<2, 2>(0, 0).into_owned();
        let radius = linear.determinant().abs().sqrt();
        let usable = radius > 0.0 && radius.is_finite() && matrix.iter().all(|m| m.is_finite());
        let centre = Point2::new(matrix.m13, matrix.m23);
        usable.then(|| Self { centre, radius, stretch: linear / radius })
    }

    /// Whether there is a stretch.
    #[must_use]
    pub fn is_affine(&self) -> bool {
        self.stretch != Matrix2::identity()
    }

    /// An image point in working coordinates.
    #[must_use]
    pub fn to_working(&self, p: &Point2<f64>) -> Point2<f64> {
        Point2::from(self.unstretch() * ((p - self.centre) / self.radius))
    }

    /// A working point in image coordinates.
    #[must_use]
    pub fn to_image(&self, p: &Point2<f64>) -> Point2<f64> {
        self.centre + self.radius * (self.stretch * p.coords)
    }

    /// The map from working to image coordinates: a scaling and a shift, after the stretch if there is one.
    #[must_use]
    pub fn image_from_working(&self) -> Affine2<f64> {
        let shift = Vector2::new(self.centre.x, self.centre.y);
        Affine2::from_matrix_unchecked((self.stretch * self.radius).to_homogeneous().append_translation(&shift))
    }

    /// The inverse of the stretch, by its determinant of size 1.
    pub(crate) fn unstretch(&self) -> Matrix2<f64> {
        let s = &self.stretch;
        Matrix2::new(s.m22, -s.m12, -s.m21, s.m11) / s.determinant()
    }

    /// The map of working coordinates that have been centred and scaled by `inner` within those of this one.
    pub(crate) fn after(&self, inner: &Self) -> Self {
        Self { centre: self.to_image(&inner.centre), radius: self.radius * inner.radius, stretch: self.stretch }
    }

    /// The stretch alone.
    pub(crate) fn stretching(&self) -> Affine2<f64> {
        let matrix: Matrix3<f64> = self.stretch.to_homogeneous();
        Affine2::from_matrix_unchecked(matrix)
    }
}
