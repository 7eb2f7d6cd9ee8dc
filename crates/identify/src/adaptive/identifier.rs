use freeform_decompose::{Line, MAX_PAIRS};
use freeform_riccati::{AffineMotion, MotionModel, RealVariables};
use nalgebra::{Const, DimMin, Matrix4, SVector, Vector4};

use super::{
    least_squares_law::{FilteredPair, LeastSquaresLaw},
    line_path::LinePath,
    lyapunov::solve_lyapunov,
    pair_quality::PairQuality,
    printed_law::PrintedLaw,
    regressor::Regressor,
    settings::{AdaptiveLaw, AdaptiveSettings, PairChoice},
    structured_law::{PairInput, StructuredLaw},
};
use crate::{error::IdentifyError, estimate::MotionEstimate};

/// A line that turns further than this between two frames (radians) is not interpolated; the law starts anew from it.
const LARGEST_TURN: f64 = 0.5;
/// X changes by at most about this fraction of itself in one step of the integration.
const STEP_CHANGE: f64 = 0.1;
const MAX_STEPS: usize = 64;
/// Pairs whose expected errors differ by less than this factor differ by rounding; the first of them is taken, whatever the processor.
const ALIKE: f64 = 1.0 + 1e-6;

/// The paper's adaptive identifier (section 4), over matched conjugate pairs of lines frame by frame.
///
/// Cost and memory per frame are constant; nothing is allocated.
#[derive(Debug, Clone)]
pub struct AdaptiveIdentifier {
    settings: AdaptiveSettings,
    laws: Laws,
    /// The laws before the present frame, to go back to.
    laws_before: Laws,
    qualities: [PairQuality; MAX_PAIRS],
    last: Option<Last>,
    frames: usize,
    /// Intervals between frames over which the law ran, one pair at least being followed.
    followed: usize,
}

/// The frame before.
#[derive(Debug, Clone, Copy)]
struct Last {
    time: f64,
    lines: [Line; MAX_PAIRS],
    count: usize,
}

/// The laws that run side by side: one per candidate pair while the best is still to be told, one otherwise.
#[derive(Debug, Clone)]
enum Laws {
    Three(Vec<RunningLaw<3>>),
    Four(Vec<RunningLaw<4>>),
    Six(Vec<RunningLaw<6>>),
}

impl Laws {
    /// Keeps the laws as they are in `before` and takes a frame. Returns whether the lines could be followed by any of the
    /// laws; `None` where a number did not stay finite.
    fn take(&mut self, frame: &Frame, before: &mut Self) -> Option<bool> {
        before.set_to(self);
        match self {
            Self::Three(laws) => take_all(laws, frame),
            Self::Four(laws) => take_all(laws, frame),
            Self::Six(laws) => take_all(laws, frame),
        }
    }

    /// Copies other laws of the same kind and number, without allocation.
    fn set_to(&mut self, other: &Self) {
        match (self, other) {
            (Self::Three(laws), Self::Three(other)) => laws.clone_from_slice(other),
            (Self::Four(laws), Self::Four(other)) => laws.clone_from_slice(other),
            (Self::Six(laws), Self::Six(other)) => laws.clone_from_slice(other),
            (laws, other) => *laws = other.clone(),
        }
    }
}

impl AdaptiveIdentifier {
    /// An identifier that has seen nothing yet.
    ///
    /// # Errors
    /// Am not stable, Q not symmetric positive definite, a model beyond affine, or initial values that do not fit it.
    pub fn new(settings: AdaptiveSettings) -> Result<Self, IdentifyError> {
        let lyapunov = solve_lyapunov(&settings.stability, &settings.definite)?;
        let needed = settings.model.parameter_count();
        let found = settings.initial_values.len();
        if found != 0 && found != needed {
            return Err(IdentifyError::WrongInitialValueCount { needed, found });
        }
        if let Some(index) = settings.initial_values.iter().position(|v| !v.is_finite()) {
            return Err(IdentifyError::InitialValueNotFinite { index });
        }
        let laws = match settings.model {
            MotionModel::Rigid => Laws::Three(RunningLaw::candidates(&settings, lyapunov)),
            MotionModel::Similarity => Laws::Four(RunningLaw::candidates(&settings, lyapunov)),
            MotionModel::Affine => Laws::Six(RunningLaw::candidates(&settings, lyapunov)),
            MotionModel::Projective => return Err(IdentifyError::UnsupportedModel { model: settings.model }),
        };
        let laws_before = laws.clone();
        Ok(Self { settings, laws, laws_before, qualities: Default::default(), last: None, frames: 0, followed: 0 })
    }

    /// The settings.
    #[must_use]
    pub fn settings(&self) -> &AdaptiveSettings {
        &self.settings
    }

    /// Takes the conjugate pairs of the next frame, one line of each, in the same order as in the frame before and with
    /// `Im l` of the same sign. Any time may pass between frames; over a long gap, in which a line turns too far to be
    /// followed, nothing is learned: see [`intervals_followed`](Self::intervals_followed).
    ///
    /// # Errors
    /// Time that does not advance or is not finite, another number of pairs than before, none at all, more than four, or
    /// fewer than the given pair asks for, a line that is not finite; a law that runs away to numbers that are not
    /// finite. The identifier is then as before.
    pub fn step(&mut self, time: f64, lines: &[Line]) -> Result<(), IdentifyError> {
        let count = lines.len();
        if count > MAX_PAIRS {
            return Err(IdentifyError::TooManyPairs { found: count, limit: MAX_PAIRS });
        }
        if let Some(pair) = lines.iter().position(|line| !(line.l.is_finite() && line.k.is_finite())) {
            return Err(IdentifyError::LineNotFinite { pair });
        }
        let index = if let PairChoice::Given(index) = self.settings.pairs { index } else { 0 };
        if index >= count {
            return Err(IdentifyError::NoSuchPair { index, count });
        }
        let previous = self.last.map_or(f64::NEG_INFINITY, |last| last.time);
        if !time.is_finite() || time <= previous {
            return Err(IdentifyError::TimeNotIncreasing { time, previous });
        }
        let mut padded = [lines[0]; MAX_PAIRS];
        padded[..count].copy_from_slice(&lines[..count]);
        if let Some(last) = self.last.filter(|last| last.count != count) {
            return Err(IdentifyError::PairCountChanged { expected: last.count, found: count });
        }
        let qualities_before = self.qualities;
        for (quality, line) in self.qualities.iter_mut().zip(&padded[..count]) {
            quality.take(line);
        }
        let frame = Frame { time, lines: padded, count, last: self.last, weights: weights(&self.qualities[..count]) };
        let Some(followed) = self.laws.take(&frame, &mut self.laws_before) else {
            self.laws.set_to(&self.laws_before);
            self.qualities = qualities_before;
            return Err(IdentifyError::Diverged { seconds: time - previous });
        };
        self.followed += usize::from(followed);
        self.last = Some(Last { time, lines: padded, count });
        self.frames += 1;
        Ok(())
    }

    /// Number of frames taken.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.frames
    }

    /// Over how many of the intervals between the frames the lines could be followed: nothing is learned where a line turns
    /// by more than half a radian, twice the turn of the object.
    #[must_use]
    pub fn intervals_followed(&self) -> usize {
        self.followed
    }

    /// The motion as identified so far, in the image frame; `None` before the lines were followed once. The laws give no
    /// standard deviations. All parameters are unobservable where [`is_observable`](Self::is_observable) is false.
    #[must_use]
    pub fn estimate(&self) -> Option<MotionEstimate> {
        (self.followed > 0).then(|| {
            let parameters = match &self.laws {
                Laws::Three(laws) => laws[self.chosen_law(laws.len())].parameters(),
                Laws::Four(laws) => laws[self.chosen_law(laws.len())].parameters(),
                Laws::Six(laws) => laws[self.chosen_law(laws.len())].parameters(),
            };
            let model = self.settings.model;
            let count = model.parameter_count();
            let estimate = MotionEstimate::new(model, &parameters.as_slice()[..count], None);
            if self.is_observable() { estimate } else { (0..count).fold(estimate, MotionEstimate::with_unobservable) }
        })
    }

    /// The pair that the estimate comes from, counted as in the first frame; `None` if from all.
    #[must_use]
    pub fn chosen_pair(&self) -> Option<usize> {
        match self.settings.pairs {
            PairChoice::Given(index) => Some(index),
            PairChoice::All => None,
            PairChoice::Best => Some(self.chosen_law(self.pair_count())),
        }
    }

    /// `|w| = |(l - j) / (l + j)|` of a pair, averaged over the frames: 0 where the pair tells nothing of rotation.
    #[must_use]
    pub fn rotation_content(&self, pair: usize) -> f64 {
        self.qualities.get(pair).map_or(0.0, PairQuality::magnitude)
    }

    /// Whether the pairs in use tell of the motion at all: |w| of at least one is more than noise about 0. Where none does
    /// (a circle) neither rotation nor the velocity at the origin, which depends on it, can be told.
    #[must_use]
    pub fn is_observable(&self) -> bool {
        let count = self.pair_count();
        let used = match self.settings.pairs {
            PairChoice::Given(index) => index..index + 1,
            PairChoice::Best | PairChoice::All => 0..count,
        };
        count == 0 || self.qualities[used].iter().any(|quality| quality.tells_of_rotation(count))
    }

    /// Number of pairs in each frame, 0 before the first.
    #[must_use]
    pub fn pair_count(&self) -> usize {
        self.last.map_or(0, |last| last.count)
    }

    fn chosen_law(&self, laws: usize) -> usize {
        let mut errors = self.qualities[..self.pair_count().min(laws)].iter().map(PairQuality::relative_error);
        let least = errors.clone().fold(f64::INFINITY, f64::min);
        errors.position(|error| error <= ALIKE * least).unwrap_or(0)
    }
}

/// Every law takes the frame. Returns whether any could follow the lines; `None` where a number did not stay finite.
fn take_all<const N: usize>(laws: &mut [RunningLaw<N>], frame: &Frame) -> Option<bool>
where
    Const<N>: DimMin<Const<N>, Output = Const<N>>,
{
    let followed = laws.iter_mut().fold(false, |any, law| law.take(frame) | any);
    laws.iter().all(RunningLaw::is_finite).then_some(followed)
}

/// Weights of the pairs by expected error, 1 for the best.
fn weights(qualities: &[PairQuality]) -> [f64; MAX_PAIRS] {
    let best = qualities.iter().map(PairQuality::relative_error).fold(f64::INFINITY, f64::min);
    let mut weights = [1.0; MAX_PAIRS];
    for (weight, quality) in weights.iter_mut().zip(qualities) {
        let ratio = best / quality.relative_error();
        // Before the noise is known all are taken alike.
        *weight = if ratio.is_finite() { ratio * ratio } else { 1.0 };
    }
    weights
}

/// One frame as the laws see it.
struct Frame {
    time: f64,
    lines: [Line; MAX_PAIRS],
    count: usize,
    last: Option<Last>,
    weights: [f64; MAX_PAIRS],
}

/// One law over one pair or all of them.
#[derive(Debug, Clone)]
struct RunningLaw<const N: usize> {
    law: Law<N>,
    model: MotionModel,
    /// The only pair, or all.
    pair: Option<usize>,
    states: [Vector4<f64>; MAX_PAIRS],
    filters: [FilteredPair<N>; MAX_PAIRS],
}

#[derive(Debug, Clone)]
#[expect(
    clippy::large_enum_variant,
    reason = "made once and kept in place; a box would only be followed at every step"
)]
enum Law<const N: usize> {
    Structured(StructuredLaw<N>),
    Printed(PrintedLaw),
    LeastSquares(LeastSquaresLaw<N>),
}

impl<const N: usize> RunningLaw<N>
where
    Const<N>: DimMin<Const<N>, Output = Const<N>>,
{
    fn candidates(settings: &AdaptiveSettings, lyapunov: Matrix4<f64>) -> Vec<Self> {
        let pairs: &[Option<usize>] = match settings.pairs {
            PairChoice::Best => &[Some(0), Some(1), Some(2), Some(3)],
            PairChoice::Given(index) => &[Some(index)],
            PairChoice::All => &[None],
        };
        let regressor = Regressor::new(settings.model);
        let mut initial = SVector::<f64, N>::zeros();
        initial.iter_mut().zip(&settings.initial_values).for_each(|(slot, value)| *slot = *value);
        let law = match settings.law {
            AdaptiveLaw::Structured => {
                Law::Structured(StructuredLaw::new(regressor, settings.stability, lyapunov, initial))
            }
            AdaptiveLaw::Printed => {
                let generator = settings.model.generator(initial.as_slice());
                Law::Printed(PrintedLaw::new(settings.stability, lyapunov, &affine_motion(&generator)))
            }
            AdaptiveLaw::FilteredLeastSquares => Law::LeastSquares(LeastSquaresLaw::new(regressor, initial)),
        };
        let running = |&pair: &Option<usize>| Self {
            law: law.clone(),
            model: settings.model,
            pair,
            states: [Vector4::zeros(); MAX_PAIRS],
            filters: [FilteredPair::starting_at(&Vector4::zeros()); MAX_PAIRS],
        };
        pairs.iter().map(running).collect()
    }

    fn parameters(&self) -> SVector<f64, 6> {
        let mut parameters = SVector::<f64, 6>::zeros();
        let mut fill = |values: &[f64]| parameters.as_mut_slice()[..values.len()].copy_from_slice(values);
        match &self.law {
            Law::Structured(law) => fill(law.parameters().as_slice()),
            Law::LeastSquares(law) => fill(law.parameters().as_slice()),
            Law::Printed(law) => parameters = law.parameters(self.model),
        }
        parameters
    }

    /// Takes a frame; returns whether the lines could be followed from the one before.
    fn take(&mut self, frame: &Frame) -> bool {
        let pairs = self.pair.map_or(0..frame.count, |pair| pair..pair + 1);
        if pairs.end > frame.count {
            return false;
        }
        let lines = &frame.lines[pairs.clone()];
        let paths = frame.last.and_then(|last| paths(&last.lines[pairs.clone()], lines));
        let Some(paths) = paths else {
            // The first frame, or one after a gap: the estimator starts on the lines, without an error.
            for (slot, line) in lines.iter().enumerate() {
                let state = RealVariables::from(*line).state();
                self.states[slot] = state;
                self.filters[slot] = FilteredPair::starting_at(&state);
            }
            return false;
        };
        let seconds = frame.time - frame.last.map_or(frame.time, |last| last.time);
        // A pair that is used alone has nothing to be weighed against.
        let weights = if self.pair.is_some() { [1.0; MAX_PAIRS] } else { frame.weights };
        self.advance(seconds, &paths[..lines.len()], &weights);
        if let Law::LeastSquares(law) = &mut self.law {
            law.forget(seconds);
            for (slot, line) in lines.iter().enumerate() {
                law.take(seconds, &self.filters[slot], &RealVariables::from(*line).state(), weights[slot]);
            }
        }
        true
    }

    fn is_finite(&self) -> bool {
        let finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
        finite(self.parameters().as_slice()) && self.states.iter().all(|state| finite(state.as_slice()))
    }

    /// Runs the law from one frame to the next, in steps small enough for X to change little in each.
    fn advance(&mut self, seconds: f64, paths: &[LinePath], weights: &[f64]) {
        let change = |path: &LinePath| {
            let (start, middle, end) = (path.state(0.0), path.state(0.5), path.state(1.0));
            let largest = start.norm().max(middle.norm()).max(end.norm());
            ((middle - start).norm() + (end - middle).norm()) / (1.0 + largest)
        };
        let largest = paths.iter().map(change).fold(0.0, f64::max);
        let steps = ((largest / STEP_CHANGE).ceil() as usize).clamp(1, MAX_STEPS);
        let step = seconds / steps as f64;
        for i in 0..steps {
            let middle = (i as f64 + 0.5) / steps as f64;
            let mut inputs = [PairInput { state: Vector4::zeros(), weight: 1.0 }; MAX_PAIRS];
            for ((input, path), &weight) in inputs.iter_mut().zip(paths).zip(weights) {
                *input = PairInput { state: path.state(middle), weight };
            }
            let inputs = &inputs[..paths.len()];
            match &mut self.law {
                Law::Structured(law) => law.step(step, &mut self.states[..paths.len()], inputs),
                Law::Printed(law) => {
                    for (state, input) in self.states.iter_mut().zip(inputs) {
                        law.step(step, state, input);
                    }
                }
                Law::LeastSquares(law) => {
                    for (filter, input) in self.filters.iter_mut().zip(inputs) {
                        filter.advance(step, &input.state, &law.regressor().at(&input.state));
                    }
                }
            }
        }
    }
}

/// The ways of the lines from one frame to the next; `None` where one turns too far to be interpolated.
fn paths(earlier: &[Line], later: &[Line]) -> Option<[LinePath; MAX_PAIRS]> {
    let mut paths = [LinePath::between(&earlier[0], &later[0]); MAX_PAIRS];
    for (path, (from, to)) in paths.iter_mut().zip(earlier.iter().zip(later)) {
        *path = LinePath::between(from, to);
    }
    paths[..later.len()].iter().all(|path| path.turn() < LARGEST_TURN).then_some(paths)
}

fn affine_motion(generator: &nalgebra::Matrix3<f64>) -> AffineMotion {
    let g = generator;
    AffineMotion { a1: g[(0, 0)], a2: g[(0, 1)], a3: g[(1, 0)], a4: g[(1, 1)], b1: g[(0, 2)], b2: g[(1, 2)] }
}
