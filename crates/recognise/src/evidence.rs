use nalgebra::Affine2;

use crate::{comparison::Comparison, settings::RecogniseSettings};

/// Independent distances that a comparison of two outlines is worth: fewer than points, as neighbours err alike.
const INDEPENDENT: f64 = 30.0;
/// Frames beyond this many add nothing: what they err in common remains.
const FRAMES: usize = 10;
/// Root mean square distance between outlines of different objects, in radii of the disc that has their inertia: the median
/// and the standard deviation of its logarithm, over pairs of silhouettes brought onto each other.
const OF_OTHERS: (f64, f64) = (0.12, 0.5);
/// Squared distance that is rounding, in the same unit: an outline compared with itself has none.
const ROUNDING: f64 = 1e-24;
/// Distance that counts for a frame in which the invariants left a known outline out.
const LEFT_OUT: f64 = 0.12;

/// What several frames of one object tell of which known outline it has.
#[derive(Debug, Clone, Default)]
pub struct Evidence {
    frames: usize,
    /// One for every known outline.
    sums: Vec<Sums>,
}

#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    squared_distance: f64,
    squared_expected: f64,
    fits: usize,
    squared_invariant_distance: f64,
    invariant_distances: usize,
    last_map: Option<Affine2<f64>>,
}

/// Which known outline an object has.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Recognition {
    /// Position of the known outline; `None` where it is more likely to be none of them.
    pub known: Option<usize>,
    /// Probability of that.
    pub probability: f64,
    /// All known outlines, most probable first.
    pub candidates: Vec<Candidate>,
}

/// A known outline and how likely it is.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Candidate {
    /// Position of the known outline.
    pub known: usize,
    /// Its probability.
    pub probability: f64,
    /// Mahalanobis distance of the invariants, root mean square over the frames.
    pub invariant_distance: Option<f64>,
    /// Root mean square distance of the outlines over the frames, in radii of the disc that has their inertia; `None` where the
    /// invariants left it out in all.
    pub distance: Option<f64>,
    /// From the known outline to the last frame in which they were compared.
    pub map: Option<Affine2<f64>>,
}

impl Evidence {
    /// None yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes the comparisons of one more frame, those of one [`Recogniser`](crate::Recogniser).
    pub fn add(&mut self, comparisons: &[Comparison]) {
        self.frames += 1;
        self.sums.resize(comparisons.len().max(self.sums.len()), Sums::default());
        for comparison in comparisons {
            let sums = &mut self.sums[comparison.known];
            if let Some(distance) = comparison.invariant_distance {
                sums.squared_invariant_distance += distance * distance;
                sums.invariant_distances += 1;
            }
            if let Some(fit) = &comparison.fit {
                sums.squared_distance += fit.distance * fit.distance;
                sums.squared_expected += fit.expected * fit.expected;
                sums.fits += 1;
                sums.last_map = Some(fit.map);
            }
        }
    }

    /// Number of frames taken.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.frames
    }

    /// What they tell together, by Bayes' rule: the distance of an outline from the known one that it shows is that of noise (its square
    /// chi-square distributed), from others log-normal. `None` before the first frame or where nothing is known.
    #[must_use]
    pub fn recognition(&self, settings: &RecogniseSettings) -> Option<Recognition> {
        if self.frames == 0 || self.sums.is_empty() {
            return None;
        }
        let prior = (1.0 - settings.unknown) / self.sums.len() as f64;
        let logarithms: Vec<f64> =
            self.sums.iter().map(|sums| prior.ln() + sums.log_likelihood_ratio(self.frames)).collect();
        let of_none = settings.unknown.ln();
        let largest = logarithms.iter().copied().fold(of_none, f64::max);
        let weights: Vec<f64> = logarithms.iter().map(|l| (l - largest).exp()).collect();
        let none = (of_none - largest).exp();
        let total = none + weights.iter().sum::<f64>();
        let mut candidates: Vec<Candidate> = self
            .sums
            .iter()
            .zip(&weights)
            .enumerate()
            .map(|(known, (sums, weight))| sums.candidate(known, weight / total))
            .collect();
        candidates.sort_by(|a, b| b.probability.total_cmp(&a.probability));
        // Whether it is any of them comes first: two known outlines that are affinely the same share the probability.
        let (known, probability) = if none > 0.5 * total {
            (None, none / total)
        } else {
            (Some(candidates[0].known), candidates[0].probability)
        };
        Some(Recognition { known, probability, candidates })
    }
}

impl Sums {
    /// Logarithm of how many times as likely the distance is where this is the outline shown as where it is another one.
    fn log_likelihood_ratio(&self, frames: usize) -> f64 {
        if self.fits == 0 {
            return f64::NEG_INFINITY;
        }
        let left_out = (frames - self.fits) as f64 * LEFT_OUT * LEFT_OUT;
        let squared = ((self.squared_distance + left_out) / frames as f64).max(ROUNDING);
        let ratio = squared / (self.squared_expected / self.fits as f64);
        let independent = INDEPENDENT * frames.min(FRAMES) as f64;
        // Densities over the logarithm of the distance. Noise that was taken for too large is no reason against an outline.
        let excess = ratio.max(1.0);
        let of_noise =
            0.5 * (independent / std::f64::consts::PI).ln() - 0.5 * independent * (excess - 1.0 - excess.ln());
        let (median, spread) = OF_OTHERS;
        let deviation = (0.5 * squared.ln() - f64::ln(median)) / spread;
        let of_others = -0.5 * deviation * deviation - spread.ln() - 0.5 * std::f64::consts::TAU.ln();
        of_noise - of_others
    }

    fn candidate(&self, known: usize, probability: f64) -> Candidate {
        let root_mean = |sum: f64, count: usize| (count > 0).then(|| (sum / count as f64).sqrt());
        Candidate {
            known,
            probability,
            invariant_distance: root_mean(self.squared_invariant_distance, self.invariant_distances),
            distance: root_mean(self.squared_distance, self.fits),
            map: self.last_map,
        }
    }
}
