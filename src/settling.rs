use freeform_estimate::MotionEstimate;
#[cfg(feature = "serde")]
use freeform_riccati::MotionModel;
use nalgebra::DVector;

/// Seconds that the adaptive laws take at least, with the paper's gains.
const SHORTEST: f64 = 10.0;
/// Relative change of the parameters over the last third to half of a run from which on they are still on their way.
const DRIFT: f64 = 0.1;
/// A later estimate is kept when the run has become so many times as long.
const SPACING: f64 = 1.5;

/// Whether the parameters of a run have stopped to drift, in constant memory: estimates of the past are kept at times that
/// grow geometrically.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Settling {
    began: Option<f64>,
    older: Option<Kept>,
    newer: Option<Kept>,
    latest: Option<Kept>,
}

#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Kept {
    seconds: f64,
    estimate: MotionEstimate,
}

impl Settling {
    /// Takes the estimate at a time in seconds, in any coordinates that stay the same.
    pub(crate) fn take(&mut self, time: f64, estimate: Option<MotionEstimate>) {
        let seconds = time - *self.began.get_or_insert(time);
        let Some(estimate) = estimate else { return };
        let kept = Kept { seconds, estimate };
        self.latest = Some(kept);
        if self.newer.is_none_or(|newer| seconds >= SPACING * newer.seconds) {
            self.older = self.newer.replace(kept);
        }
    }

    /// Length of the run so far, if its parameters cannot be relied on to have settled.
    pub(crate) fn unsettled(&self) -> Option<f64> {
        let latest = self.latest?;
        let values = |kept: &Kept| DVector::from_column_slice(kept.estimate.values());
        let drifts = self.older.is_none_or(|older| {
            let (now, before) = (values(&latest), values(&older));
            (&now - before).norm() > DRIFT * now.norm()
        });
        (latest.seconds < SHORTEST || drifts).then_some(latest.seconds)
    }

    /// Whether it can have come from estimates of this model.
    #[cfg(feature = "serde")]
    pub(crate) fn is_of(&self, model: MotionModel) -> bool {
        let kept = [self.older, self.newer, self.latest];
        let is_sound = |kept: &Kept| {
            kept.seconds.is_finite()
                && kept.seconds >= 0.0
                && kept.estimate.model() == model
                && kept.estimate.is_finite()
        };
        self.began.is_none_or(f64::is_finite) && kept.iter().flatten().all(is_sound)
    }
}
