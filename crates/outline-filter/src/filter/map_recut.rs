//! The map cut anew from the first frames together, once they are aligned.
use freeform_curve_fit::Outline;
use freeform_riccati::map_point;
use nalgebra::{Matrix3, Point2};

use super::{
    contour::Contour,
    map_update::{MapUpdate, Scratch},
    outline_map::OutlineMap,
    reading::NO_CELL,
};

/// Points of several frames beyond which more of them would not make cells finer.
pub(crate) const PLENTY: usize = 3200;
/// Points nearer than so many spacings are one.
const COINCIDENT: f64 = 0.05;
/// Share of the noise that the map has seen, which the points are taken to have at least: where those of many frames lie in one place
/// they make contours of their own.
const LEAST_NOISE: f64 = 0.5;
/// Points that follow each other in less than this share of the mean distance lie in one place.
const COMMON: f64 = 0.2;
/// Fewest points that make a contour.
const FEWEST_POINTS: usize = 8;

/// Points in their order along a chain of cells, with how far along it they lie, in cells.
type Run = Vec<(f64, Point2<f64>)>;

/// A frame and the pose, body to image, in which it shows the object.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PlacedFrame<'a> {
    pub(crate) time: f64,
    pub(crate) outline: &'a Outline,
    pub(crate) pose: Matrix3<f64>,
}

impl OutlineMap {
    /// Frames, the last of which this map stands at, in the poses that its motion puts them in.
    pub(crate) fn placed<'a>(
        &self,
        frames: impl DoubleEndedIterator<Item = (f64, &'a Outline)>,
    ) -> Vec<PlacedFrame<'a>> {
        let mut last_time = None;
        let placed = frames.rev().map(|(time, outline)| {
            let seconds = time - *last_time.get_or_insert(time);
            let pose = self.model.flow(&self.motion[..self.information.k], seconds).into_inner() * self.pose;
            PlacedFrame { time, outline, pose }
        });
        let mut placed: Vec<_> = placed.collect();
        placed.reverse();
        placed
    }

    /// A map of the same body frame with cells cut from every frame out of `stride`, which are those that this map has taken, and all then
    /// taken one by one. `None` where one of them is not.
    pub(crate) fn recut(
        &self,
        frames: &[PlacedFrame<'_>],
        stride: usize,
        mut take: impl FnMut(&mut Self, f64, &Outline) -> MapUpdate,
    ) -> Option<Self> {
        // Frames that have turned by what nobody knows would smear what one of them shows of the turn.
        if self.is_forgotten || self.turn_is_unseen() {
            return None;
        }
        let first = frames.first()?;
        let mut map = Self::without_cells(self.model, self.origin, self.radius);
        let mut points = Vec::new();
        for PlacedFrame { outline, pose, .. } in frames.iter().step_by(stride) {
            map.load(outline);
            let inverse = pose.try_inverse()?;
            map.scratch.shifts.resize(self.cells.len(), 0.0);
            self.read_points(&mut map.scratch, pose, &[], true);
            let Scratch { readings, points: seen, smooth, .. } = &map.scratch;
            for ((reading, p), place) in readings.iter().zip(seen).zip(smooth) {
                // Where along the outline a point lies its neighbours know better.
                let place = if reading.weight > 0.0 { place } else { p };
                points.push((reading.cell, map_point(&inverse, place), map_point(&inverse, p)));
            }
        }
        if self.has_common_points(&points) {
            return None;
        }
        let runs = self.along_chains(points);
        if has_common_places(&runs) {
            return None;
        }
        let contours =
            runs.into_iter().map(|(run, closed)| Contour::new(run.into_iter().map(|(_, q)| q).collect(), closed));
        map.load(first.outline);
        map.first_pose = self.first_pose;
        map.pose = self.first_pose.pose;
        map.cut(contours.collect(), LEAST_NOISE * self.sigma)?;
        map.noise_level = self.noise_level;
        map.doubt_first_pose();
        map.motion = self.motion;
        let mut before = first.time;
        for PlacedFrame { time, outline, .. } in &frames[1..] {
            if !take(&mut map, time - before, outline).accepted {
                return None;
            }
            before = *time;
        }
        map.is_compared = self.is_compared;
        Some(map)
    }

    /// Whether most of the points of the frames are the same places of the outline, which cut no finer cells together.
    fn has_common_points(&self, points: &[(usize, Point2<f64>, Point2<f64>)]) -> bool {
        let mut order: Vec<_> = points.iter().map(|(cell, _, q)| (*cell, q)).collect();
        order.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.x.total_cmp(&b.1.x)));
        let limit = COINCIDENT * self.spacing;
        let common = order.windows(2).filter(|pair| (pair[0].1 - pair[1].1).norm() < limit).count();
        2 * common > points.len()
    }

    /// Points in the body frame, given with their cells and places, in their order along each chain of cells with how far along it they
    /// lie, in cells; and whether the chain is closed.
    fn along_chains(&self, points: Vec<(usize, Point2<f64>, Point2<f64>)>) -> Vec<(Run, bool)> {
        let chains = self.chains();
        let mut place_of = vec![(0, 0); self.cells.len()];
        for (number, (chain, _)) in chains.iter().enumerate() {
            chain.iter().enumerate().for_each(|(index, cell)| place_of[*cell] = (number, index));
        }
        let mut runs: Vec<Run> = vec![Vec::new(); chains.len()];
        for (cell, place, q) in points {
            if cell == NO_CELL {
                continue;
            }
            let (number, index) = place_of[cell];
            let (chain, closed) = &chains[number];
            runs[number].push((index as f64 + self.along(chain, *closed, index, &place), q));
        }
        let kept = runs.into_iter().zip(&chains).filter(|(run, _)| run.len() >= FEWEST_POINTS);
        kept.map(|(mut run, (_, closed))| {
            run.sort_by(|a, b| a.0.total_cmp(&b.0));
            (run, *closed)
        })
        .collect()
    }

    /// How far along the line through the cells of a chain a point lies from the cell nearest to it, in cells.
    fn along(&self, chain: &[usize], closed: bool, index: usize, q: &Point2<f64>) -> f64 {
        let count = chain.len();
        let at = |i: usize| {
            let cell = &self.cells[chain[i]];
            cell.centre + cell.offset * cell.normal
        };
        let here = at(index);
        let towards = |other: Option<usize>| {
            let side = at(other?) - here;
            let share = (side.dot(&(q - here)) / side.norm_squared()).clamp(0.0, 1.0);
            share.is_finite().then(|| (share, (here + share * side - q).norm_squared()))
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

    /// The cells in their order along the outline, one list for each connected part, and whether it is closed.
    fn chains(&self) -> Vec<(Vec<usize>, bool)> {
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
fn has_common_places(runs: &[(Run, bool)]) -> bool {
    let (mut common, mut all) = (0, 0);
    for (run, _) in runs {
        let mean = (run[run.len() - 1].0 - run[0].0) / run.len() as f64;
        common += run.windows(2).filter(|pair| pair[1].0 - pair[0].0 < COMMON * mean).count();
        all += run.len();
    }
    2 * common > all
}
