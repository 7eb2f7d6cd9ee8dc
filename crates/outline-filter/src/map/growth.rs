//! Cells added for what a frame shows for the first time.
use nalgebra::Point2;

use super::{
    Cell, Contour, OutlineMap,
    contour::{Place, SmoothPiece},
};
use crate::tuning::map as tuning;

impl Cell {
    fn at(place: &Place, neighbours: [usize; 2]) -> Self {
        let Place { centre, normal } = *place;
        Self { centre, normal, neighbours }
    }
}

impl OutlineMap {
    /// Adds cells for the parts of contours in the body frame, with noise of deviation `sigma` there, that no cell covers with its
    /// outline at the given offset. Number of the first new cell; `None` where there is none. Points can be associated with new cells once
    /// that [has been prepared](Self::prepare_association).
    pub(crate) fn grow(&mut self, contours: Vec<Contour>, sigma: f64, offsets: &[f64]) -> Option<usize> {
        let first_new = self.cells.len();
        let resampled = |mut contour: Contour| contour.resampled(sigma, self.half_window, self.spacing);
        let pieces: Vec<_> = contours.into_iter().filter_map(resampled).collect();
        let places = pieces.iter().map(|piece| piece.places.len()).sum();
        self.most_seen = self.most_seen.max(places);
        if first_new >= tuning::MOST_TIMES_SEEN * self.most_seen {
            return None;
        }
        pieces.iter().for_each(|piece| self.add_places(piece, first_new, offsets));
        (self.cells.len() > first_new).then_some(first_new)
    }

    /// Appends the runs of places that no cell covers, linked along the contour.
    fn add_places(&mut self, piece: &SmoothPiece, first_new: usize, offsets: &[f64]) {
        let count = piece.places.len();
        let covering: Vec<Option<usize>> =
            piece.places.iter().map(|place| self.covering(&place.centre, first_new, offsets)).collect();
        let new = |i: usize| covering[i].is_none();
        if !(0..count).any(new) {
            return;
        }
        if (0..count).all(new) {
            let base = self.cells.len();
            for (i, place) in piece.places.iter().enumerate() {
                let neighbours = if piece.closed {
                    [base + (i + count - 1) % count, base + (i + 1) % count]
                } else {
                    [base + i.saturating_sub(1), base + (i + 1).min(count - 1)]
                };
                self.cells.push(Cell::at(place, neighbours));
            }
            return;
        }
        // Start behind a covered place, so that no run wraps around.
        let start = if piece.closed { (0..count).find(|i| !new(*i)).unwrap_or(0) } else { 0 };
        let order: Vec<usize> = (0..count).map(|i| (start + i) % count).collect();
        for run in order.chunk_by(|a, b| new(*a) == new(*b)) {
            if !new(run[0]) || run.len() < tuning::SHORTEST_RUN {
                continue;
            }
            let base = self.cells.len();
            for (i, place) in run.iter().map(|i| &piece.places[*i]).enumerate() {
                let neighbours = [base + i.saturating_sub(1), base + (i + 1).min(run.len() - 1)];
                self.cells.push(Cell::at(place, neighbours));
            }
            let (head, tail) = (run[0], run[run.len() - 1]);
            let before = (piece.closed || head != 0).then(|| covering[(head + count - 1) % count]).flatten();
            self.link(before, base, 0);
            let after = (tail + 1 < count || piece.closed).then(|| covering[(tail + 1) % count]).flatten();
            let last = self.cells.len() - 1;
            self.link(after, last, 1);
        }
    }

    /// Joins a new end cell to the end of the known outline next to it.
    fn link(&mut self, old: Option<usize>, new: usize, side: usize) {
        let Some(mut old) = old else { return };
        // The free end is at most a few cells on.
        for _ in 0..4 {
            if let Some(free) = (0..2).find(|s| self.cells[old].neighbours[*s] == old) {
                self.cells[old].neighbours[free] = new;
                self.cells[new].neighbours[side] = old;
                return;
            }
            let target = self.cells[new].centre;
            let distance = |n: &usize| (self.cells[*n].centre - target).norm_squared();
            let [a, b] = self.cells[old].neighbours;
            old = if distance(&a) < distance(&b) { a } else { b };
        }
    }

    /// The cell that covers a place, among those older than `first_new`.
    fn covering(&self, place: &Point2<f64>, first_new: usize, offsets: &[f64]) -> Option<usize> {
        if first_new == 0 {
            return None;
        }
        let number = self.nearest(place)?;
        let at = self.outline_at(number, offsets);
        ((at - place).norm() < tuning::UNCOVERED * self.spacing).then_some(number)
    }

    /// Where the outline lies on the normal of a cell; new cells have no offset yet.
    pub(crate) fn outline_at(&self, number: usize, offsets: &[f64]) -> Point2<f64> {
        let cell = &self.cells[number];
        cell.centre + offsets.get(number).copied().unwrap_or(0.0) * cell.normal
    }
}
