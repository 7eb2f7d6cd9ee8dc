//! How fast the motion changes, estimated from the innovations.
use super::innovation::{ByKind, PoseInnovation};

/// Frames that the estimate looks back on.
const MEMORY: f64 = 15.0;
/// Standard deviations of the likelihood's slope from which a change counts as seen. Constant motion must stay at the bound.
const SIGNIFICANT: f64 = 7.0;
/// The same for a motion that has been seen to change before.
const SIGNIFICANT_AGAIN: f64 = 3.0;
/// Squared innovation per parameter beyond which two frames in a row show a sudden change.
pub(crate) const SUDDEN: f64 = 25.0;
/// Squared innovation per parameter that counts at most in the running estimate: squares have long tails.
const LIMIT: f64 = 4.0;
/// Squared innovation per parameter that chance does not make; up to this one frame counts at most so many standard deviations of its
/// slope as evidence, which takes several frames that agree.
const BEYOND_CHANCE: f64 = 8.0;
const EVIDENCE: f64 = 4.0;

/// Recursive maximum-likelihood estimates, by Fisher's scoring, of the variances by which the rates and the velocities of the motion change
/// per second; none until the evidence is significant.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct MotionChange([Change; 2]);

/// One of them.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Change {
    /// Normalised units, per second.
    variance: f64,
    gradient: f64,
    fisher: f64,
    has_changed: bool,
}

impl MotionChange {
    /// The variances, unless both are none.
    pub(crate) fn variances(&self) -> Option<ByKind> {
        let variances = self.0.map(|change| change.variance);
        variances.iter().any(|v| *v > 0.0).then_some(variances)
    }

    /// Takes the innovation of an accepted frame of a motion with so many parameters.
    pub(crate) fn take(&mut self, innovation: &PoseInnovation, parameters: usize) {
        let limit = LIMIT * parameters as f64;
        let share = if innovation.squared > limit { limit / innovation.squared } else { 1.0 };
        let by_chance = innovation.squared < BEYOND_CHANCE * parameters as f64;
        for (change, (gradient, fisher)) in self.0.iter_mut().zip(innovation.gradient.iter().zip(innovation.fisher)) {
            if fisher > 0.0 {
                change.take(gradient * share, fisher, by_chance);
            }
        }
        let evidence = self.0.map(|change| change.evidence());
        let (clearest, other) = if evidence[0] > evidence[1] { (0, 1) } else { (1, 0) };
        if evidence[clearest] > 1.0 {
            self.0[clearest].begin();
            // What the one explains is no evidence of the other.
            self.0[other].forget();
        }
    }
}

impl Change {
    fn take(&mut self, gradient: f64, fisher: f64, by_chance: bool) {
        if self.variance > 0.0 {
            self.variance += gradient / (MEMORY * fisher);
            if self.variance <= 0.0 {
                *self = Self { has_changed: true, ..Self::default() };
            }
            return;
        }
        let kept = 1.0 - 1.0 / MEMORY;
        let most = if by_chance { EVIDENCE * fisher.sqrt() } else { f64::INFINITY };
        self.gradient = kept * self.gradient + gradient.min(most);
        self.fisher = kept * self.fisher + fisher;
    }

    /// Slope of the likelihood in units of what is significant; none where a change has been found.
    fn evidence(&self) -> f64 {
        let significant = if self.has_changed { SIGNIFICANT_AGAIN } else { SIGNIFICANT };
        if self.fisher > 0.0 { self.gradient / (significant * self.fisher.sqrt()) } else { 0.0 }
    }

    fn begin(&mut self) {
        self.variance = self.gradient / self.fisher;
        self.forget();
    }

    fn forget(&mut self) {
        (self.gradient, self.fisher) = (0.0, 0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_frame_that_chance_may_make_shows_no_change_but_several_in_a_row_do() {
        let innovation = PoseInnovation { squared: 20.0, gradient: [12.0, -1.0], fisher: [1.0; 2] };
        let mut change = MotionChange::default();
        change.take(&innovation, 6);
        assert_eq!(change.variances(), None);
        (0..4).for_each(|_| change.take(&innovation, 6));
        let [rates, velocities] = change.variances().expect("a change");
        assert!(rates > 0.0 && velocities == 0.0);
    }
}
