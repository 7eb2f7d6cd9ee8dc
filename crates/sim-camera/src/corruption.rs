use nalgebra::{Point2, Vector2};
use rand::{Rng, RngExt as _, seq::index};
use rand_distr::{Distribution as _, StandardNormal, UnitDisc};

use crate::sampling::Stretch;

/// An arc of the contour that is out of view.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Occlusion {
    /// Share of the perimeter that is missing, 0 (nothing) up to but not including 1.
    pub fraction: f64,
    /// Probability, 0 to 1, that it is missing in a frame.
    pub probability: f64,
    /// Index of the first frame that it can be missing in.
    pub first_frame: usize,
}

impl Default for Occlusion {
    /// Nothing is missing; once a fraction is set, it is missing in every frame.
    fn default() -> Self {
        Self { fraction: 0.0, probability: 1.0, first_frame: 0 }
    }
}

/// The arc missing from one frame, as fractions of the perimeter in the body frame.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct HiddenArc {
    /// Where it starts, in [0, 1).
    pub start: f64,
    /// Its length; it may run past the curve's starting point.
    pub length: f64,
}

impl HiddenArc {
    /// Whether a place on the curve, a fraction of the perimeter, is hidden.
    #[must_use]
    pub fn contains(&self, fraction: f64) -> bool {
        (fraction - self.start).rem_euclid(1.0) < self.length
    }

    pub(crate) fn rest(&self) -> Stretch {
        Stretch { start: self.start + self.length, length: 1.0 - self.length }
    }
}

impl Occlusion {
    pub(crate) fn draw(&self, frame: usize, rng: &mut impl Rng) -> Option<HiddenArc> {
        let (start, chance): (f64, f64) = (rng.random(), rng.random());
        let hides = self.fraction > 0.0 && frame >= self.first_frame && chance < self.probability;
        hides.then_some(HiddenArc { start, length: self.fraction })
    }
}

/// Adds isotropic Gaussian noise of the given standard deviation to both coordinates of every point.
pub(crate) fn add_noise(points: &mut [Point2<f64>], sigma: f64, rng: &mut impl Rng) {
    for point in points {
        let noise = Vector2::new(rng.sample(StandardNormal), rng.sample(StandardNormal));
        *point += sigma * noise;
    }
}

/// Moves `round(fraction count)` points, each to a uniformly drawn place of the disc of the given radius about it.
/// Returns their positions in the list, increasing.
pub(crate) fn add_outliers(points: &mut [Point2<f64>], fraction: f64, radius: f64, rng: &mut impl Rng) -> Vec<usize> {
    let count = (fraction * points.len() as f64).round() as usize;
    let mut chosen = index::sample(rng, points.len(), count).into_vec();
    chosen.sort_unstable();
    for &position in &chosen {
        let [x, y]: [f64; 2] = UnitDisc.sample(rng);
        points[position] += radius * Vector2::new(x, y);
    }
    chosen
}
