//! Straight edges of what is not the object, found while its frames come in.
use std::borrow::Cow;

use freeform_curve_fit::Outline;
use nalgebra::Point2;

use super::{
    buffers::LookBuffers,
    cut::without,
    edge::{Edge, StandingEdge, edge_of, push_last},
    evidence::{Pair, Stayed},
    places::{Places, median},
    sighting::{Sighting, extent},
};
use crate::tuning::map::FEWEST_POINTS;
use crate::tuning::occlusion::{
    ATTENTIVE, FARTHEST, FRAMES_PER_LOOK, FURTHER, GOES_ON, LONGEST_PAIR, LONGEST_PAUSE, LONGEST_WAIT, LOOKS_PER_PART,
    MOST_EDGES, MOST_KEPT, MOST_WAITS, MOVED, NOISES, PAIRS, WIDTHS_OF_MAP,
};

/// The contour that those after it are compared with.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Key {
    places: Places,
    frame: usize,
    /// s.
    time: f64,
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
    /// Of the last frame, s.
    time: f64,
    next_look: usize,
    /// Pairs that have told all that they can.
    pairs: usize,
    looks_in_vain: usize,
    noises: Vec<f64>,
    key: Option<Key>,
    sightings: Vec<Sighting>,
    edges: Vec<Edge>,
    /// The last edges that were dropped.
    former: Vec<StandingEdge>,
    #[cfg_attr(feature = "serde", serde(skip))]
    buffers: LookBuffers,
}

impl StandingEdges {
    /// The edges found so far.
    pub(crate) fn found(&self) -> impl ExactSizeIterator<Item = StandingEdge> + '_ {
        self.edges.iter().map(|edge| edge.shown)
    }

    /// The last edges that are edges no more.
    pub(crate) fn former(&self) -> impl ExactSizeIterator<Item = StandingEdge> + '_ {
        self.former.iter().copied()
    }

    /// Looks at the outline of the next frame, at a time in seconds; whether it shows an edge that was not known. Where nothing has been seen for
    /// long, and the points of the frames before have `all_agreed` with the object, nothing lies in front of it that would be worth a look.
    pub(crate) fn look(&mut self, outline: &Outline, time: f64, all_agreed: bool) -> bool {
        self.frame += 1;
        self.time = time;
        let is_idle = self.key.is_none() && self.looks_in_vain >= ATTENTIVE && all_agreed && self.edges.is_empty();
        if self.frame < self.next_look || is_idle {
            return false;
        }
        let mut places = self.buffers.contours.pop().unwrap_or_else(Places::with_room);
        if !places.refill_from(outline) {
            self.buffers.contours.push(places);
            return false;
        }
        self.look_at(places)
    }

    fn look_at(&mut self, places: Places) -> bool {
        self.buffers.make_room();
        let LookBuffers { contours, values, feet, evidence } = &mut self.buffers;
        push_last(&mut self.noises, places.noise(values), NOISES);
        let noise = median(self.noises.iter().copied(), values);
        self.looks_in_vain += 1;
        let Some(key) = &mut self.key else {
            self.begin_pair(places);
            return false;
        };
        key.looks += 1;
        let elapsed = self.frame - key.frame;
        let pair = Pair::new(&places, &key.places, noise, feet);
        let displacement = pair.displacement(values);
        let needed = (FURTHER * key.compared_at).max(MOVED * noise);
        if !pair.has_moved() || displacement < needed {
            // By when it has moved by as much if it goes on like this.
            let wait = elapsed as f64 * (needed / displacement - 1.0).clamp(0.0, MOST_WAITS);
            self.next_look = self.frame + (wait as usize).clamp(1, LONGEST_WAIT);
            if elapsed > LONGEST_PAIR {
                self.begin_pair(places);
            } else {
                contours.push(places);
            }
            return false;
        }
        key.compared_at = displacement;
        self.next_look = self.frame + 1;
        pair.find_straight_parts(self.edges.len(), evidence);
        let is_done = evidence.parts.is_empty() || displacement > FARTHEST * places.size();
        let work = LOOKS_PER_PART * evidence.parts.len();
        key.looks += work;
        self.looks_in_vain += work;
        let known: Vec<_> = self.edges.iter().map(|edge| [self.time, key.time].map(|t| edge.path.line_at(t))).collect();
        pair.judge(&known, evidence);
        let mut is_new = false;
        let shows = evidence.shown.len();
        for i in 0..shows {
            let shown = &self.buffers.evidence.shown;
            let seen = self.sighting(&shown[i], (&places, noise));
            // Two parts of one line say no more than the longer one: a pair counts once.
            if !shown[..i].iter().any(|longer| seen.is_of(&longer.line)) {
                is_new |= self.see(seen);
            }
        }
        if is_done || shows > 0 {
            self.drop_crossed(&places, noise);
            self.end_pair(places, shows > 0);
        } else {
            self.buffers.contours.push(places);
        }
        is_new
    }

    /// Drops edges that the contour has gone on across in several pairs since they were seen last: what was there has left, or never was.
    fn drop_crossed(&mut self, places: &Places, noise: f64) {
        let time = self.time;
        self.edges.retain_mut(|edge| {
            edge.crossed += usize::from(edge.is_crossed_by(places, noise, time));
            let is_kept = edge.crossed < PAIRS;
            if !is_kept {
                push_last(&mut self.former, StandingEdge { until: Some(time), ..edge.shown }, MOST_EDGES);
            }
            is_kept
        });
    }

    fn begin_pair(&mut self, places: Places) {
        let key = Key { places, frame: self.frame, time: self.time, compared_at: 0.0, looks: 0 };
        self.buffers.contours.extend(self.key.replace(key).map(|before| before.places));
        self.next_look = self.frame + 1;
    }

    /// After a pair that has told all that it can: the next one begins with this contour, or later where nothing has been seen for long.
    fn end_pair(&mut self, places: Places, has_shown: bool) {
        self.pairs += 1;
        if has_shown {
            self.looks_in_vain = 0;
        }
        let looks = self.key.as_ref().map_or(0, |key| key.looks);
        if self.looks_in_vain < ATTENTIVE {
            self.begin_pair(places);
        } else {
            self.buffers.contours.extend(self.key.take().map(|key| key.places).into_iter().chain([places]));
            self.next_look = self.frame + (FRAMES_PER_LOOK * looks).min(LONGEST_PAUSE);
        }
    }

    fn sighting(&self, part: &Stayed, (places, noise): (&Places, f64)) -> Sighting {
        let reach = extent(part.points(places).map(|p| part.line.place(&p)));
        let (time, pair, points_each) = (self.time, self.pairs, places.points_each);
        Sighting { time, pair, line: part.line, reach, noise, points_each }
    }

    /// Takes note of a straight part that is not of the object; whether it has been seen often enough, and was not known.
    fn see(&mut self, seen: Sighting) -> bool {
        let (time, pair) = (seen.time, seen.pair);
        if let Some(edge) = self.edges.iter_mut().find(|edge| seen.is_of(&edge.path.line_at(time))) {
            edge.follow(seen);
            return false;
        }
        self.sightings.retain(|earlier| earlier.pair + MOST_KEPT > pair);
        push_last(&mut self.sightings, seen, MOST_KEPT);
        let Some(edge) = confirmed(&self.sightings).filter(|_| self.edges.len() < MOST_EDGES) else { return false };
        self.sightings.retain(|seen| !seen.is_of(&edge.path.line_at(seen.time)));
        self.edges.push(edge);
        true
    }

    /// An outline without the points along edges, as far as these have been seen and somewhat further; `None` where too little is left of it to begin a
    /// map with.
    pub(crate) fn left_of<'a>(&self, outline: &'a Outline) -> Option<Cow<'a, Outline>> {
        if self.edges.is_empty() {
            return Some(Cow::Borrowed(outline));
        }
        let strip = |edge: &Edge| {
            let line = edge.path.line_at(self.time);
            let [low, high] = edge.reach(&line);
            let further = GOES_ON * (high - low);
            (line, edge.width(), low - further..=high + further)
        };
        let strips: Vec<_> = self.edges.iter().map(strip).collect();
        let on_edge = |p: &Point2<f64>| {
            strips.iter().any(|(line, width, reach)| line.distance(p).abs() < *width && reach.contains(&line.place(p)))
        };
        let sightings = self.edges.iter().flat_map(|edge| &edge.sightings);
        let beside = sightings.map(|seen| seen.points_each).max().unwrap_or(0);
        match without(outline, on_edge, beside) {
            None => Some(Cow::Borrowed(outline)),
            Some(left) => left.ok().filter(|left| left.point_count() >= FEWEST_POINTS).map(Cow::Owned),
        }
    }

    /// Whether an outline, of an object with this centre, ends at an edge that was found in the last frame: more of it lies along the edge than beyond it.
    pub(crate) fn cuts_off(&self, outline: impl Iterator<Item = Point2<f64>>, centre: &Point2<f64>) -> bool {
        let outline: Vec<_> = outline.collect();
        self.edges.iter().filter(|edge| edge.shown.since == self.time).any(|edge| {
            let (line, width) = (edge.path.line_at(self.time), WIDTHS_OF_MAP * edge.width());
            let side = line.distance(centre).signum();
            let (mut along, mut beyond) = (0, 0);
            for p in &outline {
                let distance = side * line.distance(p);
                along += usize::from(distance.abs() <= width);
                beyond += usize::from(distance < -width);
            }
            along > beyond
        })
    }

    #[cfg(feature = "serde")]
    pub(crate) fn is_valid(&self, most_counted: usize) -> bool {
        let is_key = |key: &Key| {
            key.places.is_valid()
                && key.frame <= self.frame
                && key.looks < most_counted
                && [key.time, key.compared_at].iter().all(|x| x.is_finite())
                && key.compared_at >= 0.0
        };
        let are_sightings = |all: &[Sighting]| {
            all.len() <= MOST_KEPT && all.iter().all(|seen| seen.is_valid() && seen.pair <= self.pairs)
        };
        let is_shown = |StandingEdge { from, to, since, until }: &StandingEdge| {
            [from.x, from.y, to.x, to.y, *since, until.unwrap_or(0.0)].iter().all(|x| x.is_finite())
        };
        let is_over = |edge: &StandingEdge| is_shown(edge) && edge.until.is_some_and(|until| until >= edge.since);
        let is_edge = |edge: &Edge| {
            is_shown(&edge.shown)
                && edge.shown.until.is_none()
                && !edge.sightings.is_empty()
                && are_sightings(&edge.sightings)
                && edge.path.is_valid()
                && edge.crossed < PAIRS
        };
        [self.frame, self.next_look, self.looks_in_vain, self.pairs].iter().all(|count| *count < most_counted)
            && self.time.is_finite()
            && self.noises.len() <= NOISES
            && self.noises.iter().all(|noise| noise.is_finite() && *noise >= 0.0)
            && self.key.as_ref().is_none_or(is_key)
            && are_sightings(&self.sightings)
            && self.edges.len() <= MOST_EDGES
            && self.edges.iter().all(is_edge)
            && self.former.len() <= MOST_EDGES
            && self.former.iter().all(is_over)
    }
}

/// The edge that the last of some pairs shows, if enough before it show the same line, at rest or moving at a constant velocity.
fn confirmed(sightings: &[Sighting]) -> Option<Edge> {
    let last = sightings.last()?;
    let along = || sightings.iter().filter(|seen| seen.is_along(&last.line));
    let standing = along().filter(|seen| seen.is_of(&last.line));
    let latest = along().skip(along().count().saturating_sub(PAIRS));
    edge_of(&standing, last).or_else(|| edge_of(&latest, last))
}

#[cfg(all(test, feature = "serde"))]
mod tests {
    use nalgebra::Vector2;

    use super::super::line::Line;
    use super::*;

    type Damage = fn(&mut StandingEdges);

    /// What is known after a disc has been looked at, with an edge.
    fn with_edge() -> StandingEdges {
        let point = |i: i32| Point2::new((0.06 * f64::from(i)).cos(), (0.06 * f64::from(i)).sin());
        let disc = Outline::closed((0..104).map(point).collect()).expect("a disc");
        let mut edges = StandingEdges::default();
        edges.look(&disc, 0.5, false);
        let line = Line { through: Point2::new(0.8, 0.0), along: Vector2::y() };
        let seen = |time| Sighting { time, pair: 0, line, reach: [-0.4, 0.5], noise: 0.01, points_each: 1 };
        edges.sightings = [0.1, 0.2, 0.3].map(seen).to_vec();
        edges.edges.push(confirmed(&edges.sightings).expect("three of one line"));
        edges.former.push(StandingEdge { until: Some(0.4), ..edges.edges[0].shown });
        edges
    }

    #[test]
    fn damaged_edges_are_not_valid() {
        assert!(with_edge().is_valid(1000));
        let damages: [(&str, Damage); 20] = [
            ("dropped at no time", |e| e.former[0].until = Some(f64::NAN)),
            ("dropped and not over", |e| e.former[0].until = None),
            ("dropped before it was found", |e| e.former[0].until = Some(e.former[0].since - 0.1)),
            ("over and not dropped", |e| e.edges[0].shown.until = Some(0.4)),
            ("noise without end", |e| e.sightings[0].noise = f64::INFINITY),
            ("a reach that is no number", |e| e.sightings[0].reach[1] = f64::NAN),
            ("a reach the wrong way round", |e| e.sightings[0].reach = [0.5, -0.4]),
            ("no points", |e| e.sightings[0].points_each = 0),
            ("a pair to come", |e| e.sightings[0].pair = 1),
            ("no sightings", |e| e.edges[0].sightings.clear()),
            ("a damaged sighting", |e| e.edges[0].sightings[2].time = f64::NAN),
            ("no beginning", |e| e.edges[0].shown.from.x = f64::NAN),
            ("no end", |e| e.edges[0].shown.to.y = f64::INFINITY),
            ("no time", |e| e.edges[0].shown.since = f64::NAN),
            ("crossed too often", |e| e.edges[0].crossed = PAIRS),
            ("no time of the contour", |e| e.key.as_mut().expect("a contour").time = f64::NAN),
            ("compared without end", |e| e.key.as_mut().expect("a contour").compared_at = f64::INFINITY),
            ("no points of places", |e| e.key.as_mut().expect("a contour").places.points_each = 0),
            ("negative noise", |e| e.noises = vec![-1.0]),
            ("no time of the frame", |e| e.time = f64::NAN),
        ];
        for (name, damage) in damages {
            let mut edges = with_edge();
            damage(&mut edges);
            assert!(!edges.is_valid(1000), "{name}");
        }
    }
}
