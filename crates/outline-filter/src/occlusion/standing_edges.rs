//! Straight edges of what is not the object, found while its frames come in.
use std::borrow::Cow;

use freeform_curve_fit::Outline;
use nalgebra::Point2;

use super::{
    cut::without,
    evidence::{Pair, Stayed},
    places::{Places, median},
    sighting::{Path, Sighting},
};
use crate::tuning::map::FEWEST_POINTS;
use crate::tuning::occlusion::{
    AGREES, ATTENTIVE, FARTHEST, FRAMES_PER_LOOK, FURTHER, LONGEST_PAIR, LONGEST_PAUSE, LONGEST_WAIT, LOOKS_PER_PART,
    MOST_EDGES, MOST_KEPT, MOVED, NOISES, PAIRS,
};

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
}

/// An edge whose points are left out.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Edge {
    shown: StandingEdge,
    /// The last pairs that have shown it.
    sightings: Vec<Sighting>,
    path: Path,
}

impl Edge {
    /// Points within this distance lie on it.
    fn width(&self) -> f64 {
        AGREES * self.sightings.iter().map(Sighting::noise_of_points).fold(0.0, f64::max)
    }

    /// Follows the line where another pair shows it.
    fn follow(&mut self, seen: Sighting) {
        push_last(&mut self.sightings, seen, MOST_KEPT);
        if let Some(path) = Path::of(&self.sightings) {
            self.path = path;
        }
        if let Some(seen) = self.sightings.last() {
            let line = self.path.line_in(seen.frame);
            let seen_ends = seen.reach.map(|place| seen.line.at(place));
            let places = [self.shown.from, self.shown.to].into_iter().chain(seen_ends).map(|p| line.place(&p));
            let [low, high] = extent(places);
            (self.shown.from, self.shown.to) = (line.at(low), line.at(high));
        }
    }
}

/// The contour that those after it are compared with.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Key {
    places: Places,
    frame: usize,
    /// By how far a contour had moved when it was compared last.
    compared_at: f64,
    /// Work done on pairs with it, in looks.
    looks: usize,
}

/// Finds straight edges that are not of the object, and leaves their points out.
///
/// A contour is compared with one before it, from which most of it has moved. Work is bounded: contours are reduced to a few places, an object that
/// hardly moves is looked at more and more rarely, and so is one of which nothing was found.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct StandingEdges {
    frame: usize,
    next_look: usize,
    looks_in_vain: usize,
    noises: Vec<f64>,
    key: Option<Key>,
    sightings: Vec<Sighting>,
    edges: Vec<Edge>,
}

impl StandingEdges {
    /// The edges found so far.
    pub(crate) fn found(&self) -> impl ExactSizeIterator<Item = StandingEdge> + '_ {
        self.edges.iter().map(|edge| edge.shown)
    }

    /// Looks at the outline of the next frame, at a time in seconds; whether it shows an edge that was not known.
    pub(crate) fn look(&mut self, outline: &Outline, time: f64) -> bool {
        self.frame += 1;
        if self.frame < self.next_look || self.edges.len() >= MOST_EDGES {
            return false;
        }
        let Some(places) = Places::of(outline) else { return false };
        push_last(&mut self.noises, places.noise(), NOISES);
        let noise = median(self.noises.clone());
        self.looks_in_vain += 1;
        let Some(key) = &mut self.key else {
            self.begin_pair(places);
            return false;
        };
        key.looks += 1;
        let elapsed = self.frame - key.frame;
        let pair = Pair::new(&places, &key.places, noise);
        let displacement = pair.displacement();
        let needed = (FURTHER * key.compared_at).max(MOVED * noise);
        if !pair.has_moved() || displacement < needed {
            // By when it has moved by as much if it goes on like this.
            let wait = elapsed as f64 * (needed / displacement - 1.0).clamp(0.0, 2.0);
            self.next_look = self.frame + (wait as usize).clamp(1, LONGEST_WAIT);
            if elapsed > LONGEST_PAIR {
                self.begin_pair(places);
            }
            return false;
        }
        key.compared_at = displacement;
        self.next_look = self.frame + 1;
        let parts = pair.straight_parts();
        let is_done = parts.is_empty() || displacement > FARTHEST * places.size();
        let work = LOOKS_PER_PART * parts.len();
        key.looks += work;
        self.looks_in_vain += work;
        let shown = parts.into_iter().find(|part| pair.is_not_of_object(part));
        let is_new = shown.as_ref().is_some_and(|part| self.see(part, (&places, noise), time));
        if shown.is_some() || is_done {
            self.end_pair(places, shown.is_some());
        }
        is_new
    }

    fn begin_pair(&mut self, places: Places) {
        self.key = Some(Key { places, frame: self.frame, compared_at: 0.0, looks: 0 });
        self.next_look = self.frame + 1;
    }

    /// After a pair that has told all that it can: the next one begins with this contour, or later where nothing has been seen for long.
    fn end_pair(&mut self, places: Places, has_shown: bool) {
        if has_shown {
            self.looks_in_vain = 0;
        }
        let looks = self.key.as_ref().map_or(0, |key| key.looks);
        if self.looks_in_vain < ATTENTIVE {
            self.begin_pair(places);
        } else {
            self.key = None;
            self.next_look = self.frame + (FRAMES_PER_LOOK * looks).min(LONGEST_PAUSE);
        }
    }

    /// Takes note of a straight part that is not of the object; whether it has been seen often enough, and was not known.
    fn see(&mut self, part: &Stayed, (places, noise): (&Places, f64), time: f64) -> bool {
        let points = part.points(places);
        let reach = extent(points.iter().map(|p| part.line.place(p)));
        let seen = Sighting { frame: self.frame, line: part.line, reach, noise, points_each: places.points_each };
        if let Some(edge) = self.edges.iter_mut().find(|edge| seen.is_of(&edge.path.line_in(seen.frame))) {
            edge.follow(seen);
            return false;
        }
        push_last(&mut self.sightings, seen, MOST_KEPT);
        let Some(edge) = confirmed(&self.sightings, time) else { return false };
        self.sightings.clear();
        self.edges.push(edge);
        true
    }

    /// An outline without the points along edges; `None` where too little is left of it to begin a map with.
    pub(crate) fn left_of<'a>(&self, outline: &'a Outline) -> Option<Cow<'a, Outline>> {
        if self.edges.is_empty() {
            return Some(Cow::Borrowed(outline));
        }
        let lines: Vec<_> = self.edges.iter().map(|edge| (edge.path.line_in(self.frame), edge.width())).collect();
        let on_edge = |p: &Point2<f64>| lines.iter().any(|(line, width)| line.distance(p).abs() < *width);
        let sightings = self.edges.iter().flat_map(|edge| &edge.sightings);
        let beside = sightings.map(|seen| seen.points_each).max().unwrap_or(0);
        match without(outline, on_edge, beside) {
            None => Some(Cow::Borrowed(outline)),
            Some(left) => left.ok().filter(|left| left.point_count() >= FEWEST_POINTS).map(Cow::Owned),
        }
    }

    /// Whether an outline, of an object with this centre, ends at the edge that was found last: more of it lies along the edge than beyond it.
    pub(crate) fn end(&self, outline: impl Iterator<Item = Point2<f64>>, centre: &Point2<f64>) -> bool {
        let Some(edge) = self.edges.last() else { return false };
        let (line, width) = (edge.path.line_in(self.frame), 2.0 * edge.width());
        let side = line.distance(centre).signum();
        let (mut along, mut beyond) = (0, 0);
        for p in outline {
            let distance = side * line.distance(&p);
            along += usize::from(distance.abs() <= width);
            beyond += usize::from(distance < -width);
        }
        along >= beyond
    }

    #[cfg(feature = "serde")]
    pub(crate) fn is_valid(&self, most_counted: usize) -> bool {
        let is_key = |key: &Key| {
            key.places.is_valid() && key.frame <= self.frame && key.looks < most_counted && key.compared_at >= 0.0
        };
        let are_sightings =
            |all: &[Sighting]| all.len() <= MOST_KEPT && all.iter().all(|seen| seen.is_valid(self.frame));
        [self.frame, self.next_look, self.looks_in_vain].iter().all(|count| *count < most_counted)
            && self.noises.len() <= NOISES
            && self.noises.iter().all(|noise| noise.is_finite())
            && self.key.as_ref().is_none_or(is_key)
            && are_sightings(&self.sightings)
            && self.edges.len() <= MOST_EDGES
            && self.edges.iter().all(|edge| are_sightings(&edge.sightings) && edge.path.is_valid())
    }
}

/// Adds to the last values of a list.
fn push_last<T>(list: &mut Vec<T>, value: T, most: usize) {
    if list.len() == most {
        list.remove(0);
    }
    list.push(value);
}

/// The least and the largest of some values.
fn extent(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
}

/// The edge that the last of some pairs shows, if enough before it show the same line, at rest or moving at a constant velocity.
fn confirmed(sightings: &[Sighting], time: f64) -> Option<Edge> {
    let last = sightings.last()?;
    let along: Vec<_> = sightings.iter().filter(|seen| seen.is_along(&last.line)).collect();
    let standing = along.iter().filter(|seen| seen.is_of(&last.line)).map(|seen| (*seen).clone()).collect();
    let latest = along[along.len().saturating_sub(PAIRS)..].iter().map(|seen| (*seen).clone()).collect();
    let of = |sightings: Vec<Sighting>| {
        let path = Path::of(&sightings).filter(|_| sightings.len() >= PAIRS)?;
        let line = path.line_in(last.frame);
        let [from, to] = extent(last.reach.iter().map(|place| line.place(&last.line.at(*place)))).map(|x| line.at(x));
        Some(Edge { shown: StandingEdge { from, to, since: time }, sightings, path })
    };
    of(standing).or_else(|| of(latest))
}
