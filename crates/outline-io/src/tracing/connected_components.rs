//! Objects as runs of pixels that touch each other.
use std::collections::HashMap;
use std::ops::Range;

/// Pixels next to each other in one row: columns `start` to `end - 1`. A picture may have half as many as it has pixels.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Run {
    row: u32,
    start: u32,
    end: u32,
}

impl Run {
    /// The row.
    pub(crate) fn row(self) -> usize {
        self.row as usize
    }

    /// The columns.
    pub(crate) fn columns(self) -> Range<usize> {
        self.start as usize..self.end as usize
    }

    fn length(self) -> u32 {
        self.end - self.start
    }
}

/// Whether pixels that touch at a corner only are connected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Connectivity {
    /// Neighbours share an edge.
    Four,
    /// Neighbours share an edge or a corner.
    Eight,
}

/// Connected components of a set of pixels, as runs: 16 bytes for each, whatever the number of pixels.
#[derive(Debug)]
pub(crate) struct Components {
    runs: Vec<Run>,
    /// Index of the first run of each run's component.
    roots: Vec<u32>,
}

impl Components {
    /// Labels the pixels for which `set(column, row)` is true, of a picture of fewer than 2^32 pixels.
    pub(crate) fn of(
        width: usize,
        height: usize,
        connectivity: Connectivity,
        set: impl Fn(usize, usize) -> bool,
    ) -> Self {
        Self::of_rows(width, height, connectivity, |row, is_set| {
            is_set.iter_mut().enumerate().for_each(|(column, is_set)| *is_set = u8::from(set(column, row)));
        })
    }

    /// As [`of`](Self::of), with what `tell(row, is_set)` says of all pixels of a row at once: 1 of those that are set, 0 of others.
    pub(crate) fn of_rows(
        width: usize,
        height: usize,
        connectivity: Connectivity,
        tell: impl Fn(usize, &mut [u8]),
    ) -> Self {
        let reach = usize::from(connectivity == Connectivity::Eight);
        let mut runs: Vec<Run> = Vec::new();
        let mut parents: Vec<u32> = Vec::new();
        let mut is_set = vec![0; width];
        let mut above = 0..0;
        for row in 0..height {
            tell(row, &mut is_set);
            let first = runs.len();
            let mut candidate = above.start;
            let mut start = first_from(&is_set, 0, 1);
            while start < width {
                let end = first_from(&is_set, start, 0);
                let index = runs.len();
                runs.push(Run { row: row as u32, start: start as u32, end: end as u32 });
                parents.push(index as u32);
                while candidate < above.end && runs[candidate].end as usize + reach <= start {
                    candidate += 1;
                }
                let mut touching = candidate;
                while touching < above.end && (runs[touching].start as usize) < end + reach {
                    join(&mut parents, touching as u32, index as u32);
                    touching += 1;
                }
                start = first_from(&is_set, end, 1);
            }
            above = first..runs.len();
        }
        // A parent comes before its children, so that its own root is known by then.
        for index in 0..parents.len() {
            parents[index] = parents[parents[index] as usize];
        }
        Self { runs, roots: parents }
    }

    /// Number of pixels of every component, under the index of its first run, in the order of these.
    pub(crate) fn pixel_counts(&self) -> impl Iterator<Item = (u32, u64)> + use<> {
        let mut counts = vec![0_u32; self.runs.len()];
        for (run, root) in self.runs.iter().zip(&self.roots) {
            counts[*root as usize] += run.length();
        }
        (0..).zip(counts).filter(|(_, count)| *count > 0).map(|(root, count)| (root, u64::from(count)))
    }

    /// The runs of these components, which are named by their first runs and come in their order.
    pub(crate) fn into_runs_of(self, wanted: &[u32]) -> Vec<Vec<Run>> {
        let Self { runs, mut roots } = self;
        let places: HashMap<u32, u32> = wanted.iter().copied().zip(0..).collect();
        let mut counts = vec![0_usize; wanted.len()];
        // The root of a run becomes the place of its component. That of an earlier run, which the root is, has done so already.
        for index in 0..roots.len() {
            let root = roots[index] as usize;
            roots[index] =
                if root == index { places.get(&(index as u32)).copied().unwrap_or(u32::MAX) } else { roots[root] };
            if let Some(count) = counts.get_mut(roots[index] as usize) {
                *count += 1;
            }
        }
        let mut found: Vec<Vec<Run>> = counts.into_iter().map(Vec::with_capacity).collect();
        for (run, place) in runs.iter().zip(&roots) {
            if let Some(of_component) = found.get_mut(*place as usize) {
                of_component.push(*run);
            }
        }
        found
    }

    /// The runs of all components but that of the first run.
    pub(crate) fn runs_but_first(&self) -> impl Iterator<Item = Run> {
        self.runs.iter().zip(&self.roots).filter(|(_, root)| **root != 0).map(|(run, _)| *run)
    }
}

/// The first place from one on with this number, 0 or 1, of those that are one or the other, or the end. Most pixels are as their neighbours are, so
/// that eight are looked at at once.
fn first_from(is_set: &[u8], from: usize, wanted: u8) -> usize {
    let others = u64::from_le_bytes([1 - wanted; 8]);
    let rest = &is_set[from..];
    let (eights, last) = rest.as_chunks::<8>();
    for (block, eight) in eights.iter().enumerate() {
        let differ = u64::from_le_bytes(*eight) ^ others;
        if differ != 0 {
            return from + 8 * block + differ.trailing_zeros() as usize / 8;
        }
    }
    let of_last = last.iter().position(|set| *set == wanted);
    from + of_last.map_or(rest.len(), |place| rest.len() - last.len() + place)
}

fn root(parents: &mut [u32], mut index: u32) -> u32 {
    while parents[index as usize] != index {
        parents[index as usize] = parents[parents[index as usize] as usize];
        index = parents[index as usize];
    }
    index
}

/// The lower index becomes the root, so that a root is the first run of its component.
fn join(parents: &mut [u32], a: u32, b: u32) {
    let (a, b) = (root(parents, a), root(parents, b));
    parents[a.max(b) as usize] = a.min(b);
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Component sizes by flood fill, in order of size.
    fn flood_fill(cells: &[Vec<bool>], connectivity: Connectivity) -> Vec<u64> {
        let (height, width) = (cells.len() as i32, cells[0].len() as i32);
        let mut seen = cells.iter().map(|row| row.iter().map(|set| !set).collect::<Vec<_>>()).collect::<Vec<_>>();
        let mut sizes = vec![];
        for (row, column) in (0..height).flat_map(|row| (0..width).map(move |column| (row, column))) {
            let (mut stack, mut size) = (vec![(row, column)], 0);
            while let Some((r, c)) = stack.pop() {
                let on_board = (0..height).contains(&r) && (0..width).contains(&c);
                if !on_board || std::mem::replace(&mut seen[r as usize][c as usize], true) {
                    continue;
                }
                size += 1;
                for (dr, dc) in (-1..=1).flat_map(|dr| (-1..=1).map(move |dc| (dr, dc))) {
                    if connectivity == Connectivity::Eight || dr * dc == 0 {
                        stack.push((r + dr, c + dc));
                    }
                }
            }
            if size > 0 {
                sizes.push(size);
            }
        }
        sizes.sort_unstable();
        sizes
    }

    proptest! {
        #[test]
        fn components_are_those_of_a_flood_fill(
            cells in (1..30_usize, 1..12_usize)
                .prop_flat_map(|(w, h)| prop::collection::vec(prop::collection::vec(any::<bool>(), w), h)),
        ) {
            for connectivity in [Connectivity::Four, Connectivity::Eight] {
                let set = |column: usize, row: usize| cells[row][column];
                let components = Components::of(cells[0].len(), cells.len(), connectivity, set);
                let counts: Vec<(u32, u64)> = components.pixel_counts().collect();
                let mut sizes: Vec<u64> = counts.iter().map(|(_, count)| *count).collect();
                sizes.sort_unstable();
                prop_assert_eq!(sizes, flood_fill(&cells, connectivity));
                let wanted: Vec<u32> = counts.iter().rev().step_by(2).map(|(root, _)| *root).collect();
                let lengths = components.into_runs_of(&wanted).into_iter().map(|runs| runs.into_iter().map(Run::length).sum::<u32>());
                let expected = counts.iter().rev().step_by(2).map(|(_, count)| *count as u32);
                prop_assert_eq!(lengths.collect::<Vec<_>>(), expected.collect::<Vec<_>>());
            }
        }
    }
}
