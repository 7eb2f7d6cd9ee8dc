use nalgebra::{Point2, Vector2};

use crate::picture_error::TraceError;
use crate::trace::TracedOutline;

/// Most frames that an object may be missing in before it is forgotten.
const PATIENCE: u64 = 15;

/// Farthest that an object may be from where it is expected, in its diameters; half as much more for every frame missed.
const REACH: f64 = 1.0;

/// Largest ratio of areas between sightings of one object of which neither is clipped.
const LARGEST_GROWTH: f64 = 2.0;

/// Which objects of a picture are taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Selection {
    /// The largest of each picture; of those in rings the clearest.
    #[default]
    Largest,
    /// The largest of the first picture, then the one nearest to where that is expected.
    Nearest,
    /// All, each with a name that it keeps: its area and its place, predicted from its velocity, tell it in the next frame.
    All,
}

/// Most objects of a picture that are followed.
pub(crate) const OBJECT_LIMIT: usize = 256;

/// An object as it was last seen.
#[derive(Debug, Clone)]
struct Known {
    name: u64,
    centre: Point2<f64>,
    /// Movement from frame to frame.
    velocity: Vector2<f64>,
    area: f64,
    clipped: bool,
    frame: u64,
}

impl Known {
    fn seen(name: u64, frame: u64, traced: &TracedOutline) -> Self {
        let (centre, area, clipped) = (traced.centre, traced.area, traced.touches_border);
        Self { name, centre, velocity: Vector2::zeros(), area, clipped, frame }
    }

    fn see(&mut self, frame: u64, traced: &TracedOutline) {
        let frames = frame.saturating_sub(self.frame).max(1) as f64;
        let velocity = (traced.centre - self.centre) / frames;
        *self = Self { velocity, ..Self::seen(self.name, frame, traced) };
    }

    /// Distance from where the object is expected, in diameters, and the growth of its area as a logarithm.
    fn distance_and_growth(&self, frame: u64, traced: &TracedOutline) -> (f64, f64) {
        let expected = self.centre + self.velocity * frame.saturating_sub(self.frame) as f64;
        let diameter = (4.0 * self.area.max(traced.area) / std::f64::consts::PI).sqrt();
        ((traced.centre - expected).norm() / diameter, (traced.area / self.area).ln().abs())
    }

    /// How ill a sighting fits; `None` where it cannot be the object.
    fn cost(&self, frame: u64, traced: &TracedOutline) -> Option<f64> {
        let (distance, growth) = self.distance_and_growth(frame, traced);
        let missed = frame.saturating_sub(self.frame).saturating_sub(1) as f64;
        let clipped = self.clipped || traced.touches_border;
        let near = distance <= REACH * (1.0 + 0.5 * missed);
        let alike = clipped || growth <= LARGEST_GROWTH.ln();
        (near && alike).then_some(distance + if clipped { 0.0 } else { growth })
    }
}

/// Follows objects from picture to picture.
#[derive(Debug)]
pub(crate) struct Identities {
    selection: Selection,
    known: Vec<Known>,
    next_name: u64,
}

impl Identities {
    pub(crate) fn new(selection: Selection) -> Self {
        Self { selection, known: Vec::new(), next_name: 0 }
    }

    /// How many objects of a picture are needed.
    pub(crate) fn limit(&self) -> usize {
        if self.selection == Selection::Largest { 1 } else { OBJECT_LIMIT }
    }

    /// Names the objects of a picture, the most important of which comes first.
    pub(crate) fn assign(
        &mut self,
        frame: u64,
        traced: Vec<TracedOutline>,
    ) -> Result<Vec<(u64, TracedOutline)>, TraceError> {
        self.known.retain(|known| frame.saturating_sub(known.frame) <= PATIENCE + 1);
        match self.selection {
            Selection::Largest => Ok(traced.into_iter().take(1).map(|traced| (0, traced)).collect()),
            Selection::Nearest => self.nearest(frame, traced).map(|found| vec![(0, found)]),
            Selection::All => Ok(self.all(frame, traced)),
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
            let distances = traced.iter().map(|traced| known.distance_and_growth(frame, traced).0);
            return Err(TraceError::NotNear { distance: distances.fold(f64::INFINITY, f64::min) });
        };
        known.see(frame, &traced[index]);
        traced.into_iter().nth(index).ok_or(TraceError::NoPixels)
    }

    fn all(&mut self, frame: u64, traced: Vec<TracedOutline>) -> Vec<(u64, TracedOutline)> {
        let mut pairs = Vec::new();
        for (k, known) in self.known.iter().enumerate() {
            let costs = traced.iter().map(|traced| known.cost(frame, traced)).enumerate();
            pairs.extend(costs.filter_map(|(t, cost)| Some((cost?, k, t))));
        }
        // The best pair first: of two objects that could be either, the one that fits best keeps its name.
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut names = vec![None; traced.len()];
        let mut used = vec![false; self.known.len()];
        for (_, k, t) in pairs {
            if !used[k] && names[t].is_none() {
                used[k] = true;
                names[t] = Some(self.known[k].name);
                self.known[k].see(frame, &traced[t]);
            }
        }
        let named = traced.into_iter().zip(names).map(|(traced, name)| {
            let name = name.unwrap_or_else(|| {
                let name = self.next_name;
                self.next_name += 1;
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
