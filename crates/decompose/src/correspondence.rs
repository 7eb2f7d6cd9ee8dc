use nalgebra::Point2;

use crate::{
    decomposition::Decomposition, error::CorrespondenceError, line::Line, related_point::intersection,
    rotation_chart::rotation_chart,
};

/// Largest number of conjugate pairs in a level, that of an octic.
pub const MAX_PAIRS: usize = 4;

/// Below this relative gap between two values f(d) their order counts as tied.
///
/// Random bounded quartics with coefficients perturbed by up to 1 % had their pairs swapped by the order in 0.4 % of the
/// cases above it and in 6 % below it.
pub const ORDERING_MARGIN: f64 = 0.1;

/// Above this relative gap the order decides whatever continuity says. Outlines that are symmetric but for noise of 1 % had gaps
/// of up to 0.4.
const CERTAIN_MARGIN: f64 = 0.5;

/// Continuity is clear where the change is less than that of a turn by about half a radian...
const SMALL_COST: f64 = 0.3;

/// ...and the second best pairing is twice as far away (costs are squares).
const CLEAR_COST_RATIO: f64 = 4.0;

/// What settled a [`Correspondence`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Criterion {
    /// The order of the values f(d) at the related points, as in the paper.
    Ordering,
    /// The nearest pairs in the rotation chart and in related points, because the order was tied or nearly so.
    Continuity,
}

/// Which conjugate pair of a later frame is which one of an earlier frame, found in two independent ways.
///
/// The paper orders the pairs by the values f(d) of the monic polynomial at their related points: right for any motion,
/// but a symmetric outline ties the values. Continuity searches all pairings for the smallest change: blind to ties, but
/// right only while the motion between the frames is small. Ordering decides where its margin is at least
/// [`ORDERING_MARGIN`], continuity where it is not, or where that leaves no doubt and the margin is not beyond what noise gives to
/// a symmetric outline.
///
/// A prediction makes continuity right for large motions too: give the earlier frame's decomposition
/// [`moved`](Decomposition::moved) by the motion expected.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Correspondence {
    count: usize,
    by_ordering: [usize; MAX_PAIRS],
    by_continuity: [usize; MAX_PAIRS],
    ordering_margin: f64,
    continuity_cost: f64,
    runner_up_cost: f64,
}

impl Correspondence {
    /// Matches the conjugate pairs of the leading level of two frames.
    ///
    /// `object_size` is a length in the unit of the outline, such as its RMS radius: displacements of related points are
    /// measured by it.
    ///
    /// # Errors
    /// Different numbers of pairs, none at all, or a size that is not positive and finite.
    pub fn between(
        earlier: &Decomposition,
        later: &Decomposition,
        object_size: f64,
    ) -> Result<Self, CorrespondenceError> {
        Self::at_level(earlier, later, earlier.degree().value(), object_size)
    }

    /// Matches the conjugate pairs of level m.
    ///
    /// # Errors
    /// As [`between`](Self::between).
    pub fn at_level(
        earlier: &Decomposition,
        later: &Decomposition,
        m: usize,
        object_size: f64,
    ) -> Result<Self, CorrespondenceError> {
        if !(object_size.is_finite() && object_size > 0.0) {
            return Err(CorrespondenceError::ObjectSize { size: object_size });
        }
        let (before, after) = (Pairs::of(earlier, m), Pairs::of(later, m));
        let count = before.count;
        if count != after.count {
            return Err(CorrespondenceError::PairCountDiffers { level: m, earlier: count, later: after.count });
        }
        if count == 0 {
            return Err(CorrespondenceError::NoConjugatePair { level: m });
        }
        let mut by_ordering = [0; MAX_PAIRS];
        for (&i, &j) in before.order[..count].iter().zip(&after.order) {
            by_ordering[i] = j;
        }
        let mut search = Search::new(&before, &after, object_size);
        search.extend(0, 0.0);
        if !search.best_cost.is_finite() {
            return Err(CorrespondenceError::NotFinite { level: m });
        }
        Ok(Self {
            count,
            by_ordering,
            by_continuity: search.best,
            ordering_margin: before.margin.min(after.margin),
            continuity_cost: search.best_cost,
            runner_up_cost: search.runner_up_cost,
        })
    }

    /// `permutation()[i]` is the pair of the later frame that pair i of the earlier one has become; pairs are counted as
    /// [`Decomposition::conjugate_pairs`] gives them.
    #[must_use]
    pub fn permutation(&self) -> &[usize] {
        match self.decided_by() {
            Criterion::Ordering => self.by_ordering(),
            Criterion::Continuity => self.by_continuity(),
        }
    }

    /// Which of the two ways the permutation comes from.
    #[must_use]
    pub fn decided_by(&self) -> Criterion {
        let is_clear = self.continuity_cost <= SMALL_COST
            && self.runner_up_cost >= CLEAR_COST_RATIO * self.continuity_cost
            && self.ordering_margin < CERTAIN_MARGIN;
        if self.ordering_margin < ORDERING_MARGIN || (is_clear && !self.agrees()) {
            Criterion::Continuity
        } else {
            Criterion::Ordering
        }
    }

    /// Whether both ways give the same permutation. Where they do not, the motion was large or the order is unreliable.
    #[must_use]
    pub fn agrees(&self) -> bool {
        self.by_ordering() == self.by_continuity()
    }

    /// The permutation by the order of the values f(d).
    #[must_use]
    pub fn by_ordering(&self) -> &[usize] {
        &self.by_ordering[..self.count]
    }

    /// The permutation with the smallest change.
    #[must_use]
    pub fn by_continuity(&self) -> &[usize] {
        &self.by_continuity[..self.count]
    }

    /// Smallest gap between neighbours in the order, relative to the largest absolute value, of the two frames: between 0
    /// (a tie) and 2. Infinite if there is only one pair.
    #[must_use]
    pub const fn ordering_margin(&self) -> f64 {
        self.ordering_margin
    }

    /// Change of the pairing by continuity: sum over the pairs of the squared distances in the rotation chart and
    /// between related points in object sizes.
    #[must_use]
    pub const fn continuity_cost(&self) -> f64 {
        self.continuity_cost
    }

    /// Change of the second best pairing; infinite if there is only one pair. Continuity is safe where this is much
    /// larger than [`continuity_cost`](Self::continuity_cost).
    #[must_use]
    pub const fn runner_up_cost(&self) -> f64 {
        self.runner_up_cost
    }
}

/// The conjugate pairs of one level of one frame.
struct Pairs {
    count: usize,
    lines: [Line; MAX_PAIRS],
    points: [Point2<f64>; MAX_PAIRS],
    /// Pairs by rising value f(d) of the monic polynomial.
    order: [usize; MAX_PAIRS],
    margin: f64,
}

impl Pairs {
    fn of(decomposition: &Decomposition, level: usize) -> Self {
        let leading = decomposition.coefficient(decomposition.degree().value());
        let mut pairs = Self {
            count: 0,
            lines: [Line::ZERO; MAX_PAIRS],
            points: [Point2::origin(); MAX_PAIRS],
            order: [0, 1, 2, 3],
            margin: f64::INFINITY,
        };
        let mut values = [0.0; MAX_PAIRS];
        for (i, line) in decomposition.conjugate_pairs(level).enumerate() {
            pairs.lines[i] = *line;
            pairs.points[i] = intersection(line, &line.conjugate());
            values[i] = decomposition.evaluate(&pairs.points[i]) / leading;
            pairs.count += 1;
        }
        let order = &mut pairs.order[..pairs.count];
        order.sort_unstable_by(|&i, &j| values[i].total_cmp(&values[j]));
        let largest = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        for two in order.windows(2) {
            let gap = (values[two[1]] - values[two[0]]) / largest;
            // Equal zeros and overflows are ties.
            pairs.margin = pairs.margin.min(if gap.is_finite() { gap } else { 0.0 });
        }
        pairs
    }
}

/// Exhaustive search over the pairings, at most 24.
struct Search {
    count: usize,
    cost: [[f64; MAX_PAIRS]; MAX_PAIRS],
    chosen: [usize; MAX_PAIRS],
    taken: [bool; MAX_PAIRS],
    best: [usize; MAX_PAIRS],
    best_cost: f64,
    runner_up_cost: f64,
}

impl Search {
    fn new(before: &Pairs, after: &Pairs, object_size: f64) -> Self {
        let mut cost = [[0.0; MAX_PAIRS]; MAX_PAIRS];
        for (i, row) in cost.iter_mut().enumerate().take(before.count) {
            for (j, cost) in row.iter_mut().enumerate().take(after.count) {
                let turned = rotation_chart(before.lines[i].l) - rotation_chart(after.lines[j].l);
                let shifted = (before.points[i] - after.points[j]) / object_size;
                *cost = turned.norm_sqr() + shifted.norm_squared();
            }
        }
        Self {
            count: before.count,
            cost,
            chosen: [0; MAX_PAIRS],
            taken: [false; MAX_PAIRS],
            best: [0; MAX_PAIRS],
            best_cost: f64::INFINITY,
            runner_up_cost: f64::INFINITY,
        }
    }

    /// Tries every free partner for pair i, at the cost spent on the pairs before it.
    fn extend(&mut self, i: usize, spent: f64) {
        if i == self.count {
            if spent < self.best_cost {
                self.runner_up_cost = self.best_cost;
                (self.best, self.best_cost) = (self.chosen, spent);
            } else {
                self.runner_up_cost = self.runner_up_cost.min(spent);
            }
            return;
        }
        for j in 0..self.count {
            if !self.taken[j] {
                (self.chosen[i], self.taken[j]) = (j, true);
                self.extend(i + 1, spent + self.cost[i][j]);
                self.taken[j] = false;
            }
        }
    }
}
