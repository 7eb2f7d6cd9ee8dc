//! What the points of a frame state of themselves: standard deviations that are known but for a factor.
use super::Reference;
use crate::tuning::deviations as tuning;

/// The stated deviations of the points of a frame, each over that of good points.
///
/// Only ratios count: what the factor between stated and actual deviations is, the residuals tell. No point counts for more than a good
/// one, in its frame or in others, so that a few points or frames that state too little do not stand for all.
#[derive(Debug, Clone, Default)]
pub(crate) struct PointDeviations {
    /// Of each point, at least 1; empty where all are 1.
    ratios: Vec<f64>,
    /// Mean of the squared inverses.
    weight: Option<f64>,
    /// Of the good points of the frame, image lengths.
    good: Option<f64>,
    sorted: Vec<f64>,
}

impl PointDeviations {
    /// Forgets what was stated.
    pub(super) fn clear(&mut self) {
        self.ratios.clear();
        (self.weight, self.good) = (None, None);
    }

    /// Takes the deviation of the next point, image lengths.
    pub(super) fn push(&mut self, stated: f64) {
        self.ratios.push(stated);
    }

    /// Drops the last one.
    pub(super) fn pop(&mut self) {
        self.ratios.pop();
    }

    /// Makes ratios of what was taken, for a deviation of the good points of other frames.
    pub(super) fn compare(&mut self, reference: &Reference) {
        if self.ratios.is_empty() {
            return;
        }
        self.sorted.clone_from(&self.ratios);
        let good = good(&mut self.sorted);
        // Where the reference is infinite, this frame is the first one that states any.
        let of_frame = (good / reference.stated).max(1.0);
        let ratio_of = |stated: f64| ((stated / good).max(1.0) * of_frame).min(tuning::LARGEST_RATIO);
        self.ratios.iter_mut().for_each(|ratio| *ratio = ratio_of(*ratio));
        self.good = Some(good);
        self.weigh();
    }

    fn weigh(&mut self) {
        self.weight = None;
        if self.ratios.iter().all(|ratio| *ratio == 1.0) {
            self.ratios.clear();
        } else {
            let sum: f64 = self.ratios.iter().map(|ratio| (ratio * ratio).recip()).sum();
            self.weight = Some(sum / self.ratios.len() as f64);
        }
    }

    /// Leaves the points with these numbers, which increase.
    pub(super) fn keep(&mut self, kept: impl Iterator<Item = usize>) {
        if self.ratios.is_empty() {
            return;
        }
        let mut count = 0;
        for i in kept {
            self.ratios[count] = self.ratios[i];
            count += 1;
        }
        self.ratios.truncate(count);
        self.weigh();
    }

    /// Deviation of each point over that of a good one, at least 1; `None` where all are 1.
    #[inline]
    pub(crate) fn ratios(&self) -> Option<&[f64]> {
        (!self.ratios.is_empty()).then_some(&self.ratios)
    }

    /// What the points count for in the mean, a good one for 1.
    pub(crate) fn weight(&self) -> f64 {
        self.weight.unwrap_or(1.0)
    }

    /// Deviation of a typical point over that of a good one.
    pub(crate) fn typical(&self) -> f64 {
        self.weight.map_or(1.0, |weight| weight.sqrt().recip())
    }

    /// Largest ratio by which a point is judged: one that lies further off is none of the outline, however little it says of itself.
    pub(crate) fn widest(&self) -> f64 {
        tuning::WIDEST * self.typical()
    }

    /// Deviation that the good points of the frame state, image lengths; infinite where none state any.
    pub(crate) fn good(&self) -> f64 {
        self.good.unwrap_or(f64::INFINITY)
    }
}

impl Reference {
    /// Updates what good points state by the deviations that a frame which shows the object states, if any. The first that does is believed, one alone of the
    /// others hardly: the reference falls fast to what many state, and rises slowly.
    pub(crate) fn update_stated(&mut self, good: f64) {
        if good.is_infinite() {
            return;
        }
        self.stated = if self.stated.is_finite() {
            let near = good.clamp(tuning::LARGEST_STEP * self.stated, tuning::LARGEST_RISE * self.stated);
            // Further off, points count for no less.
            near.max(good / tuning::LARGEST_RATIO)
        } else {
            good
        };
    }
}

/// A deviation that a tenth of the points do not exceed.
fn good(deviations: &mut [f64]) -> f64 {
    let place = (tuning::GOOD_SHARE * deviations.len() as f64) as usize;
    *deviations.select_nth_unstable_by(place, f64::total_cmp).1
}

/// Median of values, each counted by a weight: where half of all weight is reached.
pub(crate) fn weighted_median(values: &mut [(f64, f64)]) -> Option<f64> {
    values.sort_unstable_by(|(a, _), (b, _)| a.total_cmp(b));
    let half = 0.5 * values.iter().map(|(_, weight)| weight).sum::<f64>();
    let mut sum = 0.0;
    let reached = values.iter().find(|(_, weight)| {
        sum += weight;
        sum >= half
    });
    reached.map(|(value, _)| *value)
}
