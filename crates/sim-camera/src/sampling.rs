use rand::{Rng, RngExt as _};

/// How the points of one frame are spread along the contour. They are drawn anew in every frame, by arc length in the
/// body frame: point k of one frame has nothing to do with point k of the next.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Sampling {
    /// The contour is cut at a random place and divided into as many equal stretches as there are points; each stretch
    /// gets one.
    Regular {
        /// The middle share of its stretch that a point is drawn from, 0 to 1: 0 spaces the points equally, 1 draws them
        /// from the whole stretch.
        jitter: f64,
    },
    /// Every point is drawn from the whole contour independently, then they are sorted. The Cramer-Rao bound assumes it.
    Independent,
}

impl Default for Sampling {
    /// One point anywhere in each of equal stretches (stratified sampling): `Regular { jitter: 1.0 }`.
    fn default() -> Self {
        Self::Regular { jitter: 1.0 }
    }
}

/// A stretch of the contour, as fractions of its perimeter; the end may lie beyond 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stretch {
    pub(crate) start: f64,
    pub(crate) length: f64,
}

impl Sampling {
    /// Increasing places within the stretch, fractions of the perimeter.
    pub(crate) fn places(self, count: usize, stretch: Stretch, rng: &mut impl Rng) -> Vec<f64> {
        let unit: Vec<f64> = match self {
            Self::Regular { jitter } => {
                let offset = |u: f64| 0.5 + jitter * (u - 0.5);
                (0..count).map(|k| (k as f64 + offset(rng.random())) / count as f64).collect()
            }
            Self::Independent => {
                let mut drawn: Vec<f64> = (0..count).map(|_| rng.random()).collect();
                drawn.sort_by(f64::total_cmp);
                drawn
            }
        };
        unit.into_iter().map(|u| stretch.start + stretch.length * u).collect()
    }
}
