//! One straight edge of what is not the object.
use nalgebra::Point2;

use super::{
    line::Line,
    places::Places,
    sighting::{Path, Sighting, extent},
};
use crate::tuning::occlusion::{AGREES, FEWEST_ACROSS, MOST_KEPT, PAIRS};

/// A straight edge that cuts the object off in the picture and is not of it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StandingEdge {
    /// One end of what has been seen of it, image coordinates.
    pub from: Point2<f64>,
    /// The other end.
    pub to: Point2<f64>,
    /// Time of the frame from which on its points were left out, s.
    pub since: f64,
    /// Time of the frame from which on they were taken again, as the outline went on across it: what was there has left, or never was; s.
    pub until: Option<f64>,
}

/// An edge whose points are left out.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Edge {
    pub(super) shown: StandingEdge,
    /// The last pairs that have shown it.
    pub(super) sightings: Vec<Sighting>,
    pub(super) path: Path,
    /// Pairs since the last of those in which the contour went on across it.
    pub(super) crossed: usize,
}

impl Edge {
    /// Points within this distance lie on it.
    pub(super) fn width(&self) -> f64 {
        AGREES * self.sightings.iter().map(Sighting::noise_of_points).fold(0.0, f64::max)
    }

    /// How far along a line that is its own what has been seen of it reaches.
    pub(super) fn reach(&self, line: &Line) -> [f64; 2] {
        extent([self.shown.from, self.shown.to].iter().map(|p| line.place(p)))
    }

    /// Whether a contour goes on across it, where it was seen: then nothing is hidden there.
    pub(super) fn is_crossed_by(&self, places: &Places, noise: f64, time: f64) -> bool {
        let line = self.path.line_at(time);
        let [low, high] = self.reach(&line);
        let within = |p: &Point2<f64>| (low..=high).contains(&line.place(p));
        let distances = || places.iter().filter(within).map(|p| line.distance(&p));
        let off = AGREES * noise;
        distances().filter(|d| *d > off).count().min(distances().filter(|d| *d < -off).count()) >= FEWEST_ACROSS
    }

    /// Follows the line where another pair shows it.
    pub(super) fn follow(&mut self, seen: Sighting) {
        push_last(&mut self.sightings, seen, MOST_KEPT);
        if let Some(path) = Path::of(&self.sightings.iter()) {
            self.path = path;
        }
        self.crossed = 0;
        if let Some(seen) = self.sightings.last() {
            let line = self.path.line_at(seen.time);
            let seen_ends = seen.reach.map(|place| line.place(&seen.line.at(place)));
            let [low, high] = extent(self.reach(&line).into_iter().chain(seen_ends));
            (self.shown.from, self.shown.to) = (line.at(low), line.at(high));
        }
    }
}

/// Adds to the last values of a list, which has room for all of them from the first on.
pub(super) fn push_last<T>(list: &mut Vec<T>, value: T, most: usize) {
    if list.len() == most {
        list.remove(0);
    }
    list.reserve_exact(most - list.len());
    list.push(value);
}

/// The edge that some pairs show, if they are enough, as far as the last one shows it.
pub(super) fn edge_of<'a>(sightings: &(impl Iterator<Item = &'a Sighting> + Clone), last: &Sighting) -> Option<Edge> {
    let path = Path::of(sightings).filter(|_| sightings.clone().count() >= PAIRS)?;
    let line = path.line_at(last.time);
    let [from, to] = extent(last.reach.iter().map(|place| line.place(&last.line.at(*place)))).map(|x| line.at(x));
    let sightings = sightings.clone().cloned().collect();
    Some(Edge { shown: StandingEdge { from, to, since: last.time, until: None }, sightings, path, crossed: 0 })
}
