use nalgebra::Point2;

use crate::{fit::Fit, outline::Outline, rectangle::Rectangle};

/// How far around an outline its curve is looked for, in sizes of the outline.
const SURROUNDINGS: f64 = 2.0;

/// Which parts of a curve, each given by points along it, are stray: no point of the outline is nearest to them. The zero set
/// of a polynomial may have such parts beside the one that the outline lies along.
#[must_use]
pub fn stray_parts(parts: &[Vec<Point2<f64>>], outline: &Outline) -> Vec<bool> {
    let mut stray = vec![true; parts.len()];
    for p in outline.points() {
        let distance = |part: &[Point2<f64>]| part.iter().map(|q| (q - p).norm_squared()).fold(f64::INFINITY, f64::min);
        let distances = parts.iter().map(|part| distance(part)).enumerate();
        if let Some((nearest, _)) = distances.min_by(|a, b| a.1.total_cmp(&b.1)) {
            stray[nearest] = false;
        }
    }
    stray
}

impl Fit {
    /// Middles of the stray parts of the curve, as [`stray_parts`] tells them, that lie within two sizes of the outline on
    /// all sides.
    #[must_use]
    pub fn stray_places(&self, outline: &Outline) -> Vec<Point2<f64>> {
        let parts = self.curve_within(&outline.bounding_box().widened(SURROUNDINGS));
        let found = parts.iter().zip(stray_parts(&parts, outline)).filter(|(_, stray)| *stray);
        found.filter_map(|(part, _)| Rectangle::around(part.iter())).map(|around| around.centre()).collect()
    }
}
