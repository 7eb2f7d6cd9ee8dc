//! Points spread evenly by arc length along an outline.
use nalgebra::{Point2, Vector2};

use crate::{
    outline::{Outline, Piece},
    smoothing::smooth,
};

/// Fewest points of an outline that is spread anew: sparse polygons are filled up, so that what is fitted is the polygon and not
/// its corners.
const FEWEST: usize = 256;

/// An outline whose points have been spread anew and smoothed, in buffers that are reused.
///
/// What stretches a slender outline to a round one stretches its noise as well, to several times the distance of neighbours. An outline
/// that runs to and fro like that has neither arc lengths nor normals, and the curve through it depends on the direction of the stretch.
/// So the noise is taken down first.
#[derive(Debug, Default, Clone)]
pub(crate) struct EvenOutline {
    points: Vec<Point2<f64>>,
    /// Number of points of every piece and whether it is closed.
    pieces: Vec<(usize, bool)>,
    moved: Vec<Point2<f64>>,
    /// Spread evenly, before they are smoothed.
    rough: Vec<Point2<f64>>,
    /// The points smoothed one by one, before they are spread evenly once more.
    smoothed: Vec<Point2<f64>>,
    lengths: Vec<f64>,
}

impl EvenOutline {
    /// Takes the outline as `map` moves it, every piece smoothed and spread evenly by arc length there.
    pub(crate) fn spread(&mut self, outline: &Outline, map: impl Fn(&Point2<f64>) -> Point2<f64>) {
        let total = outline.point_count();
        for buffer in [&mut self.points, &mut self.rough, &mut self.smoothed] {
            buffer.clear();
        }
        self.pieces.clear();
        let spread_total = outline.pieces().map(|piece| resampled_count(piece.points.len(), total)).sum();
        for piece in outline.pieces() {
            self.moved.clear();
            self.moved.extend(piece.points.iter().map(&map));
            let count = resampled_count(piece.points.len(), total);
            self.pieces.push((count, piece.closed));
            let moved = Piece { points: &self.moved, closed: piece.closed };
            let start = self.rough.len();
            resample(moved, count, &mut self.lengths, &mut self.rough);
            smooth(Piece { points: &self.rough[start..], closed: piece.closed }, spread_total, &mut self.smoothed);
            let smoothed = Piece { points: &self.smoothed[start..], closed: piece.closed };
            resample(smoothed, count, &mut self.lengths, &mut self.points);
        }
    }

    /// All points in order.
    pub(crate) fn points(&self) -> &[Point2<f64>] {
        &self.points
    }

    /// The points of a closed piece, if there is no other, before they were smoothed, with the normals that they have after it.
    pub(crate) fn rough(&self) -> impl Iterator<Item = (Point2<f64>, Vector2<f64>)> {
        let count = self.smoothed.len();
        self.rough.iter().enumerate().map(move |(i, p)| {
            let along = self.smoothed[(i + 1) % count] - self.smoothed[(i + count - 1) % count];
            (*p, Vector2::new(along.y, -along.x).try_normalize(0.0).unwrap_or_default())
        })
    }

    /// Number of points of every piece, and whether it is closed.
    pub(crate) fn pieces(&self) -> &[(usize, bool)] {
        &self.pieces
    }
}

/// So many points, evenly spaced by arc length along a closed contour, from its point farthest from the origin on.
///
/// # Panics
/// If there is no point at all.
#[must_use]
pub fn evenly_spaced(contour: &[Point2<f64>], count: usize) -> Vec<Point2<f64>> {
    let mut out = Vec::with_capacity(count);
    resample(Piece { points: contour, closed: true }, count, &mut Vec::new(), &mut out);
    out
}

/// Appends `count` points, evenly spaced by arc length along a piece, to `out`. An open piece keeps its ends; a closed one begins
/// at its point farthest from the origin, so that neither a turn about the origin nor another first point changes the points.
///
/// `lengths` is working memory.
fn resample(piece: Piece<'_>, count: usize, lengths: &mut Vec<f64>, out: &mut Vec<Point2<f64>>) {
    let Piece { points, closed } = piece;
    let farther = |a: &usize, b: &usize| points[*a].coords.norm_squared().total_cmp(&points[*b].coords.norm_squared());
    let start = if closed { (0..points.len()).max_by(farther).unwrap_or(0) } else { 0 };
    let nodes = points.len() + usize::from(closed);
    let node = |i: usize| points[(start + i) % points.len()];
    lengths.clear();
    let mut total = 0.0;
    lengths.extend((0..nodes).map(|i| {
        if i > 0 {
            total += (node(i) - node(i - 1)).norm();
        }
        total
    }));
    let step = total / (count - usize::from(!closed)) as f64;
    let mut segment = 0;
    out.extend((0..count).map(|k| {
        let s = step * k as f64;
        while segment + 2 < nodes && lengths[segment + 1] < s {
            segment += 1;
        }
        let (from, to) = (lengths[segment], lengths[segment + 1]);
        let share = if to > from { ((s - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };
        node(segment) + share * (node(segment + 1) - node(segment))
    }));
}

/// How many points a piece of so many of an outline of so many is spread anew over.
fn resampled_count(piece: usize, outline: usize) -> usize {
    if outline >= FEWEST { piece } else { (piece * FEWEST).div_ceil(outline) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn resampled(points: &[Point2<f64>], closed: bool, count: usize) -> Vec<Point2<f64>> {
        let mut out = Vec::new();
        resample(Piece { points, closed }, count, &mut Vec::new(), &mut out);
        out
    }

    #[test]
    fn points_of_a_square_are_spread_evenly_from_the_farthest_corner_on() {
        let corners = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.1)].map(|(x, y)| Point2::new(x, y));
        let points = resampled(&corners, true, 82);
        assert_eq!(points.len(), 82);
        assert_eq!(points[0], corners[3]);
        let step = (2.0 * 2.0 + 2.1 + (2.0_f64 * 2.0 + 0.1 * 0.1).sqrt()) / 82.0;
        let along = points.windows(2).filter(|w| ((w[1] - w[0]).norm() - step).abs() < 1e-12).count();
        // All but the chords across the other three corners.
        assert!(along >= 78, "{along}");
    }

    #[test]
    fn an_open_piece_keeps_its_ends() {
        let points = [(0.0, 0.0), (1.0, 0.0), (1.0, 3.0)].map(|(x, y)| Point2::new(x, y));
        let spread = resampled(&points, false, 5);
        assert_eq!(
            spread,
            [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (1.0, 2.0), (1.0, 3.0)].map(|(x, y)| Point2::new(x, y))
        );
    }

    #[test]
    fn repeated_points_do_no_harm() {
        let points = [(0.0, 0.0), (0.0, 0.0), (1.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(x, y)| Point2::new(x, y));
        assert!(resampled(&points, true, 50).iter().all(|p| p.coords.iter().all(|c| c.is_finite())));
    }
}
