/// Pixels next to each other in one row: columns `start` to `end - 1`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Run {
    pub(crate) row: usize,
    pub(crate) start: usize,
    pub(crate) end: usize,
}

/// Whether pixels that touch at a corner only are connected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Connectivity {
    /// Neighbours share an edge.
    Four,
    /// Neighbours share an edge or a corner.
    Eight,
}

/// Connected components of a set of pixels, as runs. Memory is in proportion to the number of runs, not of pixels.
#[derive(Debug)]
pub(crate) struct Components {
    runs: Vec<Run>,
    /// Index of the first run of each run's component.
    roots: Vec<usize>,
}

impl Components {
    /// Labels the pixels for which `set(column, row)` is true.
    pub(crate) fn of(
        width: usize,
        height: usize,
        connectivity: Connectivity,
        set: impl Fn(usize, usize) -> bool,
    ) -> Self {
        let reach = usize::from(connectivity == Connectivity::Eight);
        let mut runs: Vec<Run> = Vec::new();
        let mut parents: Vec<usize> = Vec::new();
        let mut above = 0..0;
        for row in 0..height {
            let first = runs.len();
            let mut column = 0;
            let mut candidate = above.start;
            while column < width {
                if !set(column, row) {
                    column += 1;
                    continue;
                }
                let start = column;
                while column < width && set(column, row) {
                    column += 1;
                }
                let index = runs.len();
                runs.push(Run { row, start, end: column });
                parents.push(index);
                while candidate < above.end && runs[candidate].end + reach <= start {
                    candidate += 1;
                }
                let mut touching = candidate;
                while touching < above.end && runs[touching].start < column + reach {
                    join(&mut parents, touching, index);
                    touching += 1;
                }
            }
            above = first..runs.len();
        }
        let roots = (0..runs.len()).map(|index| root(&mut parents, index)).collect();
        Self { runs, roots }
    }

    /// Number of pixels of every component, under the index of its first run.
    pub(crate) fn pixel_counts(&self) -> Vec<(usize, u64)> {
        let mut counts = vec![0; self.runs.len()];
        for (run, root) in self.runs.iter().zip(&self.roots) {
            counts[*root] += (run.end - run.start) as u64;
        }
        counts.into_iter().enumerate().filter(|(_, count)| *count > 0).collect()
    }

    /// The runs of the component whose first run this is.
    pub(crate) fn runs_of(&self, root: usize) -> impl Iterator<Item = Run> {
        self.runs.iter().zip(&self.roots).filter(move |(_, own)| **own == root).map(|(run, _)| *run)
    }

    /// The runs of all other components.
    pub(crate) fn runs_not_of(&self, root: usize) -> impl Iterator<Item = Run> {
        self.runs.iter().zip(&self.roots).filter(move |(_, own)| **own != root).map(|(run, _)| *run)
    }
}

fn root(parents: &mut [usize], mut index: usize) -> usize {
    while parents[index] != index {
        parents[index] = parents[parents[index]];
        index = parents[index];
    }
    index
}

/// The lower index becomes the root, so that a root is the first run of its component.
fn join(parents: &mut [usize], a: usize, b: usize) {
    let (a, b) = (root(parents, a), root(parents, b));
    parents[a.max(b)] = a.min(b);
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
            cells in (1..12_usize, 1..12_usize)
                .prop_flat_map(|(w, h)| prop::collection::vec(prop::collection::vec(any::<bool>(), w), h)),
        ) {
            for connectivity in [Connectivity::Four, Connectivity::Eight] {
                let set = |column: usize, row: usize| cells[row][column];
                let components = Components::of(cells[0].len(), cells.len(), connectivity, set);
                let mut sizes: Vec<u64> = components.pixel_counts().into_iter().map(|(_, count)| count).collect();
                sizes.sort_unstable();
                prop_assert_eq!(sizes, flood_fill(&cells, connectivity));
            }
        }
    }
}
