//! Names of objects, kept from picture to picture.
use freeform_curve_fit::Rectangle;
use nalgebra::{Point2, Vector2};

use crate::identity::assignment::assign;
use crate::identity::common_step::{Assignment, Spot, TwoPictures};
use crate::identity::contacts::{AfterContact, Contacts, Place};
use crate::identity::known_object::{Known, LARGEST_COST};
use crate::picture_file::error::TraceError;
use crate::tracing::trace::TracedOutline;

/// Most frames that an object may be missing in before it is forgotten.
pub(crate) const PATIENCE: u64 = 15;

/// Where things beside it move, what is cut by the border stays if it is within so many diameters of where it was.
const STAYS: f64 = 0.1;

/// Steps of objects alike that are told.
const MOST_DOUBTS: usize = 16;

/// Which objects of a picture are taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Selection {
    /// The largest of each picture; of those in rings the clearest.
    #[default]
    Largest,
    /// The largest of the first picture, then the one nearest to where that is expected.
    Nearest,
    /// All, each with a name that it keeps: its place, predicted from its velocity, its area and the affine moment
    /// invariants of its shape tell it in the next frame, so that all objects together fit best. Where objects touch and
    /// are one in the picture, that one is left out; after more than 15 frames they are forgotten, and the joint object counts
    /// as a new one.
    All,
    /// Of these those that move: each from the picture on in which it has left its place, by more than its own size and straight on in the last
    /// three. What rests, and what comes and goes where light or noise change the picture, is hardly ever taken.
    Moving,
}

/// Most objects of a picture that are followed.
pub(crate) const OBJECT_LIMIT: usize = 256;

impl Place {
    fn of(frame: u64, traced: &TracedOutline) -> Self {
        Self { frame, centre: traced.centre, diameter: traced.outline.bounding_box().size().norm() }
    }
}

/// Follows objects from picture to picture: gives those of each picture the names that they had before, as [`Selection`] says.
#[derive(Debug)]
pub struct Identities {
    selection: Selection,
    known: Vec<Known>,
    next_name: u64,
    contacts: Contacts,
    among_alike: Vec<AmongAlike>,
    /// What the pictures show of the plane, where that is known.
    extent: Option<Rectangle>,
}

/// A step that objects which look alike have made together, and that may as well have been another, as if each were a neighbour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AmongAlike {
    /// Number of the picture after the step.
    pub frame: u64,
    /// The step taken, from the picture before to it, in the unit of the outlines.
    pub step: Vector2<f64>,
    /// The other one, less than twice as large.
    pub other: Vector2<f64>,
}

impl Identities {
    /// Before the first picture.
    #[must_use]
    pub fn new(selection: Selection) -> Self {
        let (known, contacts, among_alike) = (Vec::new(), Contacts::default(), Vec::new());
        Self { selection, known, next_name: 0, contacts, among_alike, extent: None }
    }

    /// Says what the pictures show of the plane, in the unit of the outlines. What leaves it is not missed, and what enters it was not to be seen
    /// before; of pictures of which that is not said, all is.
    pub fn set_extent(&mut self, extent: Rectangle) {
        self.extent = Some(extent);
    }

    /// The objects so far that may be others which were forgotten while they touched something, near them and soon after, in the order of their
    /// pictures; of very many the first hundred.
    #[must_use]
    pub fn after_contact(&self) -> &[AfterContact] {
        self.contacts.after()
    }

    /// Steps so far that objects alike may have made otherwise, the first sixteen.
    #[must_use]
    pub fn among_alike(&self) -> &[AmongAlike] {
        &self.among_alike
    }

    /// How many objects of a picture are needed.
    pub(crate) fn limit(&self) -> usize {
        if self.selection == Selection::Largest { 1 } else { OBJECT_LIMIT }
    }

    /// Names the objects of a picture, the most important of which comes first. Frames must increase.
    ///
    /// # Errors
    /// No object is where the one followed should be; all objects touch others; no object at all where one is needed; of
    /// [`Selection::Moving`], none that has left its place.
    pub fn assign(&mut self, frame: u64, traced: Vec<TracedOutline>) -> Result<Vec<(u64, TracedOutline)>, TraceError> {
        let is_remembered = |known: &Known| frame.saturating_sub(known.frame) <= PATIENCE + 1;
        self.known.iter().filter(|known| !is_remembered(known)).for_each(|known| self.contacts.forget(known.name));
        self.known.retain(is_remembered);
        match self.selection {
            Selection::Largest => Ok(traced.into_iter().take(1).map(|traced| (0, traced)).collect()),
            Selection::Nearest => self.nearest(frame, traced).map(|found| vec![(0, found)]),
            Selection::All | Selection::Moving => {
                let (traced, touching) = self.without_touching(frame, traced);
                let mut named = self.all(frame, traced);
                if self.selection == Selection::Moving {
                    named.retain(|(name, _)| self.known.iter().any(|known| known.name == *name && known.has_left));
                }
                match touching {
                    Some(objects) if named.is_empty() => Err(TraceError::Touching { objects }),
                    None if named.is_empty() && self.selection == Selection::Moving => Err(TraceError::NothingMoved),
                    _ => Ok(named),
                }
            }
        }
    }

    /// Puts an object where it is expected in a frame in which it was not traced.
    pub(crate) fn keep(&mut self, name: u64, frame: u64) {
        for known in self.known.iter_mut().filter(|known| known.name == name && known.frame < frame) {
            (known.centre, known.frame) = (known.expected(frame), frame);
        }
    }

    fn nearest(&mut self, frame: u64, traced: Vec<TracedOutline>) -> Result<TracedOutline, TraceError> {
        let Some(known) = self.known.first_mut() else {
            let first = traced.into_iter().next().ok_or(TraceError::NoPixels)?;
            self.known.push(Known::seen(0, frame, &first));
            return Ok(first);
        };
        let costs = traced.iter().map(|traced| known.cost(frame, traced));
        let best = costs.enumerate().filter_map(|(index, cost)| Some((index, cost?)));
        let Some((index, _)) = best.min_by(|a, b| a.1.total_cmp(&b.1)) else {
            let differences = traced.iter().map(|traced| known.difference(frame, traced));
            let nearest = differences.min_by(|a, b| a.distance.total_cmp(&b.distance)).ok_or(TraceError::NoPixels)?;
            return Err(match nearest.growth {
                Some(growth) if nearest.is_near() => TraceError::OtherSize { ratio: growth.exp() },
                _ => TraceError::NotNear { distance: nearest.distance },
            });
        };
        known.see(frame, &traced[index]);
        traced.into_iter().nth(index).ok_or(TraceError::NoPixels)
    }

    /// What is seen without what several objects are in at once, and how many they are, if any.
    fn without_touching(&mut self, frame: u64, mut traced: Vec<TracedOutline>) -> (Vec<TracedOutline>, Option<usize>) {
        let fits = |known: &Known, traced: &TracedOutline| {
            let difference = known.difference(frame, traced);
            difference.is_near() && difference.is_of_one()
        };
        let apart = |known: &&Known| !traced.iter().any(|traced| fits(known, traced));
        let unseen: Vec<(u64, Point2<f64>)> =
            self.known.iter().filter(apart).map(|known| (known.name, known.expected(frame))).collect();
        let mut touching = None;
        traced.retain(|traced| {
            let around = traced.outline.bounding_box();
            let within = || unseen.iter().filter(|(_, place)| around.contains(place));
            let count = within().count();
            touching = touching.or((count > 1).then_some(count));
            if count > 1 {
                let place = Place { frame, centre: around.centre(), diameter: around.size().norm() };
                within().for_each(|(name, _)| self.contacts.touch(*name, place));
            }
            count < 2
        });
        (traced, touching)
    }

    /// Assigns what has been seen once and looks alike so that it makes one step together, where that leaves less over than to take each for what is
    /// nearest: of parts on a belt the nearest one is the neighbour once they move by more than half of their distance.
    fn assign_together(&mut self, frame: u64, traced: &[TracedOutline], seen_as: &mut [Option<usize>]) {
        let is_new = |known: &Known| known.velocity.is_none() && known.frame + 1 == frame && !known.clipped;
        let mut before: Vec<usize> = (0..self.known.len()).filter(|known| is_new(&self.known[*known])).collect();
        let is_open =
            |seen: &usize| seen_as.iter().position(|of| *of == Some(*seen)).is_none_or(|of| before.contains(&of));
        let mut now: Vec<usize> =
            (0..traced.len()).filter(|seen| !traced[*seen].touches_border).filter(is_open).collect();
        let by_themselves = seen_as.to_vec();
        let (mut are_all, mut common) = (true, None);
        while !before.is_empty() && now.len() > 1 {
            let spots = [
                before.iter().map(|known| self.known[*known].spot()).collect(),
                now.iter().map(|seen| Spot::of(&traced[*seen])).collect(),
            ];
            let is_alike = |from: usize, to: usize| self.known[before[from]].may_be_alike(&traced[now[to]]);
            let two = TwoPictures::new(spots, is_alike, self.extent);
            let place = |seen: usize| now.iter().position(|of| *of == seen);
            let found = before.iter().enumerate().filter_map(|(from, known)| Some((from, place(seen_as[*known]?)?)));
            let one_by_one = two.one_by_one(found.collect());
            let together = two.better_than(&one_by_one);
            let taken = together.as_ref().unwrap_or(&one_by_one);
            if let Some(shared) = two.shared(taken) {
                let doubt = two.rival_of(&shared, taken).map(|other| AmongAlike { frame, step: shared.step, other });
                self.among_alike.extend(doubt.filter(|_| self.among_alike.len() < MOST_DOUBTS));
                common = common.or_else(|| are_all.then_some(shared.step));
            }
            if let Some(Assignment { pairs, .. }) = &together {
                before.iter().for_each(|known| seen_as[*known] = None);
                pairs.iter().for_each(|(from, to)| seen_as[before[*from]] = Some(now[*to]));
            } else if !are_all {
                break;
            }
            are_all = false;
            before.retain(|known| seen_as[*known].is_none());
            now.retain(|seen| !seen_as.contains(&Some(*seen)));
        }
        // What does not make the step is what it was by itself, where nothing else is that now.
        for known in before {
            let seen = by_themselves[known].filter(|seen| !seen_as.contains(&Some(*seen)));
            seen_as[known] = seen_as[known].or(seen);
        }
        if let Some(step) = common {
            self.assign_cut(frame, traced, seen_as, step);
        }
    }

    /// Assigns what has been seen once and is cut by the border in one of two pictures, where things that are whole have made a step together: so
    /// that it makes the step too, or stays where it is.
    fn assign_cut(&self, frame: u64, traced: &[TracedOutline], seen_as: &mut [Option<usize>], step: Vector2<f64>) {
        let is_cut = |known: &usize| {
            let Known { velocity, clipped, frame: last, .. } = &self.known[*known];
            let is_new = velocity.is_none() && last + 1 == frame;
            is_new && (*clipped || seen_as[*known].is_none_or(|seen| traced[seen].touches_border))
        };
        let cut: Vec<usize> = (0..seen_as.len()).filter(is_cut).collect();
        cut.iter().for_each(|known| seen_as[*known] = None);
        let seen: Vec<usize> = (0..traced.len()).filter(|seen| !seen_as.contains(&Some(*seen))).collect();
        let led: Vec<Known> = cut.iter().map(|known| self.known[*known].moving(step)).collect();
        let cost = |k: usize, to: usize| {
            let (known, traced) = (&self.known[cut[k]], &traced[seen[to]]);
            // What is whole in both pictures has been looked at.
            if !known.clipped && !traced.touches_border {
                return None;
            }
            let stays = known.difference(frame, traced).distance < STAYS;
            let ways = [Some(&led[k]), stays.then_some(known)].into_iter().flatten();
            ways.filter_map(|known| known.cost(frame, traced)).min_by(f64::total_cmp)
        };
        let found = assign([cut.len(), seen.len()], cost, LARGEST_COST);
        cut.iter().zip(found).for_each(|(known, found)| seen_as[*known] = found.map(|to| seen[to]));
    }

    /// What has been seen once, cut by the border, as it would be if it moved as the nearest thing does that has been seen more often.
    fn led_by_neighbours(&self, frame: u64) -> Vec<Option<Known>> {
        let is_followed = |known: &&Known| known.velocity.is_some() && known.frame + 1 == frame;
        let led = |known: &Known| {
            if known.velocity.is_some() || !known.clipped {
                return None;
            }
            let far = |other: &&Known| (other.centre - known.centre).norm();
            let nearest = self.known.iter().filter(is_followed).min_by(|a, b| far(a).total_cmp(&far(b)))?;
            nearest.velocity.map(|velocity| known.moving(velocity))
        };
        self.known.iter().map(led).collect()
    }

    /// Assigns what is left over on both sides, which may be what moves by more than its own size.
    fn assign_far(&self, frame: u64, traced: &[TracedOutline], seen_as: &mut [Option<usize>]) {
        let known: Vec<usize> = (0..seen_as.len()).filter(|known| seen_as[*known].is_none()).collect();
        let seen: Vec<usize> = (0..traced.len()).filter(|seen| !seen_as.contains(&Some(*seen))).collect();
        let cost_of = |k: usize, s: usize| self.known[known[k]].cost_of_far(frame, &traced[seen[s]]);
        let costs: Vec<Vec<_>> = (0..known.len()).map(|k| (0..seen.len()).map(|s| cost_of(k, s)).collect()).collect();
        let of_known: Vec<usize> = costs.iter().map(|costs| costs.iter().flatten().count()).collect();
        let in_column = |s: usize| costs.iter().filter(|costs| costs[s].is_some()).count();
        let of_seen: Vec<usize> = (0..seen.len()).map(in_column).collect();
        // So far from a first sighting, only that nothing else is like it tells that it is the same.
        let may_be =
            |k: usize, s: usize| self.known[known[k]].velocity.is_some() || of_known[k] == 1 && of_seen[s] == 1;
        let cost = |k: usize, s: usize| costs[k][s].filter(|_| may_be(k, s));
        for (k, found) in assign([known.len(), seen.len()], cost, LARGEST_COST).into_iter().enumerate() {
            seen_as[known[k]] = found.map(|s| seen[s]);
        }
    }

    fn all(&mut self, frame: u64, traced: Vec<TracedOutline>) -> Vec<(u64, TracedOutline)> {
        let led = self.led_by_neighbours(frame);
        let cost = |known: usize, seen: usize| {
            let (by_itself, led) = (&self.known[known], &led[known]);
            // What the border cuts and is not seen again at once has gone on with the others.
            let has_left = led.is_some() && by_itself.frame + 1 < frame;
            let ways = [led.as_ref(), (!has_left).then_some(by_itself)].into_iter().flatten();
            ways.filter_map(|known| known.cost(frame, &traced[seen])).min_by(f64::total_cmp)
        };
        let mut seen_as = assign([self.known.len(), traced.len()], cost, LARGEST_COST);
        self.assign_together(frame, &traced, &mut seen_as);
        self.assign_far(frame, &traced, &mut seen_as);
        let mut names = vec![None; traced.len()];
        for (known, seen) in self.known.iter_mut().zip(seen_as) {
            if let Some(seen) = seen {
                names[seen] = Some(known.name);
                self.contacts.see(known.name, Place::of(frame, &traced[seen]));
                known.see(frame, &traced[seen]);
            }
        }
        let named = traced.into_iter().zip(names).map(|(traced, name)| {
            let name = name.unwrap_or_else(|| {
                let name = self.next_name;
                self.next_name += 1;
                self.contacts.name(name, Place::of(frame, &traced));
                self.known.push(Known::seen(name, frame, &traced));
                name
            });
            (name, traced)
        });
        let mut named: Vec<_> = named.collect();
        named.sort_by_key(|(name, _)| *name);
        named
    }
}
