use crate::field::Field;

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

/// All basins of at least this area, by a flood that rises over the sorted samples (Vincent and Soille, Watersheds in
/// digital spaces, 1991; here with the union of sets, so that every basin knows the level at which it overflows). Samples
/// are 4-connected, so that what closes a basin in is 8-connected. Values are told apart by 1/16384 of the largest.
pub(crate) fn basins(field: &Field, smallest_area: u32) -> Vec<Basin> {
    let largest = field.values.iter().copied().fold(0.0, f32::max);
    if largest <= 0.0 {
        return Vec::new();
    }
    let scale = (LEVELS - 1) as f32 / largest;
    let order = sorted(field, scale);
    let mut sets = Sets::new(field.values.len());
    let mut found = Vec::new();
    for &sample in &order {
        let sample = sample as usize;
        sets.start(sample, field.is_at_edge(sample));
        for neighbour in field.neighbours(sample) {
            if !sets.started(neighbour) {
                continue;
            }
            if let Some((seed, extent)) = sets.join(sample, neighbour)
                && extent.area() >= smallest_area
            {
                let (area, at_edge) = (extent.area(), extent.is_at_edge());
                found.push(Basin { seed, level: field.values[sample], area, at_edge });
            }
        }
    }
    found
}

/// Indices of the samples from the lowest to the highest.
fn sorted(field: &Field, scale: f32) -> Vec<u32> {
    let level = |value: f32| ((value * scale) as usize).min(LEVELS - 1);
    let mut starts = vec![0_u32; LEVELS + 1];
    field.values.iter().for_each(|value| starts[level(*value) + 1] += 1);
    (1..=LEVELS).for_each(|index| starts[index] += starts[index - 1]);
    let mut order = vec![0; field.values.len()];
    for (index, value) in (0_u32..).zip(&field.values) {
        let place = &mut starts[level(*value)];
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

/// Sets of samples under water.
struct Sets {
    /// Towards the root of the set; a sample above water is `u32::MAX`.
    parents: Vec<u32>,
    /// Of the set of a root.
    extents: Vec<Extent>,
}

impl Sets {
    fn new(count: usize) -> Self {
        Self { parents: vec![u32::MAX; count], extents: vec![Extent(0); count] }
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

    /// Joins the sets of two samples; root and extent of the one that loses its own name.
    fn join(&mut self, a: usize, b: usize) -> Option<(usize, Extent)> {
        let (a, b) = (self.root(a), self.root(b));
        if a == b {
            return None;
        }
        let (winner, loser) = if self.extents[a] >= self.extents[b] { (a, b) } else { (b, a) };
        let extent = self.extents[loser];
        self.parents[loser] = winner as u32;
        self.extents[winner].0 += extent.area();
        Some((loser, extent))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let found = basins(&field, 2);
        assert_eq!(found.len(), 1);
        assert_eq!((found[0].level, found[0].area), (6.0, 4));
        assert_eq!(basins(&field, 5), []);
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
        let found: Vec<Basin> = basins(&field, 2).into_iter().filter(|basin| basin.level > 0.0).collect();
        assert_eq!(found.len(), 1);
        assert_eq!((found[0].level, found[0].area, found[0].at_edge), (7.0, 7, true));
    }

    #[test]
    fn flat_ground_has_no_basin() {
        let field = Field { width: 4, height: 4, values: vec![0.0; 16] };
        assert_eq!(basins(&field, 1), []);
    }
}
