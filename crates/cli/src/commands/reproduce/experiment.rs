//! Simulated sequences, and what the methods make of them.
use freeform_motion::curve_fit::Outline;
use freeform_motion::identify::{
    AdaptiveLaw, AdaptiveSettings, FilterSettings, MotionEstimate, MotionFilter, PairChoice, ProcessNoise,
};
use freeform_motion::riccati::{AffineMotion, CameraScale, MotionModel};
use freeform_motion::sim_camera::{Motion, PaperExperiment, Scene, SequenceLength, Settings, Simulator};
use freeform_motion::{Pipeline, PipelineSettings};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use crate::failure::Failure;
use crate::output::significant;

/// Frames per second where nothing else is said; the paper does not give it.
pub(crate) const FPS: f64 = 30.0;

/// Points on each outline; the paper does not give it.
pub(crate) const POINTS: usize = 400;

/// A motion has settled once the error of its rates (omega, or the matrix a) stays below this share of them...
pub(crate) const SETTLED_RATES: f64 = 0.05;
/// ... and that of its velocity b below this share of it.
pub(crate) const SETTLED_VELOCITY: f64 = 0.10;

/// Share of the run, at its end, that final errors are taken over.
const FINAL_SHARE: f64 = 0.1;

/// Random initial values are drawn evenly between these and their negatives: rad/s, and space lengths per second.
pub(crate) const START_RANGE: [f64; 3] = [3.0, 5.0, 5.0];

/// Outlines of one object over time, and how it really moves.
pub(crate) struct Sequence {
    pub(crate) frames: Vec<(f64, Outline)>,
    /// In space.
    pub(crate) truth: Motion,
    /// Camera scale f/Z0.
    pub(crate) scale: CameraScale,
}

impl Sequence {
    pub(crate) fn simulate(scene: Scene, settings: Settings) -> Result<Self, Failure> {
        let (truth, scale) = (scene.motion().clone(), scene.camera().scale());
        let simulator = Simulator::new(scene, settings).map_err(Failure::unusable)?;
        let frames = simulator.frames().map(|frame| (frame.time, frame.outline)).collect();
        Ok(Self { frames, truth, scale })
    }

    /// One of the paper's experiments.
    pub(crate) fn of_paper(experiment: &PaperExperiment, seconds: f64, seed: u64) -> Result<Self, Failure> {
        let scene = experiment.scene(PaperExperiment::SCALE).map_err(Failure::unusable)?;
        Self::simulate(scene, paper_settings(seconds, seed))
    }
}

/// How outlines are taken where nothing else is said.
pub(crate) fn paper_settings(seconds: f64, seed: u64) -> Settings {
    Settings {
        fps: FPS,
        length: SequenceLength::Seconds(seconds),
        points: POINTS,
        noise: PaperExperiment::NOISE,
        seed,
        ..Settings::default()
    }
}

/// How a motion is identified.
#[derive(Debug, Clone)]
pub(crate) enum Method {
    Adaptive(Box<PipelineSettings>),
    Filter(FilterSettings),
}

impl Method {
    pub(crate) fn law(model: MotionModel, law: AdaptiveLaw, pairs: PairChoice, start: &[f64]) -> Self {
        let identify =
            AdaptiveSettings { model, law, pairs, initial_values: start.to_vec(), ..AdaptiveSettings::default() };
        Self::Adaptive(Box::new(PipelineSettings { identify, ..PipelineSettings::default() }))
    }

    pub(crate) fn filter(model: MotionModel, process_noise: ProcessNoise) -> Self {
        Self::Filter(FilterSettings { model, process_noise, ..FilterSettings::default() })
    }
}

/// What a method found over time.
#[derive(Debug, Default)]
pub(crate) struct Track {
    /// Time in seconds and motion in space.
    pub(crate) points: Vec<(f64, AffineMotion)>,
    pub(crate) frames: usize,
    pub(crate) frames_rejected: usize,
    /// The line pair that the estimate comes from; `None` if from all, or from none.
    pub(crate) pair: Option<usize>,
}

impl Track {
    pub(crate) fn by(method: &Method, sequence: &Sequence) -> Result<Self, Failure> {
        let mut track = Self { frames: sequence.frames.len(), ..Self::default() };
        match method {
            Method::Adaptive(settings) => {
                // Initial values are told in space and known to the pipeline in the image.
                let mut settings = settings.as_ref().clone();
                let names = settings.identify.model.parameter_names();
                for (value, name) in settings.identify.initial_values.iter_mut().zip(names) {
                    *value *= if name.starts_with('b') { sequence.scale.value() } else { 1.0 };
                }
                let mut pipeline = Pipeline::new(settings).map_err(Failure::unusable)?;
                for (time, outline) in &sequence.frames {
                    // Frames that are refused are counted by the pipeline.
                    if let Ok(result) = pipeline.push(*time, outline) {
                        track.take(*time, result.estimate, sequence.scale);
                    }
                }
                track.frames_rejected = pipeline.frames_rejected();
                track.pair = pipeline.identifier().chosen_pair();
            }
            Method::Filter(settings) => {
                let mut filter = MotionFilter::new(*settings).map_err(Failure::unusable)?;
                for (time, outline) in &sequence.frames {
                    match filter.step(*time, outline) {
                        Ok(step) if step.accepted => track.take(*time, filter.estimate(), sequence.scale),
                        Ok(_) | Err(_) => track.frames_rejected += 1,
                    }
                }
            }
        }
        Ok(track)
    }

    fn take(&mut self, time: f64, estimate: Option<MotionEstimate>, scale: CameraScale) {
        let Some(estimate) = estimate.filter(|estimate| estimate.parameters().all(|p| p.value.is_some())) else {
            return;
        };
        let a = estimate.in_space(scale).generator();
        let (a1, a2, a3, a4) = (a[(0, 0)], a[(0, 1)], a[(1, 0)], a[(1, 1)]);
        self.points.push((time, AffineMotion { a1, a2, a3, a4, b1: a[(0, 2)], b2: a[(1, 2)] }));
    }

    pub(crate) fn errors(&self, truth: &Motion) -> Vec<RelativeError> {
        self.points.iter().map(|(time, found)| RelativeError::of(*time, found, &truth.at(*time))).collect()
    }
}

/// How far an estimate is from the truth.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RelativeError {
    pub(crate) time: f64,
    /// Norm of the error of the matrix (a1, a2; a3, a4) over its norm: for rigid motion that of omega over omega.
    pub(crate) rates: f64,
    /// Length of the error of b over the length of b.
    pub(crate) velocity: f64,
}

impl RelativeError {
    fn of(time: f64, found: &AffineMotion, truth: &AffineMotion) -> Self {
        let rates = |m: &AffineMotion| nalgebra::Vector4::new(m.a1, m.a2, m.a3, m.a4);
        let velocity = |m: &AffineMotion| nalgebra::Vector2::new(m.b1, m.b2);
        Self {
            time,
            rates: (rates(found) - rates(truth)).norm() / rates(truth).norm(),
            velocity: (velocity(found) - velocity(truth)).norm() / velocity(truth).norm(),
        }
    }

    fn is_settled(&self) -> bool {
        self.rates < SETTLED_RATES && self.velocity < SETTLED_VELOCITY
    }
}

/// What a run comes to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Outcome {
    /// Root mean square relative error of the rates over the last tenth of the run; infinite where there is none.
    pub(crate) rates: f64,
    /// The same of the velocity.
    pub(crate) velocity: f64,
    /// Time in seconds from which on the motion stays settled; infinite where it never does.
    pub(crate) settled: f64,
    /// Share of frames rejected.
    pub(crate) rejected: f64,
}

impl Outcome {
    pub(crate) fn of(track: &Track, sequence: &Sequence) -> Self {
        let errors = track.errors(&sequence.truth);
        let end = sequence.frames.last().map_or(0.0, |(time, _)| *time);
        let tail: Vec<_> = errors.iter().filter(|error| error.time >= (1.0 - FINAL_SHARE) * end).collect();
        let root_mean_square = |value: fn(&RelativeError) -> f64| {
            let mean = tail.iter().map(|error| value(error).powi(2)).sum::<f64>() / tail.len() as f64;
            if mean.is_finite() { mean.sqrt() } else { f64::INFINITY }
        };
        let settled = match errors.iter().rposition(|error| !error.is_settled()) {
            Some(last) => errors.get(last + 1).map(|error| error.time),
            None => errors.first().map(|error| error.time),
        };
        Self {
            rates: root_mean_square(|error| error.rates),
            velocity: root_mean_square(|error| error.velocity),
            settled: settled.unwrap_or(f64::INFINITY),
            rejected: track.frames_rejected as f64 / track.frames.max(1) as f64,
        }
    }

    /// Entry by entry: the quantile of several outcomes, 0.5 for the median and 1 for the worst.
    pub(crate) fn quantile(outcomes: &[Self], share: f64) -> Self {
        let entry = |value: fn(&Self) -> f64| {
            let mut values: Vec<f64> = outcomes.iter().map(value).collect();
            values.sort_by(f64::total_cmp);
            let place = share * values.len().saturating_sub(1) as f64;
            let (below, above) = (values.get(place.floor() as usize), values.get(place.ceil() as usize));
            let (Some(below), Some(above)) = (below, above) else { return f64::INFINITY };
            if below == above { *below } else { below + (above - below) * place.fract() }
        };
        Self {
            rates: entry(|o| o.rates),
            velocity: entry(|o| o.velocity),
            settled: entry(|o| o.settled),
            rejected: entry(|o| o.rejected),
        }
    }

    /// As a table shows it: errors in percent and the settling time in seconds.
    pub(crate) fn cells(&self) -> [String; 3] {
        let settled = match self.settled {
            never if never.is_infinite() => "-".to_owned(),
            soon if soon < 1.0 => format!("{soon:.2}"),
            later => format!("{later:.1}"),
        };
        [percent(self.rates), percent(self.velocity), settled]
    }
}

/// A share in percent with two digits.
pub(crate) fn percent(share: f64) -> String {
    match 100.0 * share {
        value if !value.is_finite() => "-".to_owned(),
        // Beyond a factor of ten the digits say nothing, and nobody needs to know so little.
        value if value >= 1000.0 => "> 1000".to_owned(),
        value if value > 0.0 && value < 0.001 => "< 0.001".to_owned(),
        value => significant(value, 2),
    }
}

/// Initial values number `index` of a rigid motion, in space.
pub(crate) fn random_start(seed: u64, index: u64) -> Vec<f64> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(index);
    START_RANGE.iter().map(|limit| rng.random_range(-limit..=*limit)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(errors: &[f64]) -> (Track, Sequence) {
        let truth = AffineMotion { a2: 1.0, a3: -1.0, b1: 1.0, ..AffineMotion::default() };
        let points = errors.iter().enumerate().map(|(k, error)| {
            let off = 1.0 + error;
            (k as f64, AffineMotion { a2: off, a3: -off, ..truth })
        });
        let outline = Outline::closed([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(x, y)| [x, y].into()).into());
        let frame = |k: usize| (k as f64, outline.clone().expect("a triangle"));
        let sequence = Sequence {
            frames: (0..errors.len()).map(frame).collect(),
            truth: truth.into(),
            scale: CameraScale::default(),
        };
        (Track { points: points.collect(), frames: errors.len(), ..Track::default() }, sequence)
    }

    #[test]
    fn a_run_has_settled_where_its_error_stays_small_and_not_where_it_is_so_for_a_moment() {
        let (found, sequence) = track(&[0.5, 0.01, 0.2, 0.01, -0.02]);
        let outcome = Outcome::of(&found, &sequence);
        assert_eq!(outcome.settled, 3.0);
        assert!((outcome.rates - 0.02).abs() < 1e-12 && outcome.velocity == 0.0);
        let (found, sequence) = track(&[0.01, 0.01, 0.2]);
        assert_eq!(Outcome::of(&found, &sequence).settled, f64::INFINITY);
        let (found, sequence) = track(&[]);
        assert_eq!(Outcome::of(&found, &sequence).cells(), ["-", "-", "-"]);
    }

    #[test]
    fn median_and_worst_are_taken_entry_by_entry() {
        let outcome = |rates: f64, settled: f64| Outcome { rates, velocity: 0.0, settled, rejected: 0.0 };
        let outcomes = [outcome(0.3, 1.0), outcome(0.1, f64::INFINITY), outcome(0.2, 5.0)];
        assert_eq!(Outcome::quantile(&outcomes, 0.5), outcome(0.2, 5.0));
        assert_eq!(Outcome::quantile(&outcomes, 1.0), outcome(0.3, f64::INFINITY));
        assert_eq!(Outcome::quantile(&outcomes[..2], 0.5).settled, f64::INFINITY);
    }

    #[test]
    fn random_initial_values_are_within_their_range_and_differ() {
        let starts: Vec<_> = (0..50).map(|index| random_start(1, index)).collect();
        let within = |start: &Vec<f64>| start.iter().zip(START_RANGE).all(|(value, limit)| value.abs() <= limit);
        assert!(starts.iter().all(within));
        assert!(starts.windows(2).all(|two| two[0] != two[1]) && starts[0] == random_start(1, 0));
    }
}
