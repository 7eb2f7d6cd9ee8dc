//! The windows of a regression along an outline.

use crate::vectors::reserve;

/// Nodes whose windows are looked for together.
const LANES: usize = 4;
/// Nodes that the edges of their windows are looked for among at a time.
const AHEAD: usize = 8;
/// Nodes that are added beyond the last one for the search.
pub(crate) const BEYOND: usize = LANES + AHEAD;
/// Ends of windows that are written at a time.
const ENDS: usize = 4;

/// For every node of an extended piece, the nodes within a distance along the piece, and the first ones beyond.
#[derive(Debug, Default, Clone)]
pub(crate) struct Windows {
    /// For every node from the first point on, how many nodes lie further before it than the distance.
    nodes_before: Vec<u32>,
    /// For every node the first one that lies further after it than the distance; the number of nodes where there is none.
    first_after: Vec<u32>,
    nodes: usize,
}

impl Windows {
    /// Makes room for so many nodes.
    pub(crate) fn reserve(&mut self, nodes: usize) {
        reserve(&mut self.nodes_before, nodes + LANES);
        reserve(&mut self.first_after, nodes + ENDS);
    }

    /// Finds the windows of the nodes from `first` on, at these finite, increasing arc lengths: `distance` is not negative.
    ///
    /// One edge is found by counting, for a few nodes at once and without a branch that the outline decides. The other needs no
    /// search: node j is beyond the window of i exactly if i is beyond that of j.
    #[inline(always)]
    pub(crate) fn find(&mut self, arc_lengths: &mut Vec<f64>, first: usize, distance: f64) {
        let nodes = arc_lengths.len();
        self.nodes = nodes;
        // Beyond the last node, for whole groups.
        arc_lengths.resize(nodes + BEYOND, f64::INFINITY);
        self.count_before(arc_lengths, first, nodes, distance);
        self.invert(first, nodes);
        arc_lengths.truncate(nodes);
    }

    #[inline(always)]
    fn count_before(&mut self, arc_lengths: &[f64], first: usize, nodes: usize, distance: f64) {
        let count = nodes - first;
        self.nodes_before.resize(count.next_multiple_of(LANES), 0);
        let (groups, _) = self.nodes_before.as_chunks_mut::<LANES>();
        let mut passed = 0;
        for (group, out) in (first..nodes).step_by(LANES).zip(groups) {
            let limits: [f64; LANES] = std::array::from_fn(|lane| arc_lengths[group + lane] - distance);
            // Beyond the last node they are infinite, and so is what they would be compared with.
            let last = limits[(nodes - group).min(LANES) - 1];
            let mut counts = [0_u64; LANES];
            let mut looked_at = passed;
            loop {
                for s in &arc_lengths[looked_at..looked_at + AHEAD] {
                    counts.iter_mut().zip(&limits).for_each(|(count, limit)| *count += u64::from(s < limit));
                }
                looked_at += AHEAD;
                if arc_lengths[looked_at - 1] >= last {
                    break;
                }
            }
            *out = counts.map(|count| (passed as u64 + count) as u32);
            passed = out[(nodes - group).min(LANES) - 1] as usize;
        }
        self.nodes_before.truncate(count);
    }

    #[inline(always)]
    fn invert(&mut self, first: usize, nodes: usize) {
        self.first_after.resize(nodes + ENDS, 0);
        let mut done = 0;
        for (node, &before) in (first as u32..).zip(&self.nodes_before) {
            let before = before as usize;
            // What is written too far is written over by the nodes after this one.
            if let Some(ends) = self.first_after[done..].first_chunk_mut::<ENDS>() {
                *ends = [node; ENDS];
            }
            if before > done + ENDS {
                self.first_after[done + ENDS..before].fill(node);
            }
            done = before;
        }
        self.first_after[done..].fill(nodes as u32);
    }

    /// The windows from node `first` on: the first node in and the first one not in it any more.
    #[inline(always)]
    pub(crate) fn iter(&self, first: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        let windows = self.nodes_before.iter().zip(&self.first_after[first..]);
        windows.map(|(before, after)| (before.saturating_sub(1) as usize, (*after as usize + 1).min(self.nodes)))
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt as _, SeedableRng as _};

    use super::*;

    /// Written for reading.
    fn reference(arc_lengths: &[f64], node: usize, distance: f64) -> (usize, usize) {
        let s = arc_lengths[node];
        let begin = arc_lengths.iter().rposition(|other| *other < s - distance).unwrap_or(0);
        let end =
            arc_lengths.iter().position(|other| *other - distance > s).map_or(arc_lengths.len(), |after| after + 1);
        (begin, end)
    }

    #[test]
    fn the_windows_are_those_of_a_search_node_by_node_however_the_nodes_are_spread() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        let mut windows = Windows::default();
        for round in 0..300_i32 {
            let nodes = rng.random_range(1..200_usize);
            // From evenly spread to a few far jumps among many repeated nodes.
            let unevenness = f64::from(round % 6);
            let mut s = 0.0;
            let mut arc_lengths: Vec<f64> = (0..nodes)
                .map(|_| {
                    let step = rng.random::<f64>().powf(3.0 * unevenness);
                    s += if step < 0.01 { 0.0 } else { step };
                    s
                })
                .collect();
            let distance = s * [0.0, 0.02, 0.25, 1.5][round as usize % 4];
            let first = rng.random_range(0..nodes);
            windows.find(&mut arc_lengths, first, distance);
            let found: Vec<_> = windows.iter(first).collect();
            let expected: Vec<_> = (first..nodes).map(|node| reference(&arc_lengths, node, distance)).collect();
            assert_eq!(found, expected, "round {round}");
        }
    }
}
