//! How a motion is identified, and from which initial values.
use freeform_curve_fit::{FitSettings, Method as FitMethod};
use freeform_identify::{AdaptiveLaw, AdaptiveSettings, PairChoice};
use freeform_motion::PipelineSettings;
use freeform_outline_filter::FilterSettings;
use freeform_riccati::MotionModel;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

/// Random initial values are drawn evenly between these and their negatives: rad/s, and space lengths per second.
pub(super) const START_RANGE: [f64; 3] = [3.0, 5.0, 5.0];

/// How a motion is identified.
#[derive(Debug, Clone)]
pub(super) enum Method {
    Adaptive(Box<PipelineSettings>),
    Filter(FilterSettings),
}

impl Method {
    pub(super) fn law(model: MotionModel, law: AdaptiveLaw, pairs: PairChoice, start: &[f64]) -> Self {
        let identify =
            AdaptiveSettings { model, law, pairs, initial_values: start.to_vec(), ..AdaptiveSettings::default() };
        Self::Adaptive(Box::new(PipelineSettings { identify, ..PipelineSettings::for_model(model) }))
    }

    /// The method with this RMS radius of the object in the identifier; the filter knows no such size.
    pub(super) fn with_size(mut self, size: f64) -> Self {
        if let Self::Adaptive(settings) = &mut self {
            settings.size = size;
        }
        self
    }

    /// The motion filter as it is by default.
    pub(super) fn filter(model: MotionModel) -> Self {
        Self::Filter(FilterSettings { model, ..FilterSettings::default() })
    }
}

/// A fit in words.
pub(super) fn fit_in_words(settings: &FitSettings) -> String {
    let method = match settings.method {
        FitMethod::ThreeLevel => "3L".to_owned(),
        FitMethod::GloballyStabilised { ridge_weight } => format!("GS3L with ridge {ridge_weight}"),
        FitMethod::Bounded { margin, ridge_weight: 0.0 } => format!("3L bounded by a margin of {margin}"),
        FitMethod::Bounded { margin, ridge_weight } => {
            format!("3L bounded by a margin of {margin} with a ridge of {ridge_weight}")
        }
    };
    format!("{method}, level sets at {} RMS radii", settings.offset)
}

/// Initial values number `index` of a rigid motion, in space.
pub(super) fn random_start(seed: u64, index: u64) -> Vec<f64> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(index);
    START_RANGE.iter().map(|limit| rng.random_range(-limit..=*limit)).collect()
}

/// How initial values are drawn.
pub(super) fn start_range_in_words() -> String {
    let [omega, b1, b2] = START_RANGE;
    format!("evenly, omega within {omega} rad/s, b1 within {b1} and b2 within {b2} lengths/s in space")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn random_initial_values_are_within_their_range_and_differ() {
        let starts: Vec<_> = (0..50).map(|index| random_start(1, index)).collect();
        let within = |start: &Vec<f64>| start.iter().zip(START_RANGE).all(|(value, limit)| value.abs() <= limit);
        assert!(starts.iter().all(within));
        assert!(starts.windows(2).all(|two| two[0] != two[1]) && starts[0] == random_start(1, 0));
    }

    #[test]
    fn a_fit_is_told_by_all_that_makes_it() {
        let identified = fit_in_words(&PipelineSettings::default().fit);
        assert_eq!(identified, "3L bounded by a margin of 0.5 with a ridge of 0.03, level sets at 0.15 RMS radii");
        assert_eq!(
            fit_in_words(&FitSettings::default()),
            "3L bounded by a margin of 0.02, level sets at 0.1 RMS radii"
        );
    }
}
