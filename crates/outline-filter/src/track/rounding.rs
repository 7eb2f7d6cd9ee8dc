//! What the rounding of a mask does to a pose.
use nalgebra::Vector2;

use super::Track;
use crate::{dynamics::CentredDeviations, tuning::statement::ALONG_PIXELS};

impl Track {
    /// How far a pose is off as its points are rounded to pixels: deviations about the centroid, normalised, and none where points are not
    /// rounded. All points of a side that lies along the rows or columns are off together; others count as noise.
    pub(super) fn rounding_of_pose(&self) -> CentredDeviations {
        let side = self.noise.rounding().of_side();
        if side == 0.0 {
            return CentredDeviations::zeros();
        }
        let linear = self.belief.pose.fixed_view::<2, 2>(0, 0).into_owned();
        let along = |normal: &Vector2<f64>| {
            let tangent = linear * Vector2::new(normal.y, -normal.x);
            tangent.amin() < ALONG_PIXELS * tangent.amax()
        };
        let cells = self.map.cells();
        let share = cells.iter().filter(|cell| along(&cell.normal)).count() as f64 / cells.len().max(1) as f64;
        let [pose, _] = self.systematic(side * share * self.reference.radius, self.span_of_motion(false));
        pose
    }
}
