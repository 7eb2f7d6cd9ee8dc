//! What the rounding of points to pixels does to a pose.
use freeform_curve_fit::{Outline, Piece};
use nalgebra::Vector2;

use super::Track;
use crate::{
    dynamics::CentredDeviations,
    map::Contour,
    measurement::{PixelLattice, Rounding},
    tuning::{lattice::RAGGED_OVER, statement::ALONG_PIXELS},
};

impl Track {
    /// Rounding of the points of an outline, whose contours are normalised by a radius: to pixels of a given size, image lengths, or, where
    /// that is 0, to those of the lattice that they lie on. Points that state deviations of their own have said what they are off by.
    pub(super) fn rounding_of(outline: &Outline, mask_pixel: f64, contours: &[Contour], radius: f64) -> Rounding {
        let length = |piece: Piece<'_>| piece.points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum::<f64>();
        let extent = (outline.pieces().map(length).sum::<f64>() / radius, outline.point_count());
        if mask_pixel > 0.0 {
            return Rounding::of_mask(mask_pixel / radius, extent);
        }
        if outline.deviations().is_some() {
            return Rounding::NONE;
        }
        let Some(PixelLattice { pixel, place }) = PixelLattice::of(outline) else { return Rounding::NONE };
        let pixel = pixel / radius;
        let scatter = contours.iter().filter_map(|contour| contour.scatter_over(RAGGED_OVER * pixel));
        Rounding::on_lattice(pixel, place, scatter.fold(0.0, f64::max), extent)
    }

    /// Size of a pixel, and deviation of a side along the rows or columns, image lengths; zeros where points are not rounded.
    pub(crate) fn rounding_of_side(&self) -> [f64; 2] {
        let rounding = self.noise.rounding();
        [rounding.pixel(), rounding.of_side()].map(|length| length * self.reference.radius)
    }

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
