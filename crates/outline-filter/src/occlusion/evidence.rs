//! Whether two contours show a straight edge that is not of the object: one motion explains the rest, and takes the edge elsewhere.
use nalgebra::Point2;

use super::{
    line::{Line, longest_straight},
    places::{Foot, Places, median, runs_all_round},
    registration::{Moved, registered},
};
use crate::tuning::occlusion::{
    AGREES, FEWEST_STRAIGHT, FITS_OF_LINE, GAIN_OF_PART, LEAST_GAIN, LEAST_REST, MOST_OF_LINE, MOST_SCATTER,
    MOST_TRIED, MOVED_SHARE, OFF, PART_DISAGREES, REST_AGREES, SHORTEST_SHARE,
};

/// A straight part of a contour that has stayed where it was in an earlier frame.
#[derive(Debug, Clone)]
pub(super) struct Stayed {
    pub(super) line: Line,
    /// Its places, by their numbers.
    places: Vec<usize>,
}

impl Stayed {
    pub(super) fn points(&self, contour: &Places) -> Vec<Point2<f64>> {
        self.places.iter().map(|i| contour.point(*i)).collect()
    }
}

/// A contour beside that of an earlier frame.
pub(super) struct Pair<'a> {
    now: &'a Places,
    before: &'a Places,
    noise: f64,
    feet: Vec<Foot>,
}

impl<'a> Pair<'a> {
    pub(super) fn new(now: &'a Places, before: &'a Places, noise: f64) -> Self {
        Self { now, before, noise, feet: now.iter().map(|p| before.nearest(&p)).collect() }
    }

    fn has_stayed(&self, i: usize) -> bool {
        self.feet[i].distance < AGREES * self.noise
    }

    /// How far those places have moved that have not stayed, by their median.
    pub(super) fn displacement(&self) -> f64 {
        median(self.feet.iter().map(|foot| foot.distance).filter(|distance| *distance >= AGREES * self.noise).collect())
    }

    /// Whether so much of the contour has moved that what stayed tells something.
    pub(super) fn has_moved(&self) -> bool {
        let moved = (0..self.now.len()).filter(|i| !self.has_stayed(*i)).count();
        moved as f64 >= MOVED_SHARE * self.now.len() as f64
    }

    /// Which places of both contours lie along lines, of an edge each: where it was seen now, and in the earlier frame.
    fn along(&self, lines: &[[Line; 2]]) -> [Vec<bool>; 2] {
        let is_near =
            |p: &Point2<f64>, of: usize| lines.iter().any(|lines| lines[of].distance(p).abs() < AGREES * self.noise);
        [self.now.iter().map(|p| is_near(&p, 0)).collect(), self.before.iter().map(|p| is_near(&p, 1)).collect()]
    }

    /// The straight parts that have stayed and are not of the object, each judged without the edges that are `known`. Two that hide each other, as both
    /// stay where the rest moves, are judged without both; only where that rest is most of the contour, as it is not where something moves in front
    /// of an object at rest.
    pub(super) fn shown(&self, parts: &[Stayed], known: &[[Line; 2]]) -> Vec<Stayed> {
        let is_shown = |part: &&Stayed| self.is_not_of_object(part, &self.left_out(&[part], known));
        let shown: Vec<_> = parts.iter().filter(is_shown).cloned().collect();
        let [first, second] = parts else { return shown };
        if !shown.is_empty() {
            return shown;
        }
        let left_out = self.left_out(&[first, second], known);
        let rest = left_out[0].iter().filter(|is_out| !**is_out).count();
        if (rest as f64) < LEAST_REST * self.now.len() as f64 {
            return Vec::new();
        }
        let are_shown = parts.iter().all(|part| self.is_not_of_object(part, &left_out));
        if are_shown { parts.to_vec() } else { Vec::new() }
    }

    /// Which places of both contours lie along parts that are judged, or along known edges.
    fn left_out(&self, parts: &[&Stayed], known: &[[Line; 2]]) -> [Vec<bool>; 2] {
        let lines: Vec<_> = parts.iter().map(|part| [part.line; 2]).chain(known.iter().copied()).collect();
        let [mut now, before] = self.along(&lines);
        parts.iter().flat_map(|part| &part.places).for_each(|i| now[*i] = true);
        [now, before]
    }

    /// The longest straight parts that have stayed, so many more as edges are known. None where what has moved is one straight line: that may be an edge
    /// which moves in front of an object at rest, as well as a side of an object that comes out from behind an edge at rest.
    pub(super) fn straight_parts(&self, known: usize) -> Vec<Stayed> {
        if self.moved_is_straight() {
            return Vec::new();
        }
        let fewest = FEWEST_STRAIGHT.max((SHORTEST_SHARE * self.now.len() as f64) as usize);
        let straight = |run: Vec<usize>| {
            let points: Vec<_> = run.iter().map(|i| self.now.point(*i)).collect();
            let (range, line) = longest_straight(&points, self.noise, fewest)?;
            Some(Stayed { line, places: run[range].to_vec() })
        };
        let mut parts: Vec<_> = self.runs_that_stayed().into_iter().filter_map(straight).collect();
        parts.sort_by_key(|part| std::cmp::Reverse(part.places.len()));
        parts.truncate(MOST_TRIED + known);
        parts
    }

    /// Whether the places that have not stayed lie on one line, but for a few at its ends.
    fn moved_is_straight(&self) -> bool {
        let mut moved: Vec<_> =
            (0..self.now.len()).filter(|i| !self.has_stayed(*i)).map(|i| self.now.point(i)).collect();
        let most = (MOST_OF_LINE * moved.len() as f64) as usize;
        for _ in 0..FITS_OF_LINE {
            let Some((line, _)) = Line::through(moved.iter().take(most).copied()) else { return false };
            moved.sort_unstable_by(|a, b| line.distance(a).abs().total_cmp(&line.distance(b).abs()));
            if most > 0 && line.distance(&moved[most - 1]).abs() < AGREES * self.noise {
                return true;
            }
        }
        false
    }

    /// Runs of neighbouring places that have stayed; one between two that have is of them. None where all have.
    fn runs_that_stayed(&self) -> Vec<Vec<usize>> {
        let count = self.now.len();
        let stayed = |i: usize| {
            self.has_stayed(i) || self.has_stayed((i + 1) % count) && self.has_stayed((i + count - 1) % count)
        };
        runs_all_round(count, stayed).unwrap_or_default()
    }

    /// Whether a part that has stayed is not of the object. One rigid motion explains the rest of the contour. It takes the part off the earlier
    /// contour, so that it is no other side of the object that has come there; and no rigid motion of all explains as much.
    fn is_not_of_object(&self, part: &Stayed, [out_now, out_before]: &[Vec<bool>; 2]) -> bool {
        let Self { now, before, noise, .. } = *self;
        let is_rest: Vec<_> = out_now.iter().map(|is_out| !is_out).collect();
        let of_edge: Vec<_> = (0..before.len()).map(|i| out_before[i] && out_before[(i + 1) % before.len()]).collect();
        let Some(rest) = registered((now, &is_rest), (before, &of_edge), noise, Moved::default()) else { return false };
        let of_rest = || (0..now.len()).filter(|i| is_rest[*i]);
        if rest.scale > MOST_SCATTER * noise || rest.agreement(of_rest()) < REST_AGREES {
            return false;
        }
        let normal = part.line.normal();
        let off = |i: &&usize| rest.distances[**i] > OFF * rest.scale.max(rest.deviation_of(**i, &normal));
        let count = part.places.len() as f64;
        if (part.places.iter().filter(off).count() as f64) < PART_DISAGREES * count {
            return false;
        }
        let all = now.len() as f64;
        let rest_count = of_rest().count() as f64;
        let with_edge = (all - rest_count + rest.agreement(of_rest()) * rest_count) / all;
        let [every, no_side] = [vec![true; now.len()], vec![false; before.len()]];
        let of_one = |begun_with| {
            let together = registered((now, &every), (before, &no_side), noise, begun_with)?;
            let agrees = |distance: &&f64| **distance < AGREES * rest.scale;
            Some(together.distances.iter().filter(agrees).count() as f64 / all)
        };
        let one = [Moved::default(), rest.moved].into_iter().filter_map(of_one).fold(0.0, f64::max);
        with_edge - one > LEAST_GAIN.max(GAIN_OF_PART * count / all)
    }
}
