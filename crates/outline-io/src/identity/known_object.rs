//! What is known of an object, and what it costs to take something that is seen for it.
use nalgebra::{Point2, Vector2};

use crate::identity::affine_moment_invariants::AffineMomentInvariants;
use crate::identity::common_step::Spot;
use crate::tracing::trace::TracedOutline;

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

/// The same up to which things that make one step together may be alike: of two small ones the edges of one may not be found, so that it is fatter
/// and rounder.
const MAY_BE_ALIKE: f64 = 1.0;

/// The cost of a sighting at the farthest place, of the largest growth and of another shape.
pub(crate) const LARGEST_COST: f64 = 3.0;

/// An object as it was last seen.
#[derive(Debug, Clone)]
pub(crate) struct Known {
    pub(crate) name: u64,
    pub(crate) centre: Point2<f64>,
    /// Movement from frame to frame; `None` where it has been seen once.
    pub(crate) velocity: Option<Vector2<f64>>,
    /// How fast it moves, or half as fast as it moved before: where it turns back it may stand still for a moment.
    speed: f64,
    /// The area seen.
    area: f64,
    /// Width and height of the box around it.
    size: Vector2<f64>,
    pub(crate) clipped: bool,
    /// As it was when it was last seen whole.
    shape: Option<AffineMomentInvariants>,
    pub(crate) frame: u64,
    /// Where it was seen first.
    first: Point2<f64>,
    pub(crate) has_left: bool,
}

/// How a sighting differs from an object.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Difference {
    /// From the place expected, in diameters.
    pub(crate) distance: f64,
    /// `distance` over the largest accepted distance.
    place: f64,
    /// Logarithm of the ratio of areas; `None` where that tells nothing, as what is clipped has less than its area.
    pub(crate) growth: Option<f64>,
    /// Distance of the invariants; `None` where one of them is clipped.
    shape: Option<f64>,
    /// Whether neither is clipped.
    are_whole: bool,
}

impl Difference {
    pub(crate) fn is_near(&self) -> bool {
        self.place <= 1.0
    }

    fn is_alike(&self) -> bool {
        self.growth.is_none_or(|growth| growth.abs() <= LARGEST_GROWTH.ln())
    }

    /// Whether nothing but the object can be seen there.
    pub(crate) fn is_of_one(&self) -> bool {
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
    pub(crate) fn seen(name: u64, frame: u64, traced: &TracedOutline) -> Self {
        let (centre, area, clipped) = (traced.centre, traced.area, traced.touches_border);
        let shape = if clipped { None } else { traced.invariants };
        let Spot { size, .. } = Spot::of(traced);
        let (velocity, speed, has_left) = (None, 0.0, false);
        Self { name, centre, velocity, speed, area, size, clipped, shape, frame, first: centre, has_left }
    }

    pub(crate) fn see(&mut self, frame: u64, traced: &TracedOutline) {
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

    /// Where it was last seen.
    pub(crate) fn spot(&self) -> Spot {
        Spot { centre: self.centre, size: self.size }
    }

    /// Where it should be.
    pub(crate) fn expected(&self, frame: u64) -> Point2<f64> {
        self.centre + self.velocity.unwrap_or_else(Vector2::zeros) * frame.saturating_sub(self.frame) as f64
    }

    /// The larger one of its diameter and that of a sighting, as if they were discs.
    fn diameter(&self, traced: &TracedOutline) -> f64 {
        (4.0 * self.area.max(traced.area) / std::f64::consts::PI).sqrt()
    }

    pub(crate) fn difference(&self, frame: u64, traced: &TracedOutline) -> Difference {
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

    /// As it would be if it moved so, of which nothing is known by itself.
    pub(crate) fn moving(&self, velocity: Vector2<f64>) -> Self {
        Self { velocity: Some(velocity), speed: velocity.norm(), ..self.clone() }
    }

    /// Whether something seen whole in the next picture may be what was seen whole for the first time, somewhere around.
    pub(crate) fn may_be_alike(&self, traced: &TracedOutline) -> bool {
        let difference = self.difference(self.frame + 1, traced);
        difference.distance <= FIRST_REACH
            && difference.growth.is_some_and(|growth| growth.abs() <= FIRST_GROWTH.ln())
            && difference.shape.is_none_or(|shape| shape <= MAY_BE_ALIKE)
    }

    pub(crate) fn cost(&self, frame: u64, traced: &TracedOutline) -> Option<f64> {
        self.difference(frame, traced).cost()
    }

    /// The same of what was seen in the frame before, if it may be far from where it is expected: as it was seen for the first time then, or as
    /// it moves by more than its diameter and may turn back.
    pub(crate) fn cost_of_far(&self, frame: u64, traced: &TracedOutline) -> Option<f64> {
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
