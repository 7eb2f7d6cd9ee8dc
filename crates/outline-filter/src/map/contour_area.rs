//! Areas within the closed contours of cells: the centroid of a body, and what the places of its contours tell of a turn.
use nalgebra::{Matrix2, Point2, Vector2};

use super::OutlineMap;
use crate::tuning::null_space as tuning;

/// The area within a closed contour of cells.
#[derive(Debug, Clone, Copy)]
pub(super) struct ContourArea {
    origin: Point2<f64>,
    /// Twice the area, signed.
    area: f64,
    moment: Vector2<f64>,
    /// Second moments about the origin, times 24, signed.
    second: Matrix2<f64>,
    cells: usize,
    /// The cell of the contour that comes first.
    least: usize,
}

impl ContourArea {
    fn centroid(&self) -> Option<Point2<f64>> {
        (self.area != 0.0).then(|| self.origin + self.moment / (3.0 * self.area))
    }

    /// Covariance of the places in the area.
    fn covariance(&self) -> Option<Matrix2<f64>> {
        let mean = self.centroid()? - self.origin;
        Some(self.second / (12.0 * self.area) - mean * mean.transpose())
    }
}

/// The largest of some contours.
fn boundary(contours: &[ContourArea]) -> Option<&ContourArea> {
    contours.iter().max_by(|a, b| a.area.abs().total_cmp(&b.area.abs()))
}

impl OutlineMap {
    /// The contours that the cells make, if all of them are closed; none where there are no cells.
    pub(super) fn closed_contours(&self) -> Vec<ContourArea> {
        let (mut contours, mut cells, mut start) = (Vec::new(), 0, 0);
        while cells < self.cells.len() && start < self.cells.len() {
            let Some(contour) = self.contour_from(start) else { return Vec::new() };
            // Each contour counts once, from the first of its cells.
            if contour.least == start {
                cells += contour.cells;
                contours.push(contour);
            }
            start += 1;
        }
        contours
    }

    /// Centroid of the area within the polygon of the cells, if they are one closed contour; of several, within the largest, which is the
    /// boundary of the body.
    pub(super) fn area_centroid(contours: &[ContourArea]) -> Option<Point2<f64>> {
        boundary(contours)?.centroid()
    }

    /// Covariance of the places in that area. An affine map of the outline maps it as well, which is not true of places along the outline.
    pub(super) fn area_covariance(contours: &[ContourArea]) -> Option<Matrix2<f64>> {
        boundary(contours)?.covariance()
    }

    /// Mean square of the lever arms of a turn that the places of closed contours beside each other have; squares of the RMS radius. Errors of
    /// normals, which make levers along a contour, do not make these. 0 where a contour is not round: a slit has no place to speak of, and
    /// a curved slot has one beside its middle without showing the turn by its sides.
    pub(super) fn levers_of_places(&self, contours: &[ContourArea], spread: f64) -> f64 {
        let is_round = |contour: &ContourArea| {
            let length = contour.cells as f64 * self.spacing;
            // The area is twice that of the contour.
            std::f64::consts::TAU * contour.area.abs() > tuning::ROUND * length * length
        };
        if !contours.iter().all(is_round) {
            return 0.0;
        }
        let total = contours.iter().map(|contour| contour.cells as f64).sum::<f64>();
        let places = || contours.iter().filter_map(|contour| Some((contour.cells as f64 / total, contour.centroid()?)));
        let middle = places().map(|(share, centre)| share * centre.coords).sum::<Vector2<f64>>();
        let squares = places().map(|(share, centre)| share * (centre.coords - middle).norm_squared()).sum::<f64>();
        // Half of the normals are across the way to the middle.
        0.5 * squares / (spread * spread)
    }

    /// The closed contour that a cell is of; `None` where it is of an open one.
    fn contour_from(&self, start: usize) -> Option<ContourArea> {
        let origin = self.cells.get(start)?.centre;
        let (mut last, mut here) = (start, self.cells[start].neighbours[1]);
        let (mut area, mut moment, mut second) = (0.0, Vector2::zeros(), Matrix2::zeros());
        let (mut cells, mut least) = (1, start);
        while here != start {
            // Links may point either way.
            let [a, b] = self.cells[here].neighbours;
            let next = if a == last { b } else { a };
            if cells == self.cells.len() || a == here || b == here {
                return None;
            }
            let (p, q) = (self.cells[last].centre - origin, self.cells[here].centre - origin);
            let twice = p.perp(&q);
            area += twice;
            moment += twice * (p + q);
            second += twice * (p * p.transpose() + q * q.transpose() + (p + q) * (p + q).transpose());
            (cells, least) = (cells + 1, least.min(here));
            (last, here) = (here, next);
        }
        (cells > 1).then_some(ContourArea { origin, area, moment, second, cells, least })
    }
}

#[cfg(test)]
mod tests {
    use freeform_curve_fit::Outline;
    use freeform_riccati::MotionModel;
    use nalgebra::Vector2;

    use super::*;
    use crate::{
        drawn_curves::{all_around, lobed, polar},
        measurement::Frame,
        track::Track,
    };

    /// Covariance of the area of a curve of three lobes that has been moved by an affine map, in image coordinates.
    fn covariance_of(map: &Matrix2<f64>) -> Matrix2<f64> {
        let place = |t| map * polar(lobed(t, &[(3.0, [0.2, 0.0]), (2.0, [0.0, 0.1])]), t) + Vector2::new(3.0, -1.0);
        let outline = Outline::closed(all_around(2000, place)).expect("an outline");
        let track = Track::begin(MotionModel::Affine, &outline, 0.0, &mut Frame::default()).expect("a track");
        let radius = track.reference().radius;
        let covariance = OutlineMap::area_covariance(&track.map().closed_contours()).expect("a closed contour");
        covariance * radius * radius
    }

    #[test]
    fn the_covariance_of_an_area_goes_along_with_affine_maps() {
        let plain = covariance_of(&Matrix2::identity());
        // Of a circle it is a quarter of the squared radius.
        assert!((0.2..0.35).contains(&plain.m11) && (0.2..0.35).contains(&plain.m22), "{plain}");
        for map in [Matrix2::new(0.3, 0.1, -0.4, 1.2), Matrix2::new(-1.0, 0.5, 0.2, 0.4)] {
            let (found, expected) = (covariance_of(&map), map * plain * map.transpose());
            assert!((found - expected).amax() < 0.003 * expected.amax(), "{found} {expected}");
        }
    }
}
