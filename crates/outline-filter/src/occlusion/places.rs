//! A contour as a few places: means of neighbouring points, which err less than these.
use std::ops::Range;

use freeform_curve_fit::Outline;
use nalgebra::{Point2, Vector2};

use crate::{
    tuning::{
        measurement::MEDIAN_TO_DEVIATION,
        occlusion::{FEWEST_PLACES, LEAST_NOISE, MOST_PLACES, SPACING_NOISE},
    },
    vectors::vectorised,
};

/// Places along a closed contour.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Places {
    x: Vec<f64>,
    y: Vec<f64>,
    /// Points that each is the mean of.
    pub(super) points_each: usize,
}

/// The place on a contour nearest to a point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Foot {
    /// The side that it lies on, by the place that it begins at.
    pub(super) side: usize,
    pub(super) point: Point2<f64>,
    pub(super) distance: f64,
}

impl Places {
    /// How many points each may be the mean of.
    #[cfg(feature = "serde")]
    pub(super) const COUNTS: std::ops::RangeInclusive<usize> = 1..=u16::MAX as usize;

    /// None, with room for as many as a contour has.
    pub(super) fn with_room() -> Self {
        let mut none = Self::default();
        clear_with_room(&mut none.x, MOST_PLACES);
        clear_with_room(&mut none.y, MOST_PLACES);
        none
    }

    /// Takes instead those of the boundary of an outline; `false` of one that is not closed, or has few points.
    pub(super) fn refill_from(&mut self, outline: &Outline) -> bool {
        let Some(piece) = outline.pieces().next().filter(|piece| piece.closed) else { return false };
        let points = piece.points;
        let points_each = points.len().div_ceil(MOST_PLACES);
        let count = points.len() / points_each.max(1);
        if count < FEWEST_PLACES {
            return false;
        }
        let mean = |k: usize| {
            let part = &points[k * points.len() / count..(k + 1) * points.len() / count];
            part.iter().fold(Vector2::zeros(), |sum, p| sum + p.coords) / part.len() as f64
        };
        self.x.clear();
        self.y.clear();
        for p in (0..count).map(mean) {
            self.x.push(p.x);
            self.y.push(p.y);
        }
        self.points_each = points_each;
        true
    }

    pub(super) fn len(&self) -> usize {
        self.x.len()
    }

    pub(super) fn point(&self, i: usize) -> Point2<f64> {
        Point2::new(self.x[i], self.y[i])
    }

    pub(super) fn iter(&self) -> impl ExactSizeIterator<Item = Point2<f64>> + Clone + '_ {
        (0..self.len()).map(|i| self.point(i))
    }

    /// The place so many after another one, or before it, all round: fewer than there are.
    fn round(&self, i: usize, by: isize) -> Point2<f64> {
        let (at, count) = (i as isize + by, self.len() as isize);
        // Less than a round off, where a remainder would be most of the work.
        let at = if at < 0 { at + count } else { at };
        self.point((if at < count { at } else { at - count }) as usize)
    }

    pub(super) fn centre(&self) -> Point2<f64> {
        (self.iter().fold(Vector2::zeros(), |sum, p| sum + p.coords) / self.len() as f64).into()
    }

    /// Root mean square distance from the centre.
    pub(super) fn size(&self) -> f64 {
        let centre = self.centre();
        (self.iter().map(|p| (p - centre).norm_squared()).sum::<f64>() / self.len() as f64).sqrt()
    }

    fn spacing(&self, values: &mut Vec<f64>) -> f64 {
        median((0..self.len()).map(|i| (self.round(i, 1) - self.point(i)).norm()), values)
    }

    /// Standard deviation of the places across the contour: by how much they lie off the cubic through their four neighbours, for most of them.
    pub(super) fn noise(&self, values: &mut Vec<f64>) -> f64 {
        let off = |i: usize| {
            let [a, b, p, c, d] = [-2, -1, 0, 1, 2].map(|by| self.round(i, by).coords);
            let chord = c - b;
            let error = p - ((b + c) * 4.0 - a - d) / 6.0;
            let length = chord.norm();
            if length > 0.0 { (error.y * chord.x - error.x * chord.y).abs() / length } else { 0.0 }
        };
        // The variance of the difference is 1 + (2 * 16 + 2) / 36 of that of a place.
        let own = MEDIAN_TO_DEVIATION * median((0..self.len()).map(off), values) / (35.0_f64 / 18.0).sqrt();
        own.max(LEAST_NOISE * self.size()).max(SPACING_NOISE * self.spacing(values))
    }

    /// Unit normal of a side, by the chord over the sides next to it.
    pub(super) fn normal(&self, side: usize) -> Vector2<f64> {
        let chord = self.round(side, 2) - self.round(side, -1);
        Vector2::new(-chord.y, chord.x).try_normalize(0.0).unwrap_or_else(Vector2::zeros)
    }

    pub(super) fn nearest(&self, p: &Point2<f64>) -> Foot {
        let i = self.nearest_place(p);
        let before = if i > 0 { i - 1 } else { self.len() - 1 };
        let [first, second] = [before, i].map(|side| self.foot_on(side, p));
        if first.distance < second.distance { first } else { second }
    }

    /// The first of the places that no other one is nearer than.
    fn nearest_place(&self, p: &Point2<f64>) -> usize {
        const LANES: usize = 8;
        let square = |x: f64, y: f64| (x - p.x) * (x - p.x) + (y - p.y) * (y - p.y);
        let (of_x, last_x) = self.x.as_chunks::<LANES>();
        let (of_y, last_y) = self.y.as_chunks::<LANES>();
        // Of each lane, with the chunk that it was found in.
        let (least, chunks) = vectorised(
            #[inline(always)]
            || {
                let (mut least, mut chunks) = ([f64::INFINITY; LANES], [0_u64; LANES]);
                for (chunk, (x, y)) in (0..).zip(of_x.iter().zip(of_y)) {
                    for lane in 0..LANES {
                        let square = (x[lane] - p.x) * (x[lane] - p.x) + (y[lane] - p.y) * (y[lane] - p.y);
                        let is_nearer = square < least[lane];
                        least[lane] = if is_nearer { square } else { least[lane] };
                        chunks[lane] = if is_nearer { chunk } else { chunks[lane] };
                    }
                }
                (least, chunks)
            },
        );
        let of_lanes = least.into_iter().zip(chunks).enumerate();
        let of_lanes = of_lanes.map(|(lane, (square, chunk))| (square, LANES * chunk as usize + lane));
        let of_last = last_x.iter().zip(last_y).zip(LANES * of_x.len()..).map(|((x, y), i)| (square(*x, *y), i));
        let mut nearest = (f64::INFINITY, 0);
        for (square, i) in of_lanes.chain(of_last) {
            if square < nearest.0 || square == nearest.0 && i < nearest.1 {
                nearest = (square, i);
            }
        }
        nearest.1
    }

    fn foot_on(&self, side: usize, p: &Point2<f64>) -> Foot {
        let (start, along) = (self.point(side), self.round(side, 1) - self.point(side));
        let share = along.dot(&(p - start)) / along.norm_squared();
        let point = start + along * if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 };
        Foot { side, point, distance: (p - point).norm() }
    }

    #[cfg(feature = "serde")]
    pub(super) fn is_valid(&self) -> bool {
        self.x.len() == self.y.len()
            && (FEWEST_PLACES..=2 * MOST_PLACES).contains(&self.x.len())
            && self.x.iter().chain(&self.y).all(|x| x.is_finite())
            && Self::COUNTS.contains(&self.points_each)
    }
}

/// Empties a list and makes room in it for so many values.
pub(super) fn clear_with_room<T>(list: &mut Vec<T>, most: usize) {
    list.clear();
    list.reserve_exact(most);
}

/// Median, put in order in a list; 0 of none.
pub(super) fn median(of: impl Iterator<Item = f64>, values: &mut Vec<f64>) -> f64 {
    values.clear();
    values.extend(of);
    crate::map::median(values).unwrap_or(0.0)
}

/// Runs of neighbours among numbers that are `in_run`.
pub(super) fn runs(numbers: Range<usize>, in_run: impl Fn(usize) -> bool) -> impl Iterator<Item = Range<usize>> {
    let Range { start: mut next, end } = numbers;
    std::iter::from_fn(move || {
        let start = (next..end).find(|i| in_run(*i))?;
        next = (start..end).find(|i| !in_run(*i)).unwrap_or(end);
        Some(start..next)
    })
}

/// As [`runs`], of so many numbers all round, the first of which follows the last, counted on there; `None` where all are one run without an end.
pub(super) fn runs_all_round(
    count: usize,
    in_run: impl Fn(usize) -> bool,
) -> Option<impl Iterator<Item = Range<usize>>> {
    let first = (0..count).find(|i| !in_run(*i))?;
    Some(runs(first..first + count, move |i| in_run(i % count)))
}

#[cfg(test)]
mod tests {
    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;

    use super::*;

    fn ellipse(count: usize, noise: f64) -> Outline {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let mut point = |i: usize| {
            let t = std::f64::consts::TAU * i as f64 / count as f64;
            let mut error = || noise * random.sample::<f64, _>(StandardNormal);
            Point2::new(2.0 * t.cos() + error(), t.sin() + error())
        };
        Outline::closed((0..count).map(&mut point).collect()).expect("an ellipse")
    }

    #[test]
    fn the_noise_of_places_is_that_of_points_over_the_root_of_how_many_each_has() {
        for (count, points_each) in [(100, 1), (400, 4), (1200, 10)] {
            let mut places = Places::default();
            assert!(places.refill_from(&ellipse(count, 0.05)), "enough points");
            assert_eq!(places.points_each, points_each);
            let expected = 0.05 / (points_each as f64).sqrt();
            let noise = places.noise(&mut Vec::new());
            assert!((noise / expected - 1.0).abs() < 0.35, "{count}: {noise} of {expected}");
        }
        assert!(!Places::default().refill_from(&ellipse(FEWEST_PLACES - 1, 0.0)), "too few points");
    }

    #[test]
    fn the_nearest_place_of_a_contour_is_nearest_of_all_sides() {
        let mut places = Places::default();
        assert!(places.refill_from(&ellipse(100, 0.0)), "enough points");
        for p in [Point2::new(0.0, 0.0), Point2::new(3.0, 0.1), Point2::new(-1.0, 0.9), Point2::new(0.3, -2.0)] {
            let foot = places.nearest(&p);
            let least = (0..places.len()).map(|side| places.foot_on(side, &p).distance).fold(f64::INFINITY, f64::min);
            assert!((foot.distance - least).abs() < 1e-12, "{p}");
            assert!(((p - foot.point).norm() - foot.distance).abs() < 1e-12);
        }
    }

    #[test]
    fn of_places_that_are_equally_near_the_first_is_the_nearest() {
        for count in [24, 31, 32, 37, 128] {
            let far = |i: usize| if i % 5 == 3 { 1.0 } else { 2.0 + i as f64 };
            let places = Places { x: (0..count).map(far).collect(), y: vec![0.0; count], points_each: 1 };
            assert_eq!(places.nearest_place(&Point2::origin()), 3, "{count}");
            for i in 0..count {
                let nearest = places.nearest_place(&Point2::new(far(i), 0.1));
                assert_eq!(nearest, if i % 5 == 3 { 3 } else { i }, "{count}");
            }
        }
    }

    #[test]
    fn runs_all_round_go_on_behind_the_last_number() {
        let all_round = |in_run: &[bool]| runs_all_round(in_run.len(), |i| in_run[i]).map(Iterator::collect);
        let (no, yes) = (false, true);
        assert_eq!(all_round(&[yes, no, no, yes, no, yes, yes]), Some(vec![3..4, 5..8]));
        assert_eq!(all_round(&[no, no]), Some(vec![]));
        assert_eq!(all_round(&[yes, yes]), None);
        assert_eq!(runs(2..6, |i| i != 4).collect::<Vec<_>>(), vec![2..4, 5..6]);
    }
}
