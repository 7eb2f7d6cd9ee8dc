use nalgebra::{Point2, Vector2};

use crate::affine_moment_invariants::AffineMomentInvariants;
use crate::assignment::assign;
use crate::contacts::{AfterContact, Contacts, Place};
use crate::picture_error::TraceError;
use crate::trace::TracedOutline;

/// Most frames that an object may be missing in before it is forgotten.
pub(crate) const PATIENCE: u64 = 15;

/// Farthest that an object may be from where it is expected, in its diameters; half as much more for every frame missed.
const REACH: f64 = 1.0;

/// Farthest that an object that moves by more than its diameter may be from where it is expected, in its movement: twice that where it
/// turns back.
const REACH_OF_FAST: f64 = 2.2;

/// Farthest that an object may have moved between its first two sightings, in its diameters, where nothing else that is
/// like it is left over in reach in either of the two pictures.
const FIRST_REACH: f64 = 8.0;

/// An object has left its place where it is so many sizes (roots of its area) away from where it was seen first.
pub(crate) const LEFT: f64 = 1.0;

/// It moves straight on where its movement changes by no more than this share of itself, and this share of its size.
const STRAIGHT_ON: [f64; 2] = [0.5, 0.25];

/// Largest ratio of areas between sightings of what moves so far: a fast object is blurred.
const FIRST_GROWTH: f64 = 1.5;

/// Largest ratio of areas between sightings of one object of which neither is clipped.
const LARGEST_GROWTH: f64 = 2.0;

/// Ratio of areas up to which a sighting may be of one object alone where several are expected.
const LARGEST_GROWTH_OF_ONE: f64 = 1.25;

/// Distance of the affine moment invariants from which shapes are different. Between pictures of one object they change
/// less: by up to 0.08 for a robot of 16,000 pixels, by up to 0.21 for a thin bolt of 4,500 with a blurred edge.
const OTHER_SHAPE: f64 = 0.5;

/// The cost of a sighting at the farthest place, of the largest growth and of another shape.
const LARGEST_COST: f64 = 3.0;

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

/// An object as it was last seen.
#[derive(Debug, Clone)]
struct Known {
    name: u64,
    centre: Point2<f64>,
    /// Movement from frame to frame; `None` where it has been seen once.
    velocity: Option<Vector2<f64>>,
    /// How fast it moves, or half as fast as it moved before: where it turns back it may stand still for a moment.
    speed: f64,
    /// The area seen.
    area: f64,
    clipped: bool,
    /// As it was when it was last seen whole.
    shape: Option<AffineMomentInvariants>,
    frame: u64,
    /// Where it was seen first.
    first: Point2<f64>,
    has_left: bool,
}

/// How a sighting differs from an object.
#[derive(Debug, Clone, Copy)]
struct Difference {
    /// From the place expected, in diameters.
    distance: f64,
    /// `distance` over the largest accepted distance.
    place: f64,
    /// Logarithm of the ratio of areas; `None` where that tells nothing, as what is clipped has less than its area.
    growth: Option<f64>,
    /// Distance of the invariants; `None` where one of them is clipped.
    shape: Option<f64>,
    /// Whether neither is clipped.
    are_whole: bool,
}

impl Difference {
    fn is_near(&self) -> bool {
        self.place <= 1.0
    }

    fn is_alike(&self) -> bool {
        self.growth.is_none_or(|growth| growth.abs() <= LARGEST_GROWTH.ln())
    }

    /// Whether nothing but the object can be seen there.
    fn is_of_one(&self) -> bool {
        self.growth.is_none_or(|growth| growth.abs() <= LARGEST_GROWTH_OF_ONE.ln())
            && self.shape.is_none_or(|shape| shape <= OTHER_SHAPE)
    }

    /// How ill a sighting fits, up to [`LARGEST_COST`]; `None` where it cannot be the object. Another shape alone may be a
    /// failure of the segmentation, so that it counts no more than the farthest place.
    fn cost(&self) -> Option<f64> {
        let growth = self.growth.map_or(0.0, |growth| growth / LARGEST_GROWTH.ln());
        let shape = self.shape.map_or(0.0, |shape| (shape / OTHER_SHAPE).min(1.0));
        (self.is_near() && self.is_alike()).then_some(self.place.powi(2) + growth.powi(2) + shape.powi(2))
    }
}

impl Known {
    fn seen(name: u64, frame: u64, traced: &TracedOutline) -> Self {
        let (centre, area, clipped) = (traced.centre, traced.area, traced.touches_border);
        let shape = if clipped { None } else { traced.invariants };
        Self { name, centre, velocity: None, speed: 0.0, area, clipped, shape, frame, first: centre, has_left: false }
    }

    fn see(&mut self, frame: u64, traced: &TracedOutline) {
        let frames = frame.saturating_sub(self.frame).max(1) as f64;
        let velocity = (traced.centre - self.centre) / frames;
        let speed = velocity.norm().max(0.5 * self.speed);
        let size = traced.area.sqrt();
        let goes_on = self.velocity.is_some_and(|before| {
            let fastest = velocity.norm().max(before.norm());
            (velocity - before).norm() < STRAIGHT_ON[0] * fastest + STRAIGHT_ON[1] * size
        });
        // After a gap it is looked for so far away that something is found by chance.
        let follows = frame == self.frame + 1;
        let has_left = self.has_left || follows && goes_on && (traced.centre - self.first).norm() > LEFT * size;
        let now = Self::seen(self.name, frame, traced);
        let (velocity, shape) = (Some(velocity), now.shape.or(self.shape));
        *self = Self { velocity, speed, shape, first: self.first, has_left, ..now };
    }

    /// Where it should be.
    fn expected(&self, frame: u64) -> Point2<f64> {
        self.centre + self.velocity.unwrap_or_else(Vector2::zeros) * frame.saturating_sub(self.frame) as f64
    }

    /// The larger one of its diameter and that of a sighting, as if they were discs.
    fn diameter(&self, traced: &TracedOutline) -> f64 {
        (4.0 * self.area.max(traced.area) / std::f64::consts::PI).sqrt()
    }

    fn difference(&self, frame: u64, traced: &TracedOutline) -> Difference {
        let distance = (traced.centre - self.expected(frame)).norm() / self.diameter(traced);
        let missed = frame.saturating_sub(self.frame).saturating_sub(1) as f64;
        let growth = (traced.area / self.area).ln();
        // A part that is larger than the whole is of something else.
        let tells = match (self.clipped, traced.touches_border) {
            (false, false) => true,
            (true, false) => growth < 0.0,
            (false, true) => growth > 0.0,
            (true, true) => false,
        };
        let shape = self.shape.zip(traced.invariants).filter(|_| !traced.touches_border);
        Difference {
            distance,
            place: distance / (REACH * (1.0 + 0.5 * missed)),
            growth: tells.then_some(growth),
            shape: shape.map(|(known, seen)| known.distance(&seen)),
            are_whole: !self.clipped && !traced.touches_border,
        }
    }

    fn cost(&self, frame: u64, traced: &TracedOutline) -> Option<f64> {
        self.difference(frame, traced).cost()
    }

    /// The same of what was seen in the frame before, if it may be far from where it is expected: as it was seen for the first time then, or as
    /// it moves by more than its diameter and may turn back.
    fn cost_of_far(&self, frame: u64, traced: &TracedOutline) -> Option<f64> {
        let Difference { distance, growth: Some(growth), shape, are_whole: true, .. } = self.difference(frame, traced)
        else {
            return None;
        };
        let reach =
            if self.velocity.is_none() { FIRST_REACH } else { REACH_OF_FAST * self.speed / self.diameter(traced) };
        if reach < REACH_OF_FAST {
            return None;
        }
        let place = distance / reach;
        let growth = growth / FIRST_GROWTH.ln();
        let shape = shape.map_or(0.0, |shape| shape / OTHER_SHAPE);
        (self.frame + 1 == frame && place.max(growth.abs()).max(shape) <= 1.0)
            .then_some(place.powi(2) + growth.powi(2) + shape.powi(2))
    }
}

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
}

impl Identities {
    /// Before the first picture.
    #[must_use]
    pub fn new(selection: Selection) -> Self {
        Self { selection, known: Vec::new(), next_name: 0, contacts: Contacts::default() }
    }

    /// The objects so far that may be others which were forgotten while they touched something, near them and soon after, in the order of their
    /// pictures; of very many the first hundred.
    #[must_use]
    pub fn after_contact(&self) -> &[AfterContact] {
        self.contacts.after()
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
        let cost = |known: usize, seen: usize| self.known[known].cost(frame, &traced[seen]);
        let mut seen_as = assign([self.known.len(), traced.len()], cost, LARGEST_COST);
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
