//! The outline of a track as it is known, in the image.
use freeform_riccati::{map_point, pull_back};
use nalgebra::{Matrix3, Point2};

use super::{
    Track,
    known_outline::{KnownOutline, KnownPiece},
};
use crate::{
    map::Cell,
    update::{hold, with_hold},
};

impl Track {
    /// The outline as it is known now, image coordinates: one point per cell, in no particular order where the map has grown. Cells of which little
    /// has been seen lie where they were cut: what one point says of an offset may have been measured in a wrong pose.
    pub(crate) fn outline_points(&self) -> impl Iterator<Item = Point2<f64>> + '_ {
        let to_image = self.reference.to_image() * self.belief.pose;
        let offsets = self.belief.known_offsets();
        (0..self.map.cells().len()).map(move |cell| map_point(&to_image, &self.map.known_place(cell, offsets)))
    }

    /// The outline as it is known now, in its order, where it was in the first frame.
    pub(crate) fn known_outline(&self) -> KnownOutline {
        KnownOutline { pieces: self.pieces_by(&self.reference.to_image()), pose: self.pose() }
    }

    /// Its connected parts where it is now, image coordinates, each in order with its normals on the right.
    pub(crate) fn pieces(&self) -> Vec<KnownPiece> {
        self.pieces_by(&(self.reference.to_image() * self.belief.pose))
    }

    fn pieces_by(&self, to_image: &Matrix3<f64>) -> Vec<KnownPiece> {
        let offsets = self.belief.known_offsets();
        let at = |cell: usize| map_point(to_image, &self.map.known_place(cell, offsets));
        let piece = |(mut chain, closed): (Vec<usize>, bool)| {
            if !self.map.runs_with_normals(&chain) {
                chain.reverse();
            }
            KnownPiece { points: chain.into_iter().map(at).collect(), closed }
        };
        self.map.chains().into_iter().map(piece).collect()
    }

    /// Standard deviation of the place of the outline along its normals, normalised, where it is known least, by the pose
    /// alone; `None` where the covariance cannot be computed.
    pub(crate) fn deviation_along_normals(&self) -> Option<f64> {
        let (belief, null) = (&self.belief, self.null_directions());
        let held = with_hold(&belief.marginal, hold(belief, &self.map, &null).as_ref());
        let k = belief.parameter_count();
        // By what is beyond doubt of the correlation, as where it is decided which points agree: edges are looked for as far as that.
        let covariance = belief.covariance_of(&held, self.noise.effective_variance())?;
        let inverse = belief.pose.try_inverse()?;
        let variance = |cell: &Cell| {
            let place = map_point(&belief.pose, &cell.centre);
            let normal = pull_back(&inverse, &place, &cell.centre, &cell.normal).normalize();
            let along = belief.model.normal_velocities(&place, &normal);
            let term = |i: usize, j: usize| along[i] * covariance[(i, j)] * along[j];
            (0..k).flat_map(|i| (0..k).map(move |j| (i, j))).map(|(i, j)| term(i, j)).sum::<f64>()
        };
        let variances = self.map.cells().iter().map(variance);
        let finite = variances.map(|variance| variance.is_finite().then_some(variance));
        finite.reduce(|a, b| Some(f64::max(a?, b?))).flatten().map(|variance| variance.max(0.0).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use freeform_riccati::MotionModel;

    use super::*;
    use crate::{
        drawn_curves::{outline, polar},
        measurement::Frame,
    };

    #[test]
    fn the_outline_is_known_by_offsets_that_more_than_one_point_has_shown() {
        let oval = outline(200, |t| polar(1.0 + 0.2 * (2.0 * t).cos(), t));
        let mut track = Track::begin(MotionModel::Rigid, &oval, 0.0, &mut Frame::default()).expect("a track");
        let mut place = |information: f64, offset: f64| {
            track.belief.information.cells.own_mut()[7] = information;
            track.belief.offsets[7] = offset;
            (track.outline_points().nth(7).expect("a cell"), track.known_outline().pieces[0].points.clone())
        };
        let as_cut = place(1.0, 0.0);
        assert_eq!(place(1.0, 0.3), as_cut);
        let (seen, piece) = place(2.0, 0.3);
        let radius = track.reference.radius;
        assert!(((seen - as_cut.0).norm() / (0.3 * radius) - 1.0).abs() < 1e-9, "{seen} {radius}");
        assert!(piece.iter().any(|p| (map_point(&track.belief.pose, p) - seen).norm() < 1e-9));
    }
}
