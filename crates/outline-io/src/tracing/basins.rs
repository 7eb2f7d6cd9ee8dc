//! Low ground closed in by higher ground, found by a rising flood.
use std::ops::Range;

use crate::tracing::field::Field;

/// Steps that values are told apart by.
const LEVELS: usize = 1 << 14;

/// A stretch of low ground closed in by higher ground: what a rising flood fills before it reaches the edge of the grid or
/// a larger stretch. At the edge of the grid, what it fills before it reaches a larger stretch there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Basin {
    /// Index of one of its samples.
    pub(crate) seed: usize,
    /// The lowest point of what closes it in.
    pub(crate) level: f32,
    /// Samples below that level, and the one where it overflows.
    pub(crate) area: u32,
    /// Whether the edge of the grid is part of what closes it in.
    pub(crate) at_edge: bool,
}

/// All basins of at least this area that overflow above a level of at least 0, by a flood that rises over the sorted samples (Vincent and
/// Soille, Watersheds in digital spaces, 1991; here with the union of sets, so that every basin knows the level at which it overflows).
/// Samples are 4-connected, so that what closes a basin in is 8-connected. Values are told apart by 1/16384 of the largest.
///
/// What is under water at that level is found row by row: most samples are, and need not be sorted.
pub(crate) fn basins(field: &Field, smallest_area: u32, above: f32) -> Vec<Basin> {
    let largest = field.values.iter().copied().fold(0.0, f32::max);
    if largest <= 0.0 {
        return Vec::new();
    }
    let scale = (LEVELS - 1) as f32 / largest;
    let high = from_level(&field.values, level(above, scale), scale);
    let mut sets = Sets::under_water(field, &high);
    let mut found = Vec::new();
    // Division of 32 bits takes less than half of the time of 64.
    let [width, height] = [field.width, field.height].map(|length| length as u32);
    for sample in sorted(field, scale, &high) {
        let (x, y) = (sample % width, sample / width);
        let [left, right, top, bottom] = [x == 0, x + 1 == width, y == 0, y + 1 == height];
        let sample = sample as usize;
        sets.start(sample, left || right || top || bottom);
        let mut root = sample;
        let around = [
            (left, sample.wrapping_sub(1)),
            (right, sample + 1),
            (top, sample.wrapping_sub(field.width)),
            (bottom, sample + field.width),
        ];
        for (is_beyond, neighbour) in around {
            if is_beyond || !sets.started(neighbour) {
                continue;
            }
            let other = sets.root(neighbour);
            if other == root {
                continue;
            }
            let joined = sets.join_roots(root, other);
            root = joined.winner;
            if joined.extent.area() >= smallest_area && field.values[sample] > above {
                let (area, at_edge) = (joined.extent.area(), joined.extent.is_at_edge());
                found.push(Basin { seed: joined.loser, level: field.values[sample], area, at_edge });
            }
        }
    }
    found
}

/// Which of the levels told apart a value has.
fn level(value: f32, scale: f32) -> u32 {
    // The conversion keeps to what is not negative.
    ((value * scale) as u32).min(LEVELS as u32 - 1)
}

/// Indices of the values from a level on.
fn from_level(values: &[f32], from: u32, scale: f32) -> Vec<u32> {
    // The least value of that level, by halving the numbers that are not negative, which lie in the order of their bits.
    let (mut low, mut least) = (0, f32::INFINITY.to_bits());
    while low < least {
        let middle = low.midpoint(least);
        if level(f32::from_bits(middle), scale) < from { low = middle + 1 } else { least = middle }
    }
    let least = f32::from_bits(least);
    let count: usize = values.iter().map(|value| usize::from(*value >= least)).sum();
    // Every index is written, and only those that count are kept: whether one does cannot be foreseen.
    let (mut indices, mut end) = (vec![0; count + 1], 0);
    for (index, value) in (0_u32..).zip(values) {
        indices[end] = index;
        end += usize::from(*value >= least);
    }
    indices.truncate(end);
    indices
}

/// Some of the samples, by their indices, from the lowest to the highest.
fn sorted(field: &Field, scale: f32, samples: &[u32]) -> Vec<u32> {
    let level_of = |index: u32| level(field.values[index as usize], scale) as usize;
    let mut starts = vec![0_u32; LEVELS + 1];
    samples.iter().for_each(|&index| starts[level_of(index) + 1] += 1);
    (1..=LEVELS).for_each(|index| starts[index] += starts[index - 1]);
    let mut order = vec![0; samples.len()];
    for &index in samples {
        let place = &mut starts[level_of(index)];
        order[*place as usize] = index;
        *place += 1;
    }
    order
}

/// Number of samples of a set, and above all whether it reaches the edge of the grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Extent(u32);

impl Extent {
    const AT_EDGE: u32 = 1 << 31;

    fn of_one(at_edge: bool) -> Self {
        Self(if at_edge { Self::AT_EDGE | 1 } else { 1 })
    }

    fn is_at_edge(self) -> bool {
        self.0 & Self::AT_EDGE != 0
    }

    fn area(self) -> u32 {
        self.0 & !Self::AT_EDGE
    }
}

/// Two sets that have become one.
struct Joined {
    /// Root of both from now on.
    winner: usize,
    /// Root of the one that has lost its own name, and its extent.
    loser: usize,
    extent: Extent,
}

/// Sets of samples under water.
struct Sets {
    /// Towards the root of the set; a sample above water is `u32::MAX`.
    parents: Vec<u32>,
    /// Of the set of a root.
    extents: Vec<Extent>,
}

impl Sets {
    /// The sets of connected samples that are under water, which all but the `high` ones are; these in order.
    fn under_water(field: &Field, mut high: &[u32]) -> Self {
        let (width, height, count) = (field.width, field.height, field.values.len());
        let mut sets = Self { parents: vec![u32::MAX; count], extents: vec![Extent(0); count] };
        let (mut above, mut runs): (Vec<Range<usize>>, Vec<Range<usize>>) = (Vec::new(), Vec::new());
        for row in 0..height {
            let is_edge_row = row == 0 || row + 1 == height;
            let (first, end) = (row * width, (row + 1) * width);
            let (of_row, rest) = high.split_at(high.partition_point(|index| (*index as usize) < end));
            high = rest;
            let mut start = first;
            for stop in of_row.iter().map(|index| *index as usize).chain([end]) {
                if stop > start {
                    let mut extent = Extent::of_one(is_edge_row || start == first || stop == end);
                    extent.0 += (stop - start) as u32 - 1;
                    sets.extents[start] = extent;
                    sets.parents[start..stop].fill(start as u32);
                    runs.push(start..stop);
                }
                start = stop + 1;
            }
            sets.join_rows(&above, &runs, width);
            std::mem::swap(&mut above, &mut runs);
            runs.clear();
        }
        sets
    }

    /// Joins runs of samples with those of the row above.
    fn join_rows(&mut self, above: &[Range<usize>], runs: &[Range<usize>], width: usize) {
        let mut first = 0;
        for run in runs {
            while above.get(first).is_some_and(|other| other.end + width <= run.start) {
                first += 1;
            }
            for other in above[first..].iter().take_while(|other| other.start + width < run.end) {
                self.join(run.start, other.start);
            }
        }
    }

    fn started(&self, index: usize) -> bool {
        self.parents[index] != u32::MAX
    }

    fn start(&mut self, index: usize, at_edge: bool) {
        self.parents[index] = index as u32;
        self.extents[index] = Extent::of_one(at_edge);
    }

    fn root(&mut self, mut index: usize) -> usize {
        while self.parents[index] as usize != index {
            let next = self.parents[self.parents[index] as usize];
            self.parents[index] = next;
            index = next as usize;
        }
        index
    }

    /// Joins the sets of two samples.
    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        if a != b {
            self.join_roots(a, b);
        }
    }

    /// Joins two sets by their roots.
    fn join_roots(&mut self, a: usize, b: usize) -> Joined {
        let (winner, loser) = if self.extents[a] >= self.extents[b] { (a, b) } else { (b, a) };
        let extent = self.extents[loser];
        self.parents[loser] = winner as u32;
        self.extents[winner].0 += extent.area();
        Joined { winner, loser, extent }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_basin_overflows_at_the_lowest_point_of_what_closes_it_in() {
        let rows: [[f32; 7]; 5] = [
            [0.0; 7],
            [0.0, 9.0, 9.0, 9.0, 9.0, 9.0, 0.0],
            [0.0, 9.0, 1.0, 1.0, 2.0, 6.0, 0.0],
            [0.0, 9.0, 9.0, 9.0, 9.0, 9.0, 0.0],
            [0.0; 7],
        ];
        let field = Field { width: 7, height: 5, values: rows.concat() };
        let found = basins(&field, 2, 0.0);
        assert_eq!(found.len(), 1);
        assert_eq!((found[0].level, found[0].area), (6.0, 4));
        assert_eq!(basins(&field, 5, 0.0), []);
    }

    #[test]
    fn the_edge_of_the_grid_closes_in_what_it_cuts_off() {
        let rows: [[f32; 7]; 4] = [
            [0.0, 9.0, 1.0, 2.0, 1.0, 9.0, 0.0],
            [0.0, 9.0, 1.0, 1.0, 1.0, 7.0, 0.0],
            [0.0, 9.0, 9.0, 8.0, 9.0, 9.0, 0.0],
            [0.0; 7],
        ];
        let field = Field { width: 7, height: 4, values: rows.concat() };
        let found: Vec<Basin> = basins(&field, 2, 0.0).into_iter().filter(|basin| basin.level > 0.0).collect();
        assert_eq!(found.len(), 1);
        assert_eq!((found[0].level, found[0].area, found[0].at_edge), (7.0, 7, true));
    }

    #[test]
    fn flat_ground_has_no_basin() {
        let field = Field { width: 4, height: 4, values: vec![0.0; 16] };
        assert_eq!(basins(&field, 1, 0.0), []);
    }

    proptest! {
        #[test]
        fn basins_above_a_level_are_those_of_a_flood_that_is_sorted_wholly(
            values in (1..14_usize, 1..14_usize).prop_flat_map(|(w, h)|
                prop::collection::vec(prop::collection::vec((0..9_u8).prop_map(f32::from), w), h)),
            above in 0..9_u8,
            smallest in 1..4_u32,
        ) {
            let field = Field { width: values[0].len(), height: values.len(), values: values.concat() };
            let above = f32::from(above);
            let told = |basins: Vec<Basin>| -> Vec<_> {
                let high = basins.into_iter().filter(|basin| basin.level > above);
                high.map(|Basin { level, area, at_edge, .. }| (level, area, at_edge)).collect()
            };
            prop_assert_eq!(told(basins(&field, smallest, above)), told(basins(&field, smallest, 0.0)));
        }
    }
}
