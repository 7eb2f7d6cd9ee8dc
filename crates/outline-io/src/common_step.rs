//! The step that things which look alike have made together from one picture to the next, such as parts on a belt.
use std::collections::BTreeMap;

use nalgebra::{Point2, Vector2};

use crate::trace::TracedOutline;

/// Farthest that one of them may be from where the step leads it, in its diameters.
const TOLERANCE: f64 = 0.25;

/// Where its centre is farther from the border than so many of its sizes a thing is whole: half of one, and more as the centre of its area is not that
/// of the box around it.
const FROM_BORDER: f64 = 0.65;

/// Steps that are looked at: the most frequent ones.
const MOST_STEPS: usize = 16;

/// A step may as well be another one that is less than so many times as large.
const TIMES_LARGER: f64 = 2.0;

/// Something seen whole in a picture.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Spot {
    /// Centre of its area.
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
    /// Width and height of both pictures, from the origin on; `None` where that is not known.
    extent: Option<Vector2<f64>>,
}

/// A step with the things that it leads from one picture to the other.
#[derive(Debug, Clone)]
pub(crate) struct CommonStep {
    pub(crate) step: Vector2<f64>,
    /// Which of the first picture are which of the second.
    pub(crate) pairs: Vec<(usize, usize)>,
    /// Things that are in one of the pictures only, although the step leads to none that would be cut by the border of the other.
    unexplained: usize,
}

impl TwoPictures {
    pub(crate) fn new(
        [before, now]: [Vec<Spot>; 2],
        is_alike: impl Fn(usize, usize) -> bool,
        extent: Option<Vector2<f64>>,
    ) -> Self {
        let like = |from| (0..now.len()).filter(|to| is_alike(from, *to)).collect();
        let alike = (0..before.len()).map(like).collect();
        Self { before, now, alike, extent }
    }

    /// What pairs that have been found one by one explain; their step is the mean.
    pub(crate) fn of_pairs(&self, pairs: Vec<(usize, usize)>) -> CommonStep {
        let step = pairs.iter().map(|pair| self.displacement(*pair)).sum::<Vector2<f64>>() / pairs.len().max(1) as f64;
        let unexplained = self.unexplained(&pairs, step);
        CommonStep { step, pairs, unexplained }
    }

    /// The step that explains more of what is seen than what has been found one by one does, and the smallest of these: of a row of things that
    /// goes on beyond the picture on both sides, other steps explain as much. `None` where there is none of half of the things.
    pub(crate) fn better_than(&self, found: &CommonStep) -> Option<CommonStep> {
        let most = self.before.len().min(self.now.len());
        let key = |step: &CommonStep| (step.unexplained, step.step.norm());
        let steps = self.steps().into_iter().filter(|step| step.pairs.len() > 1 && 2 * step.pairs.len() >= most);
        steps
            .filter(|step| step.unexplained < found.unexplained)
            .min_by(|a, b| key(a).partial_cmp(&key(b)).expect("lengths are finite"))
    }

    /// Another step that explains as much as one that all things have made together, and is not far larger.
    pub(crate) fn rival_of(&self, taken: &CommonStep) -> Option<Vector2<f64>> {
        if !self.is_common(taken) {
            return None;
        }
        let is_rival = |other: &CommonStep| {
            other.unexplained <= taken.unexplained
                && 2 * other.pairs.len() >= taken.pairs.len()
                && other.step.norm() < TIMES_LARGER * taken.step.norm()
                && !taken.pairs.iter().any(|pair| self.is_led(*pair, other.step))
        };
        let rivals = self.steps().into_iter().filter(is_rival).map(|other| other.step);
        rivals.min_by(|a, b| a.norm().total_cmp(&b.norm()))
    }

    /// Whether several things have all made the step together.
    pub(crate) fn is_common(&self, taken: &CommonStep) -> bool {
        taken.pairs.len() > 1 && taken.pairs.iter().all(|pair| self.is_led(*pair, taken.step))
    }

    fn displacement(&self, (from, to): (usize, usize)) -> Vector2<f64> {
        self.now[to].centre - self.before[from].centre
    }

    fn is_led(&self, pair: (usize, usize), step: Vector2<f64>) -> bool {
        let diameter = self.before[pair.0].diameter().max(self.now[pair.1].diameter());
        (self.displacement(pair) - step).norm() <= TOLERANCE * diameter
    }

    /// The steps that most pairs of things alike have in common.
    fn steps(&self) -> Vec<CommonStep> {
        let like = |(from, like): (usize, &Vec<usize>)| like.iter().map(move |to| (from, *to)).collect::<Vec<_>>();
        let pairs: Vec<_> = self.alike.iter().enumerate().flat_map(like).collect();
        let diameters = pairs.iter().map(|pair| self.before[pair.0].diameter());
        let cell = TOLERANCE * diameters.fold(f64::INFINITY, f64::min);
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
        let mut frequent: Vec<_> = votes.into_values().filter(|(count, _)| *count > 1).collect();
        let mean = |(count, sum): &(usize, Vector2<f64>)| *sum / *count as f64;
        frequent.sort_by(|a, b| b.0.cmp(&a.0).then(mean(a).norm().total_cmp(&mean(b).norm())));
        let mut steps: Vec<CommonStep> = Vec::new();
        for step in frequent.iter().map(mean) {
            if steps.len() < MOST_STEPS && !steps.iter().any(|other| (other.step - step).norm() < 2.0 * cell) {
                steps.push(self.of_pairs(self.led_by(step)));
            }
        }
        steps
    }

    /// Each thing with the nearest one that is like it where a step leads it.
    fn led_by(&self, step: Vector2<f64>) -> Vec<(usize, usize)> {
        let mut pairs: Vec<(usize, usize)> = Vec::new();
        for (from, like) in self.alike.iter().enumerate() {
            let far = |to: &usize| (self.displacement((from, *to)) - step).norm();
            let is_free = |to: &usize| !pairs.iter().any(|pair| pair.1 == *to) && self.is_led((from, *to), step);
            let nearest = like.iter().copied().filter(is_free).min_by(|a, b| far(a).total_cmp(&far(b)));
            pairs.extend(nearest.map(|to| (from, to)));
        }
        pairs
    }

    fn unexplained(&self, pairs: &[(usize, usize)], step: Vector2<f64>) -> usize {
        let gone = (0..self.before.len()).filter(|from| !pairs.iter().any(|pair| pair.0 == *from));
        let come = (0..self.now.len()).filter(|to| !pairs.iter().any(|pair| pair.1 == *to));
        let is_gone = |from: &usize| self.would_be_whole(&self.before[*from], step);
        let is_come = |to: &usize| self.would_be_whole(&self.now[*to], -step);
        gone.filter(is_gone).count() + come.filter(is_come).count()
    }

    /// Whether something would be seen whole a step further.
    fn would_be_whole(&self, spot: &Spot, step: Vector2<f64>) -> bool {
        let (centre, far) = ((spot.centre + step).coords, FROM_BORDER * spot.size);
        self.extent.is_none_or(|extent| (centre - far).min() >= 0.0 && (extent - centre - far).min() >= 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EXTENT: Vector2<f64> = Vector2::new(640.0, 200.0);

    /// Things of 50 pixels at these places of a row, as far as they are whole.
    fn row(places: impl Iterator<Item = f64>) -> Vec<Spot> {
        let whole = places.filter(|x| (25.0..=615.0).contains(x));
        whole.map(|x| Spot { centre: Point2::new(x, 100.0), size: Vector2::new(50.0, 30.0) }).collect()
    }

    fn moved(places: &[f64], step: f64) -> TwoPictures {
        let [before, now] = [0.0, step].map(|by| row(places.iter().map(|x| x + by)));
        TwoPictures::new([before, now], |_, _| true, Some(EXTENT))
    }

    #[test]
    fn a_group_in_the_open_has_one_step_however_near_it_comes_to_its_neighbours() {
        for step in [-70.0, -45.0, 20.0, 45.0, 60.0, 130.0] {
            let two = moved(&[180.0, 280.0, 380.0, 480.0], step);
            let nothing = two.of_pairs(Vec::new());
            let best = two.better_than(&nothing).expect("a step");
            assert!((best.step.x - step).abs() < 1e-9 && best.pairs.len() > 2, "{step}: {best:?}");
            assert!(best.pairs.iter().all(|(from, to)| from == to), "{step}: {best:?}");
            assert_eq!(two.rival_of(&best), None, "{step}");
        }
    }

    #[test]
    fn pairs_with_neighbours_are_given_up_where_they_leave_over_what_all_together_explain() {
        let two = moved(&[180.0, 280.0, 380.0, 480.0], 60.0);
        let with_neighbours = two.of_pairs(vec![(1, 0), (2, 1), (3, 2)]);
        assert_eq!(two.better_than(&with_neighbours).expect("a step").pairs.len(), 4);
        let right = two.of_pairs((0..4).map(|i| (i, i)).collect());
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
            let best = two.better_than(&two.of_pairs(Vec::new())).expect("a step");
            assert!((best.step.x - smallest).abs() < 1e-9, "{step}: {}", best.step.x);
            assert_eq!(two.rival_of(&best).map(|step| step.x.round()), rival, "{step}");
        }
    }

    #[test]
    fn things_that_come_and_go_anywhere_make_no_step_together() {
        let spot = |x: f64, y: f64| Spot { centre: Point2::new(x, y), size: Vector2::new(6.0, 6.0) };
        let before = vec![spot(20.0, 30.0), spot(95.0, 160.0), spot(300.0, 44.0), spot(410.0, 130.0), spot(33.0, 90.0)];
        let now = vec![spot(70.0, 31.0), spot(112.0, 22.0), spot(330.0, 140.0), spot(500.0, 60.0), spot(240.0, 99.0)];
        let two = TwoPictures::new([before, now], |_, _| true, Some(EXTENT));
        assert!(two.better_than(&two.of_pairs(Vec::new())).is_none());
    }
}
