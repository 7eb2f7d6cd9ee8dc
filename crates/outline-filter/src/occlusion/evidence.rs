//! Whether two contours show a straight edge that is not of the object: one motion explains the rest, and takes the edge elsewhere.
use nalgebra::Point2;

use super::{
    line::{Line, longest_straight},
    places::{Foot, Places, clear_with_room, median, runs_all_round},
    registration::{Moved, RegistrationBuffers, registered},
};
use crate::tuning::occlusion::{
    AGREES, FEWEST_STRAIGHT, FITS_OF_LINE, GAIN_OF_PART, LEAST_GAIN, LEAST_REST, MOST_OF_LINE, MOST_PLACES,
    MOST_SCATTER, MOST_STRAIGHT, MOST_TRIED, MOVED_SHARE, OFF, PART_DISAGREES, REST_AGREES, SHORTEST_SHARE,
};

/// A straight part of a contour that has stayed where it was in an earlier frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stayed {
    pub(super) line: Line,
    /// Its first place, by the number, and how many it has, all round.
    first: usize,
    count: usize,
}

impl Stayed {
    /// Its places, by their numbers.
    fn places(&self, contour: &Places) -> impl Iterator<Item = usize> + use<> {
        let all = contour.len();
        (self.first..self.first + self.count).map(move |i| i % all)
    }

    pub(super) fn points<'a>(&self, contour: &'a Places) -> impl Iterator<Item = Point2<f64>> + use<'a> {
        self.places(contour).map(|i| contour.point(i))
    }
}

/// What straight parts are looked for and judged with.
#[derive(Debug, Clone, Default)]
pub(super) struct EvidenceBuffers {
    /// Of a run, or of all that has moved.
    points: Vec<Point2<f64>>,
    pub(super) parts: Vec<Stayed>,
    /// Those of them that are not of the object.
    pub(super) shown: Vec<Stayed>,
    left_out: LeftOut,
    registration: RegistrationBuffers,
}

/// Which places of a contour, and of the earlier one, are left out.
#[derive(Debug, Clone, Default)]
struct LeftOut {
    now: Vec<bool>,
    before: Vec<bool>,
}

impl EvidenceBuffers {
    pub(super) fn make_room(&mut self) {
        let Self { points, parts, shown, left_out, registration } = self;
        clear_with_room(points, MOST_PLACES);
        clear_with_room(parts, MOST_STRAIGHT);
        clear_with_room(shown, MOST_STRAIGHT);
        clear_with_room(&mut left_out.now, MOST_PLACES);
        clear_with_room(&mut left_out.before, MOST_PLACES);
        registration.make_room();
    }
}

/// A contour beside that of an earlier frame.
pub(super) struct Pair<'a> {
    now: &'a Places,
    before: &'a Places,
    noise: f64,
    feet: &'a [Foot],
}

impl<'a> Pair<'a> {
    pub(super) fn new(now: &'a Places, before: &'a Places, noise: f64, feet: &'a mut Vec<Foot>) -> Self {
        feet.clear();
        feet.extend(now.iter().map(|p| before.nearest(&p)));
        Self { now, before, noise, feet }
    }

    fn has_stayed(&self, i: usize) -> bool {
        self.feet[i].distance < AGREES * self.noise
    }

    /// How far those places have moved that have not stayed, by their median.
    pub(super) fn displacement(&self, values: &mut Vec<f64>) -> f64 {
        let distances = self.feet.iter().map(|foot| foot.distance);
        median(distances.filter(|distance| *distance >= AGREES * self.noise), values)
    }

    /// Whether so much of the contour has moved that what stayed tells something.
    pub(super) fn has_moved(&self) -> bool {
        let moved = (0..self.now.len()).filter(|i| !self.has_stayed(*i)).count();
        moved as f64 >= MOVED_SHARE * self.now.len() as f64
    }

    /// Which of the straight parts that have stayed are not of the object, each judged without the edges that are `known`. Two that hide each other,
    /// as both stay where the rest moves, are judged without both; only where that rest is most of the contour, as it is not where something moves
    /// in front of an object at rest.
    pub(super) fn judge(&self, known: &[[Line; 2]], buffers: &mut EvidenceBuffers) {
        let EvidenceBuffers { parts, shown, left_out, registration, .. } = buffers;
        shown.clear();
        for part in parts.iter() {
            self.leave_out(std::slice::from_ref(part), known, left_out);
            if self.is_not_of_object(part, left_out, registration) {
                shown.push(*part);
            }
        }
        if !shown.is_empty() || parts.len() != 2 {
            return;
        }
        self.leave_out(parts, known, left_out);
        let rest = left_out.now.iter().filter(|is_out| !**is_out).count();
        if rest as f64 >= LEAST_REST * self.now.len() as f64
            && parts.iter().all(|part| self.is_not_of_object(part, left_out, registration))
        {
            shown.extend_from_slice(parts);
        }
    }

    /// Leaves out the places of both contours that lie along parts that are judged, or along known edges: where these were seen now, and in the
    /// earlier frame.
    fn leave_out(&self, parts: &[Stayed], known: &[[Line; 2]], LeftOut { now, before }: &mut LeftOut) {
        let lines = || parts.iter().map(|part| [part.line; 2]).chain(known.iter().copied());
        let is_near = |p: &Point2<f64>, of: usize| lines().any(|line| line[of].distance(p).abs() < AGREES * self.noise);
        now.clear();
        now.extend(self.now.iter().map(|p| is_near(&p, 0)));
        before.clear();
        before.extend(self.before.iter().map(|p| is_near(&p, 1)));
        parts.iter().flat_map(|part| part.places(self.now)).for_each(|i| now[i] = true);
    }

    /// Looks for the longest straight parts that have stayed, so many more as edges are known. None where what has moved is one straight line: that
    /// may be an edge which moves in front of an object at rest, as well as a side of an object that comes out from behind an edge at rest.
    pub(super) fn find_straight_parts(&self, known: usize, buffers: &mut EvidenceBuffers) {
        let EvidenceBuffers { points, parts, .. } = buffers;
        parts.clear();
        if self.moved_is_straight(points) {
            return;
        }
        let count = self.now.len();
        let fewest = FEWEST_STRAIGHT.max((SHORTEST_SHARE * count as f64) as usize);
        // One place between two that have stayed is of their run. None where all have.
        let stayed = |i: usize| {
            self.has_stayed(i) || self.has_stayed((i + 1) % count) && self.has_stayed((i + count - 1) % count)
        };
        for run in runs_all_round(count, stayed).into_iter().flatten() {
            points.clear();
            points.extend(run.clone().map(|i| self.now.point(i % count)));
            if let Some((range, line)) = longest_straight(points, self.noise, fewest) {
                parts.push(Stayed { line, first: run.start + range.start, count: range.len() });
            }
        }
        parts.sort_by_key(|part| std::cmp::Reverse(part.count));
        parts.truncate(MOST_TRIED + known);
    }

    /// Whether the places that have not stayed lie on one line, but for a few at its ends.
    fn moved_is_straight(&self, moved: &mut Vec<Point2<f64>>) -> bool {
        moved.clear();
        moved.extend((0..self.now.len()).filter(|i| !self.has_stayed(*i)).map(|i| self.now.point(i)));
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

    /// Whether a part that has stayed is not of the object. One rigid motion explains the rest of the contour. It takes the part off the earlier
    /// contour, so that it is no other side of the object that has come there; and no rigid motion of all explains as much.
    fn is_not_of_object(&self, part: &Stayed, out: &LeftOut, buffers: &mut RegistrationBuffers) -> bool {
        let Self { now, before, noise, .. } = *self;
        let is_rest = |i: usize| !out.now[i];
        let is_of_edge = |i: usize| out.before[i] && out.before[(i + 1) % before.len()];
        let of_rest = || (0..now.len()).filter(|i| is_rest(*i));
        let Some(rest) = registered((now, is_rest), (before, is_of_edge), noise, Moved::default(), buffers) else {
            return false;
        };
        let (moved, scale, agreement) = (rest.moved, rest.scale, rest.agreement(of_rest()));
        if scale > MOST_SCATTER * noise || agreement < REST_AGREES {
            return false;
        }
        let normal = part.line.normal();
        let off = |i: &usize| rest.distances[*i] > OFF * scale.max(rest.deviation_of(*i, &normal));
        let count = part.count as f64;
        if (part.places(now).filter(off).count() as f64) < PART_DISAGREES * count {
            return false;
        }
        let all = now.len() as f64;
        let rest_count = of_rest().count() as f64;
        let with_edge = (all - rest_count + agreement * rest_count) / all;
        let of_one = |begun_with| {
            let together = registered((now, |_| true), (before, |_| false), noise, begun_with, buffers)?;
            let agrees = |distance: &&f64| **distance < AGREES * scale;
            Some(together.distances.iter().filter(agrees).count() as f64 / all)
        };
        let one = [Moved::default(), moved].into_iter().filter_map(of_one).fold(0.0, f64::max);
        with_edge - one > LEAST_GAIN.max(GAIN_OF_PART * count / all)
    }
}
