//! Cells added for what a frame shows for the first time.
use nalgebra::{Point2, Vector2};

use super::{
    Cell, Contour, OutlineMap,
    contour::{Place, SmoothPiece},
};
use crate::tuning::map as tuning;

/// What to do with a part of a contour that branches off the known outline although the outline goes on there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Detours {
    /// It is added: one of the two was hidden, or is no more there.
    Added,
    /// It is left out: it may belong to something that touches the object.
    LeftOut,
}

/// Places of a contour, one after the other, that no cell covers.
struct Run<'a> {
    places: Vec<&'a Place>,
    /// Whether they are all of a closed contour.
    closed: bool,
    /// The cells that cover the places before and behind it.
    ends: [Option<usize>; 2],
}

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
    pub(crate) fn grow(
        &mut self,
        contours: Vec<Contour>,
        sigma: f64,
        offsets: &[f64],
        detours: Detours,
    ) -> Option<usize> {
        let first_new = self.cells.len();
        let resampled = |mut contour: Contour| contour.resampled(sigma, self.half_window, self.spacing);
        let pieces: Vec<_> = contours.into_iter().filter_map(resampled).collect();
        let places = pieces.iter().map(|piece| piece.places.len()).sum();
        self.most_seen = self.most_seen.max(places);
        if first_new >= tuning::MOST_TIMES_SEEN * self.most_seen {
            return None;
        }
        let runs: Vec<_> = pieces.iter().flat_map(|piece| self.new_runs(piece, first_new, offsets)).collect();
        let asked = |run: &Run<'_>| detours == Detours::LeftOut && self.is_detour(run);
        let (left_out, mut taken): (Vec<_>, Vec<_>) = runs.into_iter().partition(asked);
        if !left_out.is_empty() {
            // What lies apart may be of what touches the object as well.
            taken.retain(|run| run.ends.iter().any(Option::is_some));
        }
        taken.iter().for_each(|run| self.add(run));
        (self.cells.len() > first_new).then_some(first_new)
    }

    /// The runs of places of a contour that no cell older than `first_new` covers.
    fn new_runs<'a>(&self, piece: &'a SmoothPiece, first_new: usize, offsets: &[f64]) -> Vec<Run<'a>> {
        let count = piece.places.len();
        let covering: Vec<Option<usize>> =
            piece.places.iter().map(|place| self.covering(&place.centre, first_new, offsets)).collect();
        let new = |i: usize| covering[i].is_none();
        if (0..count).all(new) {
            return vec![Run { places: piece.places.iter().collect(), closed: piece.closed, ends: [None; 2] }];
        }
        // Start behind a covered place, so that no run wraps around.
        let start = if piece.closed { (0..count).find(|i| !new(*i)).unwrap_or(0) } else { 0 };
        let order: Vec<usize> = (0..count).map(|i| (start + i) % count).collect();
        let runs = order.chunk_by(|a, b| new(*a) == new(*b));
        let of_new = runs.filter(|run| new(run[0]) && run.len() >= tuning::SHORTEST_RUN).map(|run| {
            let (head, tail) = (run[0], run[run.len() - 1]);
            let before = (piece.closed || head != 0).then(|| covering[(head + count - 1) % count]);
            let after = (piece.closed || tail + 1 < count).then(|| covering[(tail + 1) % count]);
            let places = run.iter().map(|i| &piece.places[*i]).collect();
            Run { places, closed: false, ends: [before.flatten(), after.flatten()] }
        });
        of_new.collect()
    }

    /// Appends cells for a run, linked along the contour.
    fn add(&mut self, Run { places, closed, ends: [before, after] }: &Run<'_>) {
        let (base, count) = (self.cells.len(), places.len());
        for (i, place) in places.iter().enumerate() {
            let neighbours = if *closed {
                [base + (i + count - 1) % count, base + (i + 1) % count]
            } else {
                [base + i.saturating_sub(1), base + (i + 1).min(count - 1)]
            };
            self.cells.push(Cell::at(place, neighbours));
        }
        self.link(*before, base, 0);
        self.link(*after, base + count - 1, 1);
    }

    /// Whether a run branches off the known outline where that goes on for longer than the run reaches along it: what comes into view at an end of
    /// the outline has passed no more than that.
    fn is_detour(&self, run: &Run<'_>) -> bool {
        let (first, last) = (run.places[0], run.places[run.places.len() - 1]);
        let across = last.centre - first.centre;
        run.ends.into_iter().zip([(first, 1), (last, 0)]).any(|(end, (place, side))| {
            let Some(end) = end else { return false };
            let normal = &self.cells[end].normal;
            let reach = Vector2::new(-normal.y, normal.x).dot(&across).abs();
            let most = (reach / self.spacing) as usize + tuning::BESIDE_END;
            // A contour may run the other way than the map.
            let side = if place.normal.dot(normal) < 0.0 { 1 - side } else { side };
            !self.ends_soon(end, side, most)
        })
    }

    /// Whether the known outline ends less than so many cells on from one of them.
    fn ends_soon(&self, cell: usize, side: usize, most: usize) -> bool {
        let (mut last, mut here) = (self.cells[cell].neighbours[1 - side], cell);
        (0..most).any(|_| {
            let next = self.cells[here].beyond(last);
            last = std::mem::replace(&mut here, next);
            here == last
        })
    }

    /// Joins a new end cell to the end of the known outline next to it.
    fn link(&mut self, old: Option<usize>, new: usize, side: usize) {
        let centre = self.cells[new].centre;
        if let Some((old, free)) = old.and_then(|old| self.free_end_near(old, &centre)) {
            self.cells[old].neighbours[free] = new;
            self.cells[new].neighbours[side] = old;
        }
    }

    /// The end of the known outline that lies a few cells on from one of them towards a place, and its free side.
    fn free_end_near(&self, mut known: usize, place: &Point2<f64>) -> Option<(usize, usize)> {
        for _ in 0..tuning::BESIDE_END {
            let [a, b] = self.cells[known].neighbours;
            if let Some(free) = [a, b].iter().position(|neighbour| *neighbour == known) {
                return Some((known, free));
            }
            let distance = |n: usize| (self.cells[n].centre - place).norm_squared();
            known = if distance(a) < distance(b) { a } else { b };
        }
        None
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
