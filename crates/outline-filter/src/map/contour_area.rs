//! Areas within the closed contours of cells: the centroid of a body, and what the places of its contours tell of a turn.
use nalgebra::{Matrix2, Point2, Vector2};

use super::OutlineMap;
use crate::{belief::KnownOffsets, tuning::null_space as tuning};

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
    const fn new(origin: Point2<f64>, start: usize) -> Self {
        Self {
            origin,
            area: 0.0,
            moment: Vector2::new(0.0, 0.0),
            second: Matrix2::new(0.0, 0.0, 0.0, 0.0),
            cells: 0,
            least: start,
        }
    }

    /// Adds the triangle between the origin and the chord from one place to the next.
    fn add_chord(&mut self, from: &Point2<f64>, to: &Point2<f64>) {
        let (p, q) = (from - self.origin, to - self.origin);
        let twice = p.perp(&q);
        self.area += twice;
        self.moment += twice * (p + q);
        self.second += twice * (p * p.transpose() + q * q.transpose() + (p + q) * (p + q).transpose());
        self.cells += 1;
    }

    fn centroid(&self) -> Option<Point2<f64>> {
        (self.area != 0.0).then(|| self.origin + self.moment / (3.0 * self.area))
    }

    /// Covariance of the places in the area.
    fn covariance(&self) -> Option<Matrix2<f64>> {
        let mean = self.centroid()? - self.origin;
        Some(self.second / (12.0 * self.area) - mean * mean.transpose())
    }
}

/// The one that encloses more, the second where both do.
fn larger(a: ContourArea, b: ContourArea) -> ContourArea {
    if a.area.abs() > b.area.abs() { a } else { b }
}

/// Centroid of the area within a closed polygon; `None` where it encloses none.
pub(crate) fn centroid_within(polygon: &[Point2<f64>]) -> Option<Point2<f64>> {
    let mut area = ContourArea::new(*polygon.first()?, 0);
    polygon.iter().zip(polygon.iter().cycle().skip(1)).for_each(|(from, to)| area.add_chord(from, to));
    area.centroid()
}

impl OutlineMap {
    /// Goes through the contours that the outline makes, at its offsets from the cells as far as they are known; whether all of them are closed.
    fn for_each_contour(&self, offsets: KnownOffsets<'_>, mut each: impl FnMut(ContourArea)) -> bool {
        let (mut cells, mut start) = (0, 0);
        while cells < self.cells.len() && start < self.cells.len() {
            let Some(contour) = self.contour_from(start, offsets) else { return false };
            // Each contour counts once, from the first of its cells.
            if contour.least == start {
                cells += contour.cells;
                each(contour);
            }
            start += 1;
        }
        true
    }

    /// Where the outline lies on the normal of a cell, as far as that is known.
    pub(crate) fn known_place(&self, cell: usize, offsets: KnownOffsets<'_>) -> Point2<f64> {
        let at = &self.cells[cell];
        at.centre + offsets.of(cell) * at.normal
    }

    /// The contours that the cells make, if all of them are closed; none where there are no cells.
    pub(super) fn closed_contours(&self) -> Vec<ContourArea> {
        let mut contours = Vec::new();
        if self.for_each_contour(KnownOffsets::NONE, |contour| contours.push(contour)) { contours } else { Vec::new() }
    }

    /// Centroid of the area within the polygon of the outline at its offsets from the cells, if it is one closed contour; of several, within the
    /// largest, which is the boundary of the body.
    pub(super) fn area_centroid(&self, offsets: KnownOffsets<'_>) -> Option<Point2<f64>> {
        let mut largest: Option<ContourArea> = None;
        let are_closed = self.for_each_contour(offsets, |contour| {
            largest = Some(largest.map_or(contour, |before| larger(before, contour)));
        });
        largest.filter(|_| are_closed)?.centroid()
    }

    /// Covariance of the places in that area. An affine map of the outline maps it as well, which is not true of places along the outline.
    pub(super) fn area_covariance(contours: &[ContourArea]) -> Option<Matrix2<f64>> {
        contours.iter().copied().reduce(larger)?.covariance()
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
    fn contour_from(&self, start: usize, offsets: KnownOffsets<'_>) -> Option<ContourArea> {
        let origin = self.cells.get(start)?.centre;
        let mut contour = ContourArea::new(origin, start);
        let (mut last, mut here) = (start, self.cells[start].neighbours[1]);
        loop {
            contour.add_chord(&self.known_place(last, offsets), &self.known_place(here, offsets));
            contour.least = contour.least.min(here);
            if here == start {
                return (contour.cells > 1).then_some(contour);
            }
            let cell = &self.cells[here];
            if contour.cells == self.cells.len() || cell.neighbours.contains(&here) {
                return None;
            }
            (last, here) = (here, cell.beyond(last));
        }
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

    #[test]
    fn the_centroid_is_that_of_the_outline_at_its_offsets_from_the_cells() {
        let outline = Outline::closed(all_around(400, |t| polar(1.0, t))).expect("an outline");
        let track = Track::begin(MotionModel::Rigid, &outline, 0.0, &mut Frame::default()).expect("a track");
        let shift = Vector2::new(0.03, -0.02);
        let offsets: Vec<f64> = track.map().cells().iter().map(|cell| cell.normal.dot(&shift)).collect();
        let centroid = |offsets: KnownOffsets<'_>| track.map().area_centroid(offsets).expect("a closed contour");
        let known = |information: &[f64]| {
            centroid(KnownOffsets { offsets: &offsets, information }) - centroid(KnownOffsets::NONE)
        };
        let moved = known(&vec![2.0; offsets.len()]);
        assert!((moved - shift).norm() < 1e-3 * shift.norm(), "{moved}");
        // Those of cells that one point has shown, which may have been measured in a wrong pose, say nothing.
        assert_eq!(known(&vec![1.0; offsets.len()]), Vector2::zeros());
    }
}
