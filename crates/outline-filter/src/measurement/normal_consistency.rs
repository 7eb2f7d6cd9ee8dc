//! Normal-consistency check: which side of a thin part a point belongs to.
use nalgebra::Point2;

use super::{Piece, View};
use crate::{
    map::{Cell, OutlineMap},
    tuning::measurement as tuning,
    vectors::vectorised,
};

/// A piece of the contour with a direction: its places with the window that tells which way it runs past a cell.
struct DirectedPiece<'a> {
    map: &'a OutlineMap,
    /// In the body frame.
    places: &'a [Point2<f64>],
    closed: bool,
    reach: usize,
}

impl DirectedPiece<'_> {
    /// Number of the point so many places on from point i, back where `forth` is false, if there is one.
    fn beside(&self, i: usize, steps: usize, forth: bool) -> Option<usize> {
        let count = self.places.len();
        match (self.closed, forth) {
            // Most are on this side of the start; a division for each would be most of the work.
            (true, true) if i + steps < count => Some(i + steps),
            (true, true) => Some((i + steps) % count),
            (true, false) if steps <= i => Some(i - steps),
            (true, false) => Some((i + count - steps % count) % count),
            (false, true) => Some(i + steps).filter(|j| *j < count),
            (false, false) => i.checked_sub(steps),
        }
    }

    /// Positive where the contour passes point i with the normal of the cell on its right.
    fn along(&self, i: usize, cell: usize) -> f64 {
        let place = |forth| self.places[self.beside(i, self.reach, forth).unwrap_or(i)];
        self.map.cells()[cell].normal.perp(&(place(true) - place(false)))
    }

    /// Of the points that have all of their neighbours, how many run the way in which `along` is positive, and how many tell.
    #[inline(always)]
    fn count_forth(&self, of_points: &Numbered<'_>) -> (usize, usize) {
        let (reach, cells) = (self.reach, self.map.cells());
        let range = reach..self.places.len() - reach;
        let chords = self.places[2 * reach..].iter().zip(self.places);
        let of_points = of_points.numbers[range.clone()].iter().zip(&of_points.weights[range]);
        let (mut forth, mut total) = (0, 0);
        for ((ahead, behind), (number, weight)) in chords.zip(of_points) {
            let mut across = 0.0;
            let mut is_told = *weight > 0.0;
            if let Some(Cell { normal, .. }) = cells.get(*number as usize) {
                across = normal.x * (ahead.y - behind.y) - normal.y * (ahead.x - behind.x);
            } else {
                is_told = false;
            }
            forth += usize::from(is_told & (across > 0.0));
            total += usize::from(is_told);
        }
        (forth, total)
    }

    /// The cell nearest to point i that its neighbours lead to and that runs the right way.
    fn cell_on_side(&self, of_points: &Numbered<'_>, i: usize, sign: f64) -> Option<usize> {
        let q = self.places[i];
        let led_to = [false, true].into_iter().filter_map(|forth| {
            let near = (1..=tuning::FURTHEST_NEIGHBOUR * self.reach).map_while(|steps| self.beside(i, steps, forth));
            let mut known = near.filter_map(|j| Some((j, of_points.known(j)?)));
            let (_, start) = known.find(|(j, cell)| sign * self.along(*j, *cell) > 0.0)?;
            let cell = self.map.nearest_from(start, &q);
            (sign * self.along(i, cell) > 0.0 && !self.map.is_beyond_end(cell, &q)).then_some(cell)
        });
        let distance = |cell: &usize| (self.map.cells()[*cell].centre - q).norm_squared();
        led_to.min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }
}

/// Points with the numbers of their cells, of which there are so many, and their weights.
struct Numbered<'a> {
    numbers: &'a mut [u32],
    weights: &'a [f64],
    cells: usize,
}

impl Numbered<'_> {
    /// The cell of a point that counts.
    #[inline(always)]
    fn known(&self, i: usize) -> Option<usize> {
        let number = self.numbers[i] as usize;
        (number < self.cells && self.weights[i] > 0.0).then_some(number)
    }
}

impl View<'_> {
    /// Gives points whose cell runs against the contour one that does not, on from the cells of the points before and after them.
    /// `places` say where along the outline the points of the frame lie, in the body frame; they may run either way around it.
    ///
    /// Where the object is not much thicker than the noise, the nearest cell may be on the other side. The smaller one of two residuals
    /// falls less than it should as the pose comes nearer, and the information would be overrated.
    pub(super) fn keep_to_sides(
        &self,
        (numbers, weights): (&mut [u32], &[f64]),
        pieces: &[Piece],
        places: &[Point2<f64>],
        half_window: usize,
    ) {
        let reach = half_window.max(tuning::FEWEST_NEIGHBOURS);
        for piece in pieces {
            let (numbers, weights) = (&mut numbers[piece.range()], &weights[piece.range()]);
            let of_points = Numbered { numbers, weights, cells: self.map.cells().len() };
            let directed = DirectedPiece { map: self.map, places: &places[piece.range()], closed: piece.closed, reach };
            let count = weights.len();
            if count <= 2 * reach {
                continue;
            }
            let (mut forth, mut total) = vectorised(
                #[inline(always)]
                || directed.count_forth(&of_points),
            );
            for i in (0..reach).chain(count - reach..count) {
                if let Some(cell) = of_points.known(i) {
                    forth += usize::from(directed.along(i, cell) > 0.0);
                    total += 1;
                }
            }
            let (most, sign) = if 2 * forth > total { (forth, 1.0) } else { (total - forth, -1.0) };
            if most == total || (most as f64) < tuning::SURE_DIRECTION * total as f64 {
                continue;
            }
            for i in 0..count {
                let Some(cell) = of_points.known(i) else { continue };
                if sign * directed.along(i, cell) < 0.0 {
                    of_points.numbers[i] = directed.cell_on_side(&of_points, i, sign).unwrap_or(cell) as u32;
                }
            }
        }
    }
}
