//! Objects that touch others, and what becomes of their names.
use nalgebra::Point2;

use crate::identity::identities::PATIENCE;

/// Farthest that an object may be, in diameters of both together, from where another was forgotten or is hidden: so that no third one has room
/// between them. What is farther away has come from elsewhere, or has gone there unseen, which nobody could tell.
const REACH: f64 = 1.0;

/// Frames after the last contact in which something new may still be an object that was forgotten and is in no other: it is looked for by its name in
/// half of them, which may begin with the contact, and then for as long again.
const MEMORY: u64 = 2 * PATIENCE;

/// Forgotten objects and pairs that are kept: of more than a user will look at, the first pairs and the objects seen last.
const MOST_KEPT: usize = 100;

/// An object that was seen after another one had been forgotten while it touched a third, near it and soon after: it may be that one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AfterContact {
    /// Number of the picture that shows it first.
    pub frame: u64,
    /// Its name.
    pub name: u64,
    /// Name of the one that was forgotten.
    pub forgotten: u64,
}

/// Where something was seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Place {
    pub(crate) frame: u64,
    pub(crate) centre: Point2<f64>,
    /// Diameter of a disc around it.
    pub(crate) diameter: f64,
}

impl Place {
    /// Whether what is seen there may be what was seen here.
    fn may_lead_to(&self, other: &Self) -> bool {
        other.frame.saturating_sub(self.frame) <= MEMORY
            && (other.centre - self.centre).norm() <= REACH * (self.diameter + other.diameter)
    }
}

/// What is known of an object that has touched others.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Whereabouts {
    /// It is in a joint object, and keeps its name if it is seen again.
    Touching,
    /// Its name is forgotten.
    Forgotten,
    /// It may be the object of this name, by itself or with what it touched.
    MayBe(u64),
    /// It may be one of several.
    MayBeOneOfMany,
}

/// An object that has touched others.
#[derive(Debug, Clone, Copy)]
struct Hidden {
    name: u64,
    whereabouts: Whereabouts,
    place: Place,
}

/// The objects that touch others, and what became of those that were forgotten so.
#[derive(Debug, Default)]
pub(crate) struct Contacts {
    hidden: Vec<Hidden>,
    after: Vec<AfterContact>,
}

impl Contacts {
    /// An object that is not seen by itself, as it touches others: where they are together.
    pub(crate) fn touch(&mut self, name: u64, place: Place) {
        let touching = Hidden { name, whereabouts: Whereabouts::Touching, place };
        match self.hidden.iter_mut().find(|hidden| hidden.is_touching(name)) {
            Some(known) => *known = touching,
            None => self.hidden.push(touching),
        }
    }

    /// An object is seen by itself.
    pub(crate) fn see(&mut self, name: u64, place: Place) {
        self.hidden.retain(|hidden| !hidden.is_touching(name));
        for hidden in self.hidden.iter_mut().filter(|hidden| hidden.whereabouts == Whereabouts::MayBe(name)) {
            hidden.place = place;
        }
    }

    /// An object is forgotten.
    pub(crate) fn forget(&mut self, name: u64) {
        let touching = self.hidden.iter_mut().filter(|hidden| hidden.is_touching(name));
        touching.for_each(|hidden| hidden.whereabouts = Whereabouts::Forgotten);
        // Those that touch others are no more than are known, and are touched again in the next picture.
        let is_forgotten = |hidden: &&Hidden| hidden.whereabouts != Whereabouts::Touching;
        if self.hidden.iter().filter(is_forgotten).count() > MOST_KEPT {
            let oldest = self.hidden.iter().filter(is_forgotten).min_by_key(|hidden| hidden.place.frame);
            let oldest = oldest.map(|hidden| hidden.name);
            self.hidden.retain(|hidden| hidden.whereabouts == Whereabouts::Touching || Some(hidden.name) != oldest);
        }
    }

    /// A picture shows an object that has no name yet, and gets this one.
    pub(crate) fn name(&mut self, name: u64, place: Place) {
        for hidden in self.hidden.iter_mut().filter(|hidden| hidden.place.may_lead_to(&place)) {
            hidden.whereabouts = match hidden.whereabouts {
                Whereabouts::Touching => continue,
                Whereabouts::Forgotten => {
                    hidden.place = place;
                    Whereabouts::MayBe(name)
                }
                Whereabouts::MayBe(_) | Whereabouts::MayBeOneOfMany => Whereabouts::MayBeOneOfMany,
            };
            if self.after.len() < MOST_KEPT {
                self.after.push(AfterContact { frame: place.frame, name, forgotten: hidden.name });
            }
        }
        self.hidden.retain(|hidden| {
            hidden.whereabouts == Whereabouts::Touching || place.frame.saturating_sub(hidden.place.frame) <= MEMORY
        });
    }

    /// The new objects that may be forgotten ones, in the order of their pictures: the first of them, if they are very many.
    pub(crate) fn after(&self) -> &[AfterContact] {
        &self.after
    }
}

impl Hidden {
    fn is_touching(&self, name: u64) -> bool {
        self.name == name && self.whereabouts == Whereabouts::Touching
    }
}

#[cfg(test)]
mod tests {
    use std::ops::Range;

    use super::*;

    fn at(frame: u64, x: f64) -> Place {
        Place { frame, centre: Point2::new(x, 0.0), diameter: 10.0 }
    }

    /// Names of the new objects and of those that they may be.
    fn pairs(contacts: &Contacts) -> Vec<(u64, u64)> {
        contacts.after().iter().map(|after| (after.name, after.forgotten)).collect()
    }

    /// Objects of these names touch in frames 0 to 9.
    fn touching(names: Range<u64>) -> Contacts {
        let mut contacts = Contacts::default();
        (0..10).for_each(|frame| names.clone().for_each(|name| contacts.touch(name, at(frame, 0.0))));
        contacts
    }

    /// Two objects touch in frames 0 to 9, and are forgotten.
    fn two_forgotten() -> Contacts {
        let mut contacts = touching(0..2);
        [0, 1].into_iter().for_each(|name| contacts.forget(name));
        contacts
    }

    #[test]
    fn only_what_was_forgotten_while_it_touched_another_may_be_what_is_new() {
        let mut contacts = Contacts::default();
        [0, 1].into_iter().for_each(|name| contacts.touch(name, at(0, 0.0)));
        // It is seen by itself again, and leaves later; another one was never touched.
        contacts.see(1, at(1, 0.0));
        [1, 2].into_iter().for_each(|name| contacts.forget(name));
        contacts.name(3, at(8, 0.0));
        assert_eq!(contacts.after(), []);
        contacts.forget(0);
        contacts.name(4, at(9, 0.0));
        assert_eq!(contacts.after(), [AfterContact { frame: 9, name: 4, forgotten: 0 }]);
    }

    #[test]
    fn all_pairs_of_new_and_forgotten_objects_are_told() {
        let mut contacts = two_forgotten();
        // Both together, and one of them when they part, much later and elsewhere.
        contacts.name(2, at(10, 0.0));
        (11..200).for_each(|frame| contacts.see(2, at(frame, frame as f64)));
        contacts.name(3, at(200, 205.0));
        assert_eq!(pairs(&contacts), [(2, 0), (2, 1), (3, 0), (3, 1)]);
        // By then all are known again.
        (201..300).for_each(|frame| contacts.see(2, at(frame, 200.0)));
        contacts.name(4, at(300, 200.0));
        assert_eq!(pairs(&contacts).len(), 4);
    }

    #[test]
    fn a_forgotten_object_among_150_that_go_on_touching_is_told() {
        for forgotten in [0, 75, 149] {
            let mut contacts = touching(0..150);
            contacts.forget(forgotten);
            for frame in 10..15 {
                (0..150).filter(|name| *name != forgotten).for_each(|name| contacts.touch(name, at(frame, 0.0)));
            }
            contacts.name(150, at(15, 0.0));
            assert_eq!(pairs(&contacts), [(150, forgotten)]);
        }
    }

    #[test]
    fn of_very_many_forgotten_objects_those_seen_last_are_told() {
        let mut contacts = touching(0..150);
        // The first of them are seen for one frame more.
        (0..50).for_each(|name| contacts.touch(name, at(10, 0.0)));
        (0..150).for_each(|name| contacts.forget(name));
        contacts.name(150, at(15, 0.0));
        let told: Vec<u64> = pairs(&contacts).into_iter().map(|(_, forgotten)| forgotten).collect();
        let expected: Vec<u64> = (0..50).chain(100..150).collect();
        assert_eq!(told, expected);
    }

    #[test]
    fn what_is_new_far_away_or_long_after_is_not_what_was_forgotten() {
        for (frame, x, may_be) in [(12, 15.0, true), (12, 25.0, false), (39, 0.0, true), (40, 0.0, false)] {
            let mut contacts = two_forgotten();
            contacts.name(7, at(frame, x));
            assert_eq!(!contacts.after().is_empty(), may_be, "{frame} {x}");
        }
    }
}
