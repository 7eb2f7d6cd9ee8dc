//! What there is beside a thing that may move.
use nalgebra::{Point2, Vector2};

use super::chains::Chain;
use super::sight::Sight;
use super::tuning::beside as tuning;
use super::turning::Reach;
use crate::identity::affine_moment_invariants::is_within;
use crate::identity::known_object::LEFT;

/// What is seen to change besides what is traced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Changes {
    /// Pictures in which something changes elsewhere.
    pub(super) seen: usize,
    /// Pictures looked at.
    pub(super) pictures: usize,
}

impl Changes {
    /// Whether it is seen in half of the pictures, and in more than a few.
    pub(super) fn are_most(self) -> bool {
        self.seen >= tuning::FEWEST_OF_MOST && 2 * self.seen >= self.pictures
    }

    /// Whether it is seen often enough to be no speck of noise.
    pub(super) fn are_many(self) -> bool {
        self.seen > 2 && tuning::CHANGES_OFTEN * self.seen >= self.pictures
    }
}

/// What else there is.
pub(super) struct Beside {
    /// What rests.
    pub(super) still: Option<Sight>,
    /// Picture for picture.
    pub(super) others: Option<Vec<Vec<Sight>>>,
}

impl Beside {
    /// Whether a thing is a part of what is known already, or changes with that.
    pub(super) fn has(&self, chain: &Chain) -> bool {
        let is_part = |other: &Sight| is_part_of(&chain[1], other) && !self.stands(other, chain);
        self.still.as_ref().is_some_and(|still| lies_on(&chain[1], still))
            || self.others_of(chain[1].frame).any(is_part)
    }

    /// Whether a thing goes around the middle of another, within its outline: then it is a part of that.
    pub(super) fn turns_with(&self, group: &[&Chain]) -> bool {
        let mut around =
            self.still.iter().chain(group.first().into_iter().flat_map(|chain| self.others_of(chain[1].frame)));
        around.any(|other| turns_with(group, other))
    }

    fn others_of(&self, frame: u64) -> impl Iterator<Item = &Sight> {
        self.others.iter().flatten().flatten().filter(move |sight| sight.frame == frame)
    }

    /// Whether another thing stands still while this one moves, which then is no part of it. The outline of a wheel hardly moves as it turns, but
    /// does not stand still: its teeth are parts of it, and look as if they went anywhere, being alike.
    fn stands(&self, other: &Sight, [before, _, after]: &Chain) -> bool {
        let seen = |frame: u64| {
            let far = |sight: &&Sight| (sight.centre - other.centre).norm();
            self.others_of(frame).min_by(|a, b| far(a).total_cmp(&far(b)))
        };
        let way = (after.centre - before.centre).norm();
        let moved = |(a, b): (&Sight, &Sight)| (a.centre - b.centre).norm().max(a.unlike(b));
        let has_turned = |(first, last): (&Sight, &Sight)| {
            Reach::of(first).zip(Reach::of(last)).is_some_and(|(first, last)| first.has_turned_to(&last))
        };
        seen(before.frame)
            .zip(seen(after.frame))
            .is_some_and(|seen| moved(seen) < tuning::STANDS * way && !has_turned(seen))
    }
}

/// In how many pictures something differs from the ground beside the outline of what rests, that is not most of the picture, as light does. What
/// changes within the outline counts: it may be what moves on it.
pub(super) fn changes_beside(pictures: &[Vec<Sight>], still: &Sight, picture_area: f64) -> Changes {
    let is_beside = |sight: &Sight| !lies_on(sight, still) && sight.area < tuning::LARGEST_CHANGE * picture_area;
    let seen = pictures.iter().filter(|sights| sights.iter().any(is_beside)).count();
    Changes { seen, pictures: pictures.len() }
}

/// Whether a thing has its middle so near to that of another that it is the same one, or a part of it.
pub(super) fn lies_in_place_of(sight: &Sight, other: &Sight) -> bool {
    (sight.centre - other.centre).norm() < LEFT * other.size()
}

/// Whether a thing lies on another or in it.
pub(super) fn is_part_of(sight: &Sight, other: &Sight) -> bool {
    lies_on(sight, other) || surrounds(other, sight)
}

fn turns_with(group: &[&Chain], other: &Sight) -> bool {
    let radius = |chain: &Chain| (chain[1].centre - other.centre).norm();
    let Some(first) = group.first().map(|chain| radius(chain)) else { return false };
    let is_part = |chain: &&Chain| surrounds(other, &chain[1]) && (radius(chain) - first).abs() < 0.5 * chain[1].size();
    group.iter().all(is_part)
}

/// Whether the middle of a thing lies within the outline of another.
fn surrounds(other: &Sight, sight: &Sight) -> bool {
    is_within(&sight.centre, &other.points.iter().copied())
}

/// Whether a thing lies on the outline of another: what turns with it changes the picture there.
fn lies_on(sight: &Sight, other: &Sight) -> bool {
    let to = |point: &Point2<f64>| -> Vector2<f64> { point - sight.centre };
    other.points.iter().any(|point| to(point).norm() < sight.size())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::choice::sight::Inner;

    /// What is seen of a square of this half side.
    fn square(frame: u64, centre: [f64; 2], half: f64) -> Sight {
        let steps = 8 * half as usize;
        let along = |k: usize| half * (2.0 * k as f64 / steps as f64 - 1.0);
        let sides = |k: usize| [[along(k), -half], [half, along(k)], [-along(k), half], [-half, -along(k)]];
        let centre = Point2::from(centre);
        let points = (0..4).flat_map(|side| (0..steps).map(move |k| centre + Vector2::from(sides(k)[side]))).collect();
        let (area, contrast, objects) = (4.0 * half * half, 1.0, [1, 1]);
        let (invariants, is_clipped, inner, second) = (None, false, Inner::default(), 0.0);
        Sight { frame, centre, area, invariants, is_clipped, points, contrast, objects, inner, second }
    }

    fn small(along: impl Fn(f64) -> [f64; 2]) -> Chain {
        [0, 1, 2].map(|frame| square(frame, along(frame as f64), 3.0))
    }

    fn beside(large: impl Fn(f64) -> [f64; 2]) -> Beside {
        let pictures = (0..3).map(|frame| vec![square(frame, large(frame as f64), 40.0)]);
        Beside { still: None, others: Some(pictures.collect()) }
    }

    #[test]
    fn what_goes_on_within_something_is_a_part_of_it_where_that_goes_along_and_not_where_it_stands_still() {
        let mark = small(|time| [110.0 + 4.0 * time, 90.0]);
        assert!(!beside(|_| [100.0, 100.0]).has(&mark));
        assert!(beside(|time| [100.0 + 4.0 * time, 100.0]).has(&mark));
        // On its outline too.
        let across = small(|time| [136.0 + 4.0 * time, 90.0]);
        assert!(!beside(|_| [100.0, 100.0]).has(&across));
        assert!(beside(|time| [100.0 + 4.0 * time, 100.0]).has(&across));
    }

    #[test]
    fn a_mark_that_goes_around_the_middle_of_something_turns_with_it() {
        let beside = beside(|_| [100.0, 100.0]);
        let turning = |start: f64| {
            small(move |time| [100.0 + 20.0 * (start + 0.3 * time).cos(), 100.0 + 20.0 * (start + 0.3 * time).sin()])
        };
        assert!(beside.turns_with(&[&turning(0.0), &turning(2.0)]));
        let straight = |x: f64| small(move |time| [x + 4.0 * time, 105.0]);
        assert!(!beside.turns_with(&[&straight(70.0), &straight(110.0)]));
    }

    #[test]
    fn changes_within_what_rests_count_and_those_of_its_outline_do_not() {
        let still = square(0, [100.0, 100.0], 40.0);
        let seen = |place: [f64; 2]| {
            let pictures: Vec<Vec<Sight>> =
                (0..8).map(|frame| if frame % 2 == 0 { vec![square(frame, place, 3.0)] } else { vec![] }).collect();
            changes_beside(&pictures, &still, 76_800.0)
        };
        assert_eq!(seen([110.0, 95.0]), Changes { seen: 4, pictures: 8 });
        assert_eq!(seen([200.0, 95.0]).seen, 4);
        assert_eq!(seen([139.0, 95.0]).seen, 0);
    }
}
