//! The step that things which look alike have made together from one picture to the next, such as parts on a belt.
use std::collections::BTreeMap;

use freeform_curve_fit::Rectangle;
use nalgebra::{Point2, Vector2};

use crate::tracing::trace::TracedOutline;

/// Farthest that one of them may be from where the step leads it, in its diameters.
const TOLERANCE: f64 = 0.25;

/// Where its centre is farther from the border than so many of its sizes a thing is whole: half of one, and more as the centre of its area is not
/// that of the box around it.
const FROM_BORDER: f64 = 0.65;

/// Fewer things than these make no step together where there are others: two of several do so by chance.
const FEWEST: usize = 3;

/// Things that may be missing in one of two pictures where another step is as good. A row with its ends in the picture that is taken for its
/// neighbours leaves two over, one at either end.
const ONE_MISSED: usize = 1;

/// Steps that are looked at: the most frequent ones.
const MOST_STEPS: usize = 16;

/// A step may as well be another one that is less than so many times as large.
const TIMES_LARGER: f64 = 2.0;

/// Something seen whole in a picture.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Spot {
    /// Centre of its area, in the unit of the outlines.
    pub(crate) centre: Point2<f64>,
    /// Width and height of the box around it.
    pub(crate) size: Vector2<f64>,
}

impl Spot {
    pub(crate) fn of(traced: &TracedOutline) -> Self {
        Self { centre: traced.centre, size: traced.outline.bounding_box().size() }
    }

    fn diameter(&self) -> f64 {
        self.size.max()
    }
}

/// What is seen whole in two pictures, one after the other.
#[derive(Debug)]
pub(crate) struct TwoPictures {
    before: Vec<Spot>,
    now: Vec<Spot>,
    /// Of each thing of the first picture, which of the second are like it, and so near that they may be the same.
    alike: Vec<Vec<usize>>,
    /// What both pictures show of the plane; `None` where that is not known.
    extent: Option<Rectangle>,
    /// The steps that most pairs of things alike have in common.
    steps: Vec<Assignment>,
}

/// Which things of the first picture are which of the second.
#[derive(Debug, Clone)]
pub(crate) struct Assignment {
    /// The mean step, in the unit of the outlines.
    pub(crate) step: Vector2<f64>,
    pub(crate) pairs: Vec<(usize, usize)>,
    /// Things that are in one of the pictures only, although they would be whole in the other if they had made the step too.
    unexplained: usize,
}

impl TwoPictures {
    pub(crate) fn new(
        [before, now]: [Vec<Spot>; 2],
        is_alike: impl Fn(usize, usize) -> bool,
        extent: Option<Rectangle>,
    ) -> Self {
        let like = |from| (0..now.len()).filter(|to| is_alike(from, *to)).collect();
        let alike = (0..before.len()).map(like).collect();
        let two = Self { before, now, alike, extent, steps: Vec::new() };
        Self { steps: two.frequent_steps(), ..two }
    }

    /// Pairs that have been found one by one. What is left over is taken to move as what is nearest to it does.
    pub(crate) fn one_by_one(&self, pairs: Vec<(usize, usize)>) -> Assignment {
        let step = self.mean_step(&pairs);
        let beside = |place: Point2<f64>, of: &dyn Fn(&(usize, usize)) -> Point2<f64>| {
            let far = |pair: &&(usize, usize)| (of(pair) - place).norm();
            let nearest = pairs.iter().min_by(|a, b| far(a).total_cmp(&far(b)));
            nearest.map_or_else(Vector2::zeros, |pair| self.displacement(*pair))
        };
        let unexplained = self.unexplained(
            &pairs,
            |spot| beside(spot.centre, &|pair| self.before[pair.0].centre),
            |spot| beside(spot.centre, &|pair| self.now[pair.1].centre),
        );
        Assignment { step, pairs, unexplained }
    }

    /// The step that, beside those found one by one whose things it leaves over, explains more of what is seen than they do, and the smallest of
    /// these: of a row of things that goes on beyond the picture on both sides, other steps explain as much. `None` where there is none of half of
    /// the things. One thing alone makes another step than it was found to make only where that explains all that is seen.
    pub(crate) fn better_than(&self, found: &Assignment) -> Option<Assignment> {
        let (most, is_alone) = (self.before.len().min(self.now.len()), self.before.len() == 1);
        if is_alone && found.pairs.is_empty() {
            return None;
        }
        let better = self.steps.iter().filter_map(|step| {
            let left = |pair: &(usize, usize)| !step.pairs.iter().any(|of| of.0 == pair.0 || of.1 == pair.1);
            let kept: Vec<_> = found.pairs.iter().copied().filter(left).collect();
            let all: Vec<_> = step.pairs.iter().copied().chain(kept).collect();
            let unexplained = self.unexplained_by(step.step, &all);
            let is_better = if is_alone {
                unexplained == 0 && found.unexplained > 0
            } else {
                let is_by_chance = step.pairs.len() < FEWEST && step.pairs.len() < most;
                !is_by_chance && 2 * step.pairs.len() >= most && unexplained < found.unexplained
            };
            is_better.then_some(Assignment { step: step.step, pairs: all, unexplained })
        });
        let key = |step: &Assignment| (step.unexplained, step.step.norm());
        better.min_by(|a, b| key(a).partial_cmp(&key(b)).expect("lengths are finite"))
    }

    /// The step that half of the pairs of an assignment or more have in common, two at least: fewer of a crowd may make one by chance.
    pub(crate) fn shared(&self, taken: &Assignment) -> Option<Assignment> {
        let led =
            |step: &Assignment| taken.pairs.iter().copied().filter(|pair| self.is_led(*pair, step.step)).collect();
        let groups = self.steps.iter().map(led).filter(|pairs: &Vec<_>| pairs.len() > 1);
        let most = groups.max_by_key(Vec::len).filter(|pairs| 2 * pairs.len() >= taken.pairs.len());
        most.map(|pairs| self.together(pairs, &taken.pairs))
    }

    /// Another step that explains as much as one that several have made together, and is not far larger. The others of those taken stay as they are.
    pub(crate) fn rival_of(&self, shared: &Assignment, taken: &Assignment) -> Option<Vector2<f64>> {
        let others: Vec<_> = taken.pairs.iter().copied().filter(|pair| !shared.pairs.contains(pair)).collect();
        let is_free = |pair: &(usize, usize)| !others.iter().any(|other| other.0 == pair.0 || other.1 == pair.1);
        let is_rival = |other: &Assignment| {
            let pairs: Vec<_> = other.pairs.iter().copied().filter(is_free).collect();
            let is_other = !shared.pairs.iter().any(|pair| self.is_led(*pair, other.step));
            let explains = 2 * pairs.len() >= shared.pairs.len();
            let all: Vec<_> = pairs.iter().chain(&others).copied().collect();
            is_other
                && explains
                && other.step.norm() < TIMES_LARGER * shared.step.norm()
                && self.unexplained_by(self.mean_step(&pairs), &all) <= shared.unexplained + ONE_MISSED
        };
        let rivals = self.steps.iter().filter(|other| is_rival(other)).map(|other| other.step);
        rivals.min_by(|a, b| a.norm().total_cmp(&b.norm()))
    }

    /// Pairs that make their step together, among all that are taken.
    fn together(&self, pairs: Vec<(usize, usize)>, all: &[(usize, usize)]) -> Assignment {
        let step = self.mean_step(&pairs);
        let unexplained = self.unexplained_by(step, all);
        Assignment { step, pairs, unexplained }
    }

    /// Of what none of these pairs has, how many would be whole in the other picture if all made a step.
    fn unexplained_by(&self, step: Vector2<f64>, pairs: &[(usize, usize)]) -> usize {
        self.unexplained(pairs, |_| step, |_| step)
    }

    fn mean_step(&self, pairs: &[(usize, usize)]) -> Vector2<f64> {
        pairs.iter().map(|pair| self.displacement(*pair)).sum::<Vector2<f64>>() / pairs.len().max(1) as f64
    }

    fn displacement(&self, (from, to): (usize, usize)) -> Vector2<f64> {
        self.now[to].centre - self.before[from].centre
    }

    fn tolerance(&self, pair: (usize, usize)) -> f64 {
        TOLERANCE * self.before[pair.0].diameter().max(self.now[pair.1].diameter())
    }

    fn is_led(&self, pair: (usize, usize), step: Vector2<f64>) -> bool {
        (self.displacement(pair) - step).norm() <= self.tolerance(pair)
    }

    /// The steps that most pairs of things alike have in common; of one thing alone, all of its own.
    fn frequent_steps(&self) -> Vec<Assignment> {
        let like = |(from, like): (usize, &Vec<usize>)| like.iter().map(move |to| (from, *to)).collect::<Vec<_>>();
        let pairs: Vec<_> = self.alike.iter().enumerate().flat_map(like).collect();
        let cell = pairs.iter().map(|pair| self.tolerance(*pair)).fold(f64::INFINITY, f64::min);
        // Votes of a cell and its neighbours, so that no step is divided among several.
        let mut votes: BTreeMap<[i64; 2], (usize, Vector2<f64>)> = BTreeMap::new();
        for pair in &pairs {
            let displacement = self.displacement(*pair);
            let [x, y] = [displacement.x, displacement.y].map(|along| (along / cell).round() as i64);
            for near in (-1..=1).flat_map(|i| (-1..=1).map(move |j| [x + i, y + j])) {
                let (count, sum) = votes.entry(near).or_default();
                (*count, *sum) = (*count + 1, *sum + displacement);
            }
        }
        let fewest = self.before.len().min(2);
        let mut frequent: Vec<_> = votes.into_values().filter(|(count, _)| *count >= fewest).collect();
        let mean = |(count, sum): &(usize, Vector2<f64>)| *sum / *count as f64;
        frequent.sort_by(|a, b| b.0.cmp(&a.0).then(mean(a).norm().total_cmp(&mean(b).norm())));
        let mut steps: Vec<Assignment> = Vec::new();
        for step in frequent.iter().map(mean) {
            let is_new = |other: &Assignment| {
                let known = other.pairs.iter().map(|pair| self.tolerance(*pair)).fold(cell, f64::max);
                (other.step - step).norm() > known
            };
            if steps.len() < MOST_STEPS && steps.iter().all(is_new) {
                let pairs = self.led_by(step);
                let all = pairs.clone();
                steps.extend((pairs.len() >= fewest).then(|| self.together(pairs, &all)));
            }
        }
        steps
    }

    /// Each thing with the nearest one that is like it where a step leads it.
    fn led_by(&self, step: Vector2<f64>) -> Vec<(usize, usize)> {
        let mut is_taken = vec![false; self.now.len()];
        let mut pairs = Vec::new();
        for (from, like) in self.alike.iter().enumerate() {
            let far = |to: &usize| (self.displacement((from, *to)) - step).norm();
            let there = like.iter().copied().filter(|to| self.is_led((from, *to), step) && !is_taken[*to]);
            if let Some(to) = there.min_by(|a, b| far(a).total_cmp(&far(b))) {
                is_taken[to] = true;
                pairs.push((from, to));
            }
        }
        pairs
    }

    /// Of what no pair has, how many would be whole in the other picture if they made the step that is theirs there or here.
    fn unexplained(
        &self,
        pairs: &[(usize, usize)],
        step_from: impl Fn(&Spot) -> Vector2<f64>,
        step_to: impl Fn(&Spot) -> Vector2<f64>,
    ) -> usize {
        let [mut has_pair, mut is_paired] = [vec![false; self.before.len()], vec![false; self.now.len()]];
        pairs.iter().for_each(|(from, to)| (has_pair[*from], is_paired[*to]) = (true, true));
        let gone = self.before.iter().zip(has_pair).filter(|(_, has_pair)| !has_pair);
        let come = self.now.iter().zip(is_paired).filter(|(_, is_paired)| !is_paired);
        gone.filter(|(spot, _)| self.would_be_whole(spot, step_from(spot))).count()
            + come.filter(|(spot, _)| self.would_be_whole(spot, -step_to(spot))).count()
    }

    /// Whether something would be seen whole a step further.
    fn would_be_whole(&self, spot: &Spot, step: Vector2<f64>) -> bool {
        let (centre, far) = (spot.centre + step, FROM_BORDER * spot.size);
        self.extent.is_none_or(|extent| extent.contains(&(centre - far)) && extent.contains(&(centre + far)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EXTENT: Rectangle = Rectangle { low: Point2::new(0.0, 0.0), high: Point2::new(640.0, 200.0) };

    /// Things of 50 pixels at these places of a row, as far as they are whole.
    fn row(places: impl Iterator<Item = f64>) -> Vec<Spot> {
        let whole = places.filter(|x| (25.0..=615.0).contains(x));
        whole.map(|x| Spot { centre: Point2::new(x, 100.0), size: Vector2::new(50.0, 30.0) }).collect()
    }

    fn moved(places: &[f64], step: f64) -> TwoPictures {
        let [before, now] = [0.0, step].map(|by| row(places.iter().map(|x| x + by)));
        TwoPictures::new([before, now], |_, _| true, Some(EXTENT))
    }

    fn rival_of(two: &TwoPictures, taken: &Assignment) -> Option<Vector2<f64>> {
        two.rival_of(&two.shared(taken)?, taken)
    }

    #[test]
    fn a_group_in_the_open_has_one_step_however_near_it_comes_to_its_neighbours() {
        for step in [-70.0, -45.0, 20.0, 45.0, 60.0] {
            let two = moved(&[180.0, 280.0, 380.0, 480.0], step);
            let nothing = two.one_by_one(Vec::new());
            let best = two.better_than(&nothing).expect("a step");
            assert!((best.step.x - step).abs() < 1e-9 && best.pairs.len() > 2, "{step}: {best:?}");
            assert!(best.pairs.iter().all(|(from, to)| from == to), "{step}: {best:?}");
            assert_eq!(rival_of(&two, &best), None, "{step}");
        }
    }

    #[test]
    fn pairs_with_neighbours_are_given_up_where_they_leave_over_what_all_together_explain() {
        let two = moved(&[180.0, 280.0, 380.0, 480.0], 60.0);
        let with_neighbours = two.one_by_one(vec![(1, 0), (2, 1), (3, 2)]);
        assert_eq!(two.better_than(&with_neighbours).expect("a step").pairs.len(), 4);
        let right = two.one_by_one((0..4).map(|i| (i, i)).collect());
        assert!(two.better_than(&right).is_none());
    }

    #[test]
    fn a_row_without_an_end_makes_the_smallest_step_and_may_make_another_if_that_is_not_twice_as_large() {
        let belt: Vec<f64> = (-10..20).map(|i| 100.0 * f64::from(i) + 33.0).collect();
        for (step, smallest, rival) in [
            (20.0, 20.0, None),
            (30.0, 30.0, None),
            (45.0, 45.0, Some(-55.0)),
            (-45.0, -45.0, Some(55.0)),
            (62.0, -38.0, Some(62.0)),
        ] {
            let two = moved(&belt, step);
            let best = two.better_than(&two.one_by_one(Vec::new())).expect("a step");
            assert!((best.step.x - smallest).abs() < 1e-9, "{step}: {}", best.step.x);
            assert_eq!(rival_of(&two, &best).map(|step| step.x.round()), rival, "{step}");
        }
    }

    #[test]
    fn what_rests_beside_a_row_without_an_end_does_not_make_its_step_sure() {
        let belt = (-10..20).map(|i| 100.0 * f64::from(i) + 33.0);
        let [before, now] = [0.0, 45.0].map(|step| {
            let beside = Spot { centre: Point2::new(300.0, 160.0), size: Vector2::new(50.0, 30.0) };
            row(belt.clone().map(|x| x + step)).into_iter().chain([beside]).collect::<Vec<_>>()
        });
        let two = TwoPictures::new([before.clone(), now.clone()], |_, _| true, Some(EXTENT));
        let led = |from: &Spot, to: &Spot| (to.centre - from.centre - Vector2::new(45.0, 0.0)).norm() < 1.0;
        let is_same = |from: &Spot, to: &Spot| led(from, to) || from.centre == to.centre;
        let pairs = before.iter().enumerate().filter_map(|(i, a)| Some((i, now.iter().position(|b| is_same(a, b))?)));
        let found = two.one_by_one(pairs.collect());
        assert!(two.better_than(&found).is_none());
        assert_eq!(rival_of(&two, &found).map(|step| step.x.round()), Some(-55.0));
    }

    #[test]
    fn things_that_come_and_go_anywhere_make_no_step_together() {
        let spot = |x: f64, y: f64| Spot { centre: Point2::new(x, y), size: Vector2::new(6.0, 6.0) };
        let before = vec![spot(20.0, 30.0), spot(95.0, 160.0), spot(300.0, 44.0), spot(410.0, 130.0), spot(33.0, 90.0)];
        let now = vec![spot(70.0, 31.0), spot(112.0, 22.0), spot(330.0, 140.0), spot(500.0, 60.0), spot(240.0, 99.0)];
        let two = TwoPictures::new([before, now], |_, _| true, Some(EXTENT));
        assert!(two.better_than(&two.one_by_one(Vec::new())).is_none());
    }
}
