use nalgebra::Point2;

use crate::deviations::{check_deviations, mapped_deviations};
use crate::error::OutlineError;
use crate::points::{check_not_collinear, check_points};

/// An ordered open piece of a contour, either way round: at least two finite points that are not all equal. They may have standard
/// deviations.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "WrittenArc", into = "WrittenArc"))]
pub struct OpenArc {
    points: Vec<Point2<f64>>,
    deviations: Option<Vec<f64>>,
}

impl OpenArc {
    /// Checks and takes over the points, in any length unit.
    ///
    /// # Errors
    /// Fewer than 2 points, a coordinate that is not finite or beyond 1e100, all points equal.
    pub fn new(points: Vec<Point2<f64>>) -> Result<Self, OutlineError> {
        check_points(&points, 2)?;
        Ok(Self { points, deviations: None })
    }

    /// This arc with standard deviations of its points; see [`Outline::with_deviations`](crate::Outline::with_deviations).
    ///
    /// # Errors
    /// Not one for each point, or one that is not a positive finite number.
    pub fn with_deviations(self, deviations: Vec<f64>) -> Result<Self, OutlineError> {
        check_deviations(&deviations, self.points.len())?;
        Ok(Self { deviations: Some(deviations), ..self })
    }

    /// The standard deviations of the points in their order; `None` where nothing is known of them.
    #[must_use]
    pub fn deviations(&self) -> Option<&[f64]> {
        self.deviations.as_deref()
    }

    /// This arc with every point mapped.
    pub(crate) fn mapped(&self, map: impl Fn(&Point2<f64>) -> Point2<f64>) -> Result<Self, OutlineError> {
        let moved = Self::new(self.points.iter().map(&map).collect())?;
        match &self.deviations {
            Some(own) => moved.with_deviations(mapped_deviations(&self.points, false, own, map).collect()),
            None => Ok(moved),
        }
    }

    fn reverse(&mut self) {
        self.points.reverse();
        self.deviations.iter_mut().for_each(|deviations| deviations.reverse());
    }

    /// The points in order.
    #[must_use]
    pub fn points(&self) -> &[Point2<f64>] {
        &self.points
    }
}

/// What is seen of a partly hidden contour: one or more open arcs, all running the same way round, in the order in which
/// the contour passes through them; not all on one line.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Vec<OpenArc>", into = "Vec<OpenArc>"))]
pub struct OpenOutline {
    arcs: Vec<OpenArc>,
}

impl OpenOutline {
    /// Takes over arcs that may each run either way round, and turns them the same way: each takes the direction that
    /// makes the gaps between the end of every arc and the beginning of the next, and from the last to the first,
    /// shortest in total. For arcs of a convex contour that is how it passes through them; of one with deep bays, a gap
    /// across a bay can be shorter than the true one, so use [`in_sequence`](Self::in_sequence) where the directions are
    /// known.
    ///
    /// The arcs are to be listed in their order along the contour, either way round; for up to three, every order is that.
    ///
    /// # Errors
    /// As [`in_sequence`](Self::in_sequence).
    pub fn new(mut arcs: Vec<OpenArc>) -> Result<Self, OutlineError> {
        turn_the_same_way(&mut arcs);
        Self::in_sequence(arcs)
    }

    /// Takes over arcs that are known to run the same way round, as they are.
    ///
    /// # Errors
    /// No arc, all points on one line, standard deviations of the points of some arcs only.
    pub fn in_sequence(arcs: Vec<OpenArc>) -> Result<Self, OutlineError> {
        if arcs.is_empty() {
            return Err(OutlineError::NoArc);
        }
        check_not_collinear(arcs.iter().flat_map(|arc| &arc.points))?;
        let found: usize = arcs.iter().flat_map(OpenArc::deviations).map(<[_]>::len).sum();
        let points = arcs.iter().map(|arc| arc.points.len()).sum();
        if found != 0 && found != points {
            return Err(OutlineError::DeviationCount { found, points });
        }
        Ok(Self { arcs })
    }

    /// This outline with standard deviations of its points; see [`Outline::with_deviations`](crate::Outline::with_deviations).
    ///
    /// # Errors
    /// Not one for each point, or one that is not a positive finite number.
    pub fn with_deviations(self, deviations: Vec<f64>) -> Result<Self, OutlineError> {
        check_deviations(&deviations, self.arcs.iter().map(|arc| arc.points.len()).sum())?;
        let mut rest = deviations.into_iter();
        let mut take =
            |arc: OpenArc| OpenArc { deviations: Some(rest.by_ref().take(arc.points.len()).collect()), ..arc };
        Ok(Self { arcs: self.arcs.into_iter().map(&mut take).collect() })
    }

    /// Whether the points have standard deviations: those of all arcs, or none.
    pub(crate) fn has_deviations(&self) -> bool {
        self.arcs[0].deviations.is_some()
    }

    /// The arcs in order.
    #[must_use]
    pub fn arcs(&self) -> &[OpenArc] {
        &self.arcs
    }
}

#[cfg(feature = "serde")]
type WrittenArc = (Vec<Point2<f64>>, Option<Vec<f64>>);

#[cfg(feature = "serde")]
impl TryFrom<WrittenArc> for OpenArc {
    type Error = OutlineError;

    fn try_from((points, deviations): WrittenArc) -> Result<Self, OutlineError> {
        let arc = Self::new(points)?;
        match deviations {
            Some(deviations) => arc.with_deviations(deviations),
            None => Ok(arc),
        }
    }
}

#[cfg(feature = "serde")]
impl From<OpenArc> for WrittenArc {
    fn from(arc: OpenArc) -> Self {
        (arc.points, arc.deviations)
    }
}

impl TryFrom<Vec<OpenArc>> for OpenOutline {
    type Error = OutlineError;

    fn try_from(arcs: Vec<OpenArc>) -> Result<Self, OutlineError> {
        Self::in_sequence(arcs)
    }
}

impl From<OpenOutline> for Vec<OpenArc> {
    fn from(outline: OpenOutline) -> Self {
        outline.arcs
    }
}

/// Reverses arcs so that the gaps from each to the next, and from the last to the first, are shortest in total. Of equal
/// totals, that with more of the arcs as they are counts, the first above all.
fn turn_the_same_way(arcs: &mut [OpenArc]) {
    if arcs.len() < 2 {
        return;
    }
    let [as_it_is, reversed] = [false, true].map(|first| shortest_joining(arcs, first));
    let (_, directions) = if reversed.0 < as_it_is.0 { reversed } else { as_it_is };
    arcs.iter_mut().zip(directions).filter(|(_, reverse)| *reverse).for_each(|(arc, _)| arc.reverse());
}

/// Total length of the gaps and which arcs to reverse, for one direction of the first arc.
fn shortest_joining(arcs: &[OpenArc], reverse_first: bool) -> (f64, Vec<bool>) {
    // Both ways through an arc, as it is and reversed: where it begins and where it ends.
    let ways = |arc: &OpenArc| {
        let (begin, end) = (arc.points[0], arc.points[arc.points.len() - 1]);
        [(begin, end), (end, begin)]
    };
    let (start, first_end) = ways(&arcs[0])[usize::from(reverse_first)];
    // Shortest totals up to each way through the arc before, and where it ends.
    let mut reached = [(0.0, first_end); 2];
    // Which way through the arc before belongs to each way through an arc.
    let mut choices: Vec<[usize; 2]> = Vec::with_capacity(arcs.len());
    for arc in &arcs[1..] {
        let mut choice = [0; 2];
        let mut next = reached;
        for (way, (begin, end)) in ways(arc).into_iter().enumerate() {
            let via = reached.map(|(total, from)| total + (begin - from).norm());
            choice[way] = usize::from(via[1] < via[0]);
            next[way] = (via[choice[way]], end);
        }
        choices.push(choice);
        reached = next;
    }
    let closed = reached.map(|(total, from)| total + (start - from).norm());
    let mut way = usize::from(closed[1] < closed[0]);
    let total = closed[way];
    let mut directions = vec![reverse_first; arcs.len()];
    for (direction, choice) in directions.iter_mut().skip(1).zip(&choices).rev() {
        *direction = way == 1;
        way = choice[way];
    }
    (total, directions)
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;

    use super::*;
    use crate::Outline;
    use crate::points::points;

    #[test]
    fn points_on_one_line_up_to_rounding_are_refused_in_whole_and_in_arcs() {
        for turn in 0..50 {
            let (sin, cos) = (0.13 * f64::from(turn)).sin_cos();
            let offset = f64::from(turn * turn);
            let at = |k: i32| (offset + cos * f64::from(k) / 7.0, sin * f64::from(k) / 7.0 - 3.0 * offset);
            let line: Vec<_> = (0..60).map(at).collect();
            assert_eq!(Outline::closed(points(&line)), Err(OutlineError::Collinear { count: 60 }));
            let arcs = || line.chunks(20).map(|part| OpenArc::new(points(part)).expect("an arc")).collect::<Vec<_>>();
            assert_eq!(OpenOutline::new(arcs()), Err(OutlineError::Collinear { count: 60 }));
            assert_eq!(OpenOutline::in_sequence(arcs()), Err(OutlineError::Collinear { count: 60 }));
            // Straight arcs that are not in line with each other do make an outline.
            let mut bent = arcs();
            bent[1].points.iter_mut().for_each(|p| *p += 0.1 * Vector2::new(-sin, cos));
            assert!(OpenOutline::new(bent).is_ok());
        }
    }

    #[test]
    fn arcs_of_a_contour_run_the_same_way_however_each_was_given() {
        // Seven arcs of an ellipse, with gaps of different lengths.
        let at = |k: u32| (3.0 * (0.01 * f64::from(k)).cos(), (0.01 * f64::from(k)).sin());
        let bounds = [(0, 40), (60, 90), (100, 230), (240, 250), (300, 330), (420, 480), (500, 610)];
        let arcs = bounds.map(|(from, to)| points(&(from..to).map(at).collect::<Vec<_>>()));
        for reversed in 0..1_u32 << arcs.len() {
            let mut given = arcs.clone();
            given.iter_mut().enumerate().filter(|(i, _)| reversed >> i & 1 == 1).for_each(|(_, arc)| arc.reverse());
            let given: Vec<_> = given.into_iter().map(|arc| OpenArc::new(arc).expect("an arc")).collect();
            let outline = OpenOutline::new(given.clone()).expect("arcs");
            assert!(outline.arcs().iter().zip(&arcs).all(|(arc, original)| arc.points() == original));
            // Listed the other way round, they run the other way round.
            let backwards = OpenOutline::new(given.iter().rev().cloned().collect()).expect("arcs");
            for (arc, original) in backwards.arcs().iter().zip(arcs.iter().rev()) {
                assert!(arc.points().iter().rev().eq(original));
            }
            // Two arcs have no order: the first stays as it is.
            let two = OpenOutline::new(given[..2].to_vec()).expect("arcs");
            let same = |i: usize| two.arcs()[i].points() == arcs[i];
            assert!(two.arcs()[0] == given[0] && same(0) == same(1));
            // What has been turned once stays.
            assert_eq!(OpenOutline::new(outline.arcs().to_vec()).as_ref(), Ok(&outline));
        }
    }
}
