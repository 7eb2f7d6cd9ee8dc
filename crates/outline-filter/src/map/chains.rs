//! Chains of cells, and points in their order along them.
use freeform_curve_fit::share_along_side;
use nalgebra::Point2;

use super::OutlineMap;
use crate::tuning::{map::FEWEST_POINTS, remapping as tuning};

/// A point in the body frame with the cell that it was seen of, if any.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CellPoint {
    pub(crate) cell: Option<usize>,
    /// Where along the outline it lies, which its neighbours know better than it does.
    pub(crate) place: Point2<f64>,
    /// Where it lies.
    pub(crate) at: Point2<f64>,
}

/// Points in their order along a chain of cells, with how far along it they lie, in cells.
pub(crate) type Run = Vec<(f64, Point2<f64>)>;

impl OutlineMap {
    /// Whether most of the points of the frames are the same places of the outline, which cut no finer cells together.
    pub(crate) fn has_common_points(&self, points: &[CellPoint]) -> bool {
        // In the order of their cells, those without one last.
        let cell_of = |point: &CellPoint| point.cell.unwrap_or(self.cells.len());
        let mut ends = vec![0; self.cells.len() + 2];
        points.iter().for_each(|point| ends[cell_of(point) + 1] += 1);
        (1..ends.len()).for_each(|cell| ends[cell] += ends[cell - 1]);
        let mut order = vec![Point2::origin(); points.len()];
        for point in points {
            let end = &mut ends[cell_of(point)];
            order[*end] = point.at;
            *end += 1;
        }
        let mut start = 0;
        for end in ends {
            order[start..end].sort_by(|a, b| a.x.total_cmp(&b.x));
            start = end;
        }
        let limit = tuning::COINCIDENT * self.spacing;
        let common = order.windows(2).filter(|pair| (pair[0] - pair[1]).norm() < limit).count();
        2 * common > points.len()
    }

    /// Points in the body frame, given with their cells and places, in their order along each chain of cells with how far along it they
    /// lie, in cells; and whether the chain is closed.
    pub(crate) fn along_chains(&self, points: Vec<CellPoint>, offsets: &[f64]) -> Vec<(Run, bool)> {
        let chains = self.chains();
        let mut place_of = vec![(0, 0); self.cells.len()];
        for (number, (chain, _)) in chains.iter().enumerate() {
            chain.iter().enumerate().for_each(|(index, cell)| place_of[*cell] = (number, index));
        }
        let mut runs: Vec<Run> = vec![Vec::new(); chains.len()];
        for CellPoint { cell, place, at } in points {
            let Some(cell) = cell else { continue };
            let (number, index) = place_of[cell];
            let (chain, closed) = &chains[number];
            runs[number].push((index as f64 + self.along(chain, *closed, index, &place, offsets), at));
        }
        let kept = runs.into_iter().zip(&chains).filter(|(run, _)| run.len() >= FEWEST_POINTS);
        kept.map(|(mut run, (_, closed))| {
            run.sort_by(|a, b| a.0.total_cmp(&b.0));
            (run, *closed)
        })
        .collect()
    }

    /// How far along the line through the cells of a chain a point lies from the cell nearest to it, in cells.
    fn along(&self, chain: &[usize], closed: bool, index: usize, q: &Point2<f64>, offsets: &[f64]) -> f64 {
        let count = chain.len();
        let at = |i: usize| self.outline_at(chain[i], offsets);
        let here = at(index);
        let towards = |other: Option<usize>| {
            let there = at(other?);
            let share = share_along_side(&here, &there, q);
            Some((share, (here + share * (there - here) - q).norm_squared()))
        };
        let after = if index + 1 < count { Some(index + 1) } else { closed.then_some(0) };
        let before = if index > 0 { Some(index - 1) } else { closed.then_some(count - 1) };
        match (towards(after), towards(before)) {
            (Some((share, near)), Some((_, far))) if near <= far => share,
            (_, Some((share, _))) => -share,
            (Some((share, _)), None) => share,
            (None, None) => 0.0,
        }
    }

    /// Whether the normals of most cells are on the right of a chain.
    pub(crate) fn runs_with_normals(&self, chain: &[usize]) -> bool {
        let side = |pair: &[usize]| {
            let [a, b] = [&self.cells[pair[0]], &self.cells[pair[1]]];
            (a.normal + b.normal).perp(&(b.centre - a.centre)).signum()
        };
        chain.windows(2).map(side).sum::<f64>() >= 0.0
    }

    /// The cells in their order along the outline, one list for each connected part, and whether it is closed.
    pub(crate) fn chains(&self) -> Vec<(Vec<usize>, bool)> {
        let mut seen = vec![false; self.cells.len()];
        let mut chains = Vec::new();
        let is_end = |i: usize| self.cells[i].neighbours.contains(&i);
        let all = 0..self.cells.len();
        let heads = all.clone().filter(|i| self.cells[*i].neighbours[0] == *i);
        for start in heads.chain(all.clone().filter(|i| is_end(*i))).chain(all.clone()) {
            if seen[start] {
                continue;
            }
            let mut chain = Vec::new();
            let mut next = Some(start);
            while let Some(cell) = next {
                seen[cell] = true;
                chain.push(cell);
                // Forwards first, so that the contour runs as the cells do.
                let [back, forth] = self.cells[cell].neighbours;
                next = [forth, back].into_iter().find(|n| !seen[*n]);
            }
            let last = chain[chain.len() - 1];
            let closed = chain.len() > 2 && !is_end(start) && self.cells[last].neighbours.contains(&start);
            chains.push((chain, closed));
        }
        chains
    }
}

/// Whether most of the points lie as far along their chains as others do, as those of frames that are sampled alike.
pub(crate) fn has_common_places(runs: &[(Run, bool)]) -> bool {
    let (mut common, mut all) = (0, 0);
    for (run, _) in runs {
        let mean = (run[run.len() - 1].0 - run[0].0) / run.len() as f64;
        common += run.windows(2).filter(|pair| pair[1].0 - pair[0].0 < tuning::COMMON * mean).count();
        all += run.len();
    }
    2 * common > all
}
