//! The cells nearest to many places at once.
use nalgebra::{Point2, Vector2};

use super::{Cell, OutlineMap};
use crate::tuning::map as tuning;

/// Where the neighbours of a cell are nearer than the cell itself: beyond the line halfway to each.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bisectors {
    across: [Vector2<f64>; 2],
    at: [f64; 2],
    /// The cell itself, and its neighbours.
    cells: [u32; 3],
    is_end: bool,
}

impl Bisectors {
    /// Of a cell; an end has itself for a neighbour, which is nowhere nearer.
    fn of(number: usize, cells: &[Cell]) -> Self {
        let Cell { centre, neighbours, .. } = &cells[number];
        let others = neighbours.map(|neighbour| cells[neighbour].centre);
        Self {
            across: others.map(|other| 2.0 * (other - centre)),
            at: others.map(|other| other.coords.norm_squared() - centre.coords.norm_squared()),
            cells: [number, neighbours[0], neighbours[1]].map(|cell| cell as u32),
            is_end: neighbours.contains(&number),
        }
    }

    /// The nearest to a place of the cell and its neighbours. Which it is cannot be foreseen: it is looked up, without a branch.
    #[inline(always)]
    fn nearest(&self, q: &Point2<f64>) -> u32 {
        let beyond = |side: usize| {
            let across = &self.across[side];
            across.x * q.x + across.y * q.y - self.at[side]
        };
        let [a, b] = [beyond(0), beyond(1)];
        self.cells[usize::from((a > 0.0) | (b > 0.0)) * (1 + usize::from(b > a))]
    }
}

impl OutlineMap {
    /// Prepares what the cells nearest to places are found by; to be called whenever cells have changed.
    pub(crate) fn prepare_association(&mut self) {
        let centres: Vec<_> = self.cells.iter().map(|cell| cell.centre).collect();
        self.field.build(&centres, self.spacing);
        self.bisectors.clear();
        self.bisectors.extend((0..self.cells.len()).map(|number| Bisectors::of(number, &self.cells)));
        self.has_ends = self.bisectors.iter().any(|bisectors| bisectors.is_end);
    }

    /// Whether the outline is known to end anywhere.
    pub(crate) fn has_ends(&self) -> bool {
        self.has_ends
    }

    /// The cell nearest to a body point, from one near it.
    #[inline(always)]
    pub(crate) fn nearest_from(&self, near: usize, q: &Point2<f64>) -> usize {
        let mut number = near;
        // No more steps than cells: a place that is equally far from all of them might be handed round by rounding.
        for _ in 0..self.bisectors.len() {
            let nearest = self.bisectors[number].nearest(q) as usize;
            if nearest == number {
                break;
            }
            number = nearest;
        }
        number
    }

    /// Numbers of the cells nearest to places, one for each; that of no cell is the number of cells, where a place lies beyond a known end
    /// of the outline or there are no cells.
    #[inline(always)]
    pub(crate) fn associate(&self, places: impl Iterator<Item = Point2<f64>> + Clone, numbers: &mut [u32]) {
        self.associate_all(places.clone(), numbers);
        if !self.has_ends {
            return;
        }
        let none = self.cells.len() as u32;
        for (number, q) in numbers.iter_mut().zip(places) {
            if self.lies_beyond_end(*number as usize, &q) {
                *number = none;
            }
        }
    }

    /// Whether a place lies beyond a known end of the outline that the cell nearest to it is.
    #[inline(always)]
    pub(crate) fn lies_beyond_end(&self, nearest: usize, q: &Point2<f64>) -> bool {
        self.has_ends && self.bisectors[nearest].is_end && self.is_beyond_end(nearest, q)
    }

    /// As [`associate`](Self::associate), of places beyond ends too.
    #[inline(always)]
    pub(crate) fn associate_all(&self, places: impl Iterator<Item = Point2<f64>> + Clone, numbers: &mut [u32]) {
        if self.cells.is_empty() {
            numbers.fill(0);
            return;
        }
        // A first look at all of them waits for none.
        self.field.pixels(places.clone(), numbers);
        // Slices are near at hand in a loop, vectors are looked up each time.
        let (nearest, bisectors) = (self.field.nearest(), self.bisectors.as_slice());
        let mut places = places;
        let mut moved = [(0_u32, Point2::origin()); tuning::ASSOCIATED_AT_ONCE];
        for numbers in numbers.chunks_mut(tuning::ASSOCIATED_AT_ONCE) {
            let mut count = 0;
            for ((at, number), q) in (0..).zip(numbers.iter_mut()).zip(&mut places) {
                let named = nearest[*number as usize];
                *number = bisectors[named as usize].nearest(&q);
                // Written in any case: which of them have moved cannot be foreseen.
                moved[count] = (at, q);
                count += usize::from(*number != named);
            }
            // Where the cell named is nearer than its neighbours there is nothing more to be asked; next to none have to go further.
            for (at, q) in &moved[..count] {
                let number: &mut u32 = &mut numbers[*at as usize];
                let further = bisectors[*number as usize].nearest(q);
                if further != *number {
                    *number = self.nearest_from(further as usize, q) as u32;
                }
            }
        }
    }
}
