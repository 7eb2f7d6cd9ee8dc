//! The map grown by what a frame shows for the first time.
use freeform_curve_fit::Outline;
use nalgebra::Point2;

use super::{
    arrow_information::{CellInformation, StateVector},
    cell_scatter::Scatter,
    contour::{Contour, Place, SmoothPiece},
    map_update::Scratch,
    outline_map::{Cell, OutlineMap},
    reading::NO_CELL,
};

/// Places further than this many spacings from all cells are new.
const UNCOVERED: f64 = 1.1;
/// A map of so many times the places that any frame has shown at once holds what is not of the object, and grows no more: an
/// object of which less was seen at a time could not have been found again. Without this the map of an object that comes and
/// goes at the edge of the picture would grow for ever, by poses that its few points leave in doubt.
const MOST_TIMES_SEEN: usize = 8;
/// Shortest run of new places that is taken.
const SHORTEST_RUN: usize = 2;

impl Cell {
    /// One that nothing has been measured of.
    fn at(place: &Place, neighbours: [usize; 2]) -> Self {
        let Place { centre, normal } = *place;
        Self { centre, normal, offset: 0.0, scatter: Scatter::NEW, innovation: 0.0, neighbours }
    }
}

impl OutlineMap {
    /// Whether the next frame may show the turn where those before it did not. Says so of each growth once.
    pub(crate) fn may_show_turn(&mut self) -> bool {
        std::mem::take(&mut self.shows_turn_at_last) || self.turn_is_new && self.turn_is_hidden
    }

    /// A map of the same body frame of what one outline shows, in the pose that this map is in but for its turn, which is unknown as its
    /// motion is. `None` where that outline does not show the turn either.
    pub(crate) fn begun_anew(&self, outline: &Outline) -> Option<Self> {
        let mut map = Self::without_cells(self.model, self.origin, self.radius);
        map.pose = self.pose;
        map.load(outline);
        let contours = map.contours().collect();
        map.cut(contours, 0.0)?;
        if map.turn_is_unseen() {
            return None;
        }
        map.noise_level = self.noise_level;
        map.turn_is_new = true;
        map.begin_here_with_any_turn();
        Some(map)
    }

    /// Adds cells for the parts of the loaded outline that the map does not have yet, and measures them.
    pub(crate) fn grow(&mut self) {
        let contours = self.contours().collect();
        self.grow_along(contours);
    }

    /// The same for the parts of contours in the body frame, which the loaded points are of.
    pub(crate) fn grow_along(&mut self, contours: Vec<Contour>) {
        let first_new = self.cells.len();
        let scale = self.pose.fixed_view::<2, 2>(0, 0).determinant().abs().sqrt();
        let sigma = self.sigma / scale;
        let resampled = |mut contour: Contour| contour.resampled(sigma, self.half_window, self.spacing);
        let pieces: Vec<_> = contours.into_iter().filter_map(resampled).collect();
        let places = pieces.iter().map(|piece| piece.places.len()).sum();
        self.most_seen = self.most_seen.max(places);
        if first_new >= MOST_TIMES_SEEN * self.most_seen {
            return;
        }
        pieces.iter().for_each(|piece| self.add_places(piece, first_new));
        if self.cells.len() == first_new {
            return;
        }
        let centres: Vec<_> = self.cells.iter().map(|cell| cell.centre).collect();
        self.field.build(&centres, self.spacing);
        self.information.cells.resize(self.cells.len(), CellInformation::NOTHING);
        let (unseen, turn_was_unseen) = (self.unseen_in_image(&self.pose), self.turn_is_unseen());
        self.find_unseen_directions();
        if !unseen.is_empty() {
            self.forget(&unseen);
            self.forget(&self.unseen_in_image(&self.pose));
            self.shows_turn_at_last = turn_was_unseen && !self.turn_is_unseen();
        }
        let mut scratch = std::mem::take(&mut self.scratch);
        self.measure_new_cells(&mut scratch, first_new);
        self.scratch = scratch;
    }

    /// Appends the runs of places that no cell covers, linked along the contour.
    fn add_places(&mut self, piece: &SmoothPiece, first_new: usize) {
        let count = piece.places.len();
        let covering: Vec<Option<usize>> =
            piece.places.iter().map(|place| self.covering(&place.centre, first_new)).collect();
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
            if !new(run[0]) || run.len() < SHORTEST_RUN {
                continue;
            }
            let base = self.cells.len();
            for (i, place) in run.iter().map(|i| &piece.places[*i]).enumerate() {
                let neighbours = [base + i.saturating_sub(1), base + (i + 1).min(run.len() - 1)];
                self.cells.push(Cell::at(place, neighbours));
            }
            let (head, tail) = (run[0], run[run.len() - 1]);
            let wraps = |i: usize, on: bool| {
                if on && (piece.closed || i != 0) { covering[(i + count - 1) % count] } else { None }
            };
            self.link(wraps(head, true), base, 0);
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
    fn covering(&self, place: &Point2<f64>, first_new: usize) -> Option<usize> {
        if first_new == 0 {
            return None;
        }
        let number = self.nearest_cell(place)?;
        let cell = &self.cells[number];
        let at = cell.centre + cell.offset * cell.normal;
        ((at - place).norm() < UNCOVERED * self.spacing).then_some(number)
    }

    /// Takes the loaded points on cells from `first_new` on as their first measurement.
    fn measure_new_cells(&mut self, scratch: &mut Scratch, first_new: usize) {
        let unseen = self.unseen_in_image(&self.pose);
        scratch.shifts.clear();
        scratch.shifts.resize(self.cells.len(), 0.0);
        self.read_points(scratch, &self.pose, &unseen, true);
        scratch.readings.retain(|r| r.cell != NO_CELL && r.cell >= first_new);
        let mut work = self.information.clone();
        self.accumulate(scratch, &mut work, &StateVector::zeros());
        for (number, right) in scratch.right.iter().enumerate().skip(first_new) {
            if work.cells[number].own > 0.0 {
                self.cells[number].offset += right / work.cells[number].own;
            }
        }
        self.information = work;
        self.marginal = self.information.marginal();
    }
}

#[cfg(test)]
mod tests {
    use freeform_riccati::MotionModel;

    use super::*;

    #[test]
    fn a_map_that_wrong_poses_add_to_for_ever_stops_growing() {
        let egg = |shift: f64| {
            let point = |i: i32| {
                let t = std::f64::consts::TAU * f64::from(i) / 300.0;
                Point2::new(shift + 0.5 * t.cos() + 0.05 * (2.0 * t).cos(), 0.35 * t.sin())
            };
            Outline::closed((0..300).map(point).collect()).expect("an outline")
        };
        let mut map = OutlineMap::new(MotionModel::Rigid, &egg(0.0)).expect("a map");
        let first = map.cell_count();
        let mut counts = Vec::new();
        for frame in 1..30 {
            map.load(&egg(3.0 * f64::from(frame)));
            map.grow();
            counts.push(map.cell_count());
        }
        assert!(counts[0] > first && counts[28] <= (MOST_TIMES_SEEN + 1) * first + 10, "{first}: {counts:?}");
        assert_eq!(counts[27], counts[28]);
    }
}
