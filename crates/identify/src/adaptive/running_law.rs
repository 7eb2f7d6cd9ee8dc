use freeform_decompose::{Line, MAX_PAIRS};
use freeform_riccati::{AffineMotion, MAX_PARAMETERS, MotionModel, RealVariables};
use nalgebra::{Const, DimMin, Matrix3, Matrix4, SMatrix, SVector, Vector4};

use super::{
    drem_law::DremLaw,
    least_squares_law::{FilteredPair, LeastSquaresLaw},
    line_path::LinePath,
    origin_shift::OriginShift,
    printed_law::PrintedLaw,
    regressor::Regressor,
    settings::{AdaptiveDiagnostics, AdaptiveLaw, AdaptiveSettings, PairChoice},
    structured_law::{PairInput, StructuredLaw},
};

/// A line that turns further than this between two frames (radians) is not interpolated; the law restarts from it.
const LARGEST_TURN: f64 = 0.5;
/// X changes by at most about this fraction of itself in one step of the integration.
const STEP_CHANGE: f64 = 0.1;
const MAX_STEPS: usize = 64;
/// Seconds over which the excitation is averaged: about a turn of the paper's objects.
const EXCITATION_MEMORY: f64 = 4.0;

/// One frame as the laws see it.
pub(super) struct Frame {
    pub(super) time: f64,
    pub(super) lines: [Line; MAX_PAIRS],
    pub(super) count: usize,
    pub(super) last: Option<Last>,
    pub(super) weights: [f64; MAX_PAIRS],
}

/// The frame before.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Last {
    pub(super) time: f64,
    pub(super) lines: [Line; MAX_PAIRS],
    pub(super) count: usize,
}

/// One law over one pair or all of them.
#[derive(Debug, Clone)]
pub(super) struct RunningLaw<const N: usize> {
    law: Law<N>,
    model: MotionModel,
    /// The only pair, or all.
    pair: Option<usize>,
    states: [Vector4<f64>; MAX_PAIRS],
    filters: [FilteredPair<N>; MAX_PAIRS],
    regressor: Regressor<N>,
    lyapunov: Matrix4<f64>,
    /// Mean of `sum W' W` over the last seconds.
    excitation: SMatrix<f64, N, N>,
    /// Of the last frame.
    errors: PairErrors,
}

/// How far the estimator is off over the pairs of a frame.
#[derive(Debug, Clone, Copy, Default)]
struct PairErrors {
    /// `sum |e|^2` over the pairs, weighted.
    square: f64,
    /// `sum e' P e`, weighted.
    energy: f64,
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
    Drem(DremLaw<N>),
}

impl<const N: usize> Law<N> {
    /// The sums of filtered least squares, of a law that goes by them.
    fn sums_mut(&mut self) -> Option<&mut LeastSquaresLaw<N>> {
        match self {
            Self::LeastSquares(law) => Some(law),
            Self::Drem(law) => Some(law.sums_mut()),
            Self::Structured(_) | Self::Printed(_) => None,
        }
    }
}

impl<const N: usize> RunningLaw<N>
where
    Const<N>: DimMin<Const<N>, Output = Const<N>>,
{
    pub(super) fn candidates(settings: &AdaptiveSettings, lyapunov: Matrix4<f64>) -> Vec<Self> {
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
            // Of a motion that is at most affine.
            AdaptiveLaw::Printed => {
                let generator = settings.model.generator(initial.as_slice());
                Law::Printed(PrintedLaw::new(settings.stability, lyapunov, &affine_motion(&generator)))
            }
            AdaptiveLaw::FilteredLeastSquares => Law::LeastSquares(LeastSquaresLaw::new(regressor, initial)),
            AdaptiveLaw::RegressorMixing => Law::Drem(DremLaw::new(regressor, initial)),
        };
        let running = |&pair: &Option<usize>| Self {
            law: law.clone(),
            model: settings.model,
            pair,
            states: [Vector4::zeros(); MAX_PAIRS],
            filters: [FilteredPair::starting_at(&Vector4::zeros()); MAX_PAIRS],
            regressor,
            lyapunov,
            excitation: SMatrix::zeros(),
            errors: PairErrors::default(),
        };
        pairs.iter().map(running).collect()
    }

    pub(super) fn parameters(&self) -> SVector<f64, MAX_PARAMETERS> {
        let mut parameters = SVector::<f64, MAX_PARAMETERS>::zeros();
        let mut fill = |values: &[f64]| parameters.as_mut_slice()[..values.len()].copy_from_slice(values);
        match &self.law {
            Law::Structured(law) => fill(law.parameters().as_slice()),
            Law::LeastSquares(law) => fill(law.parameters().as_slice()),
            Law::Drem(law) => fill(law.parameters().as_slice()),
            Law::Printed(law) => parameters = law.parameters(self.model),
        }
        parameters
    }

    /// The 36 numbers, of the printed law.
    pub(super) fn matrices(&self) -> Option<SMatrix<f64, 4, 9>> {
        if let Law::Printed(law) = &self.law { Some(*law.matrices()) } else { None }
    }

    /// Takes a frame; returns whether the lines could be followed from the one before.
    pub(super) fn take(&mut self, frame: &Frame) -> bool {
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
        if let Some(sums) = self.law.sums_mut() {
            sums.forget(seconds);
            for ((filter, line), weight) in self.filters.iter().zip(lines).zip(weights) {
                sums.take(seconds, filter, &RealVariables::from(*line).state(), weight);
            }
        }
        if let Law::Drem(law) = &mut self.law {
            law.adapt(seconds);
        }
        self.take_excitation(seconds, lines, &weights);
        true
    }

    /// Error of the estimator, its Lyapunov function and the excitation, after the last frame.
    pub(super) fn diagnostics(&self) -> AdaptiveDiagnostics {
        let PairErrors { square, energy } = self.errors;
        let mut regressor_square = [[0.0; MAX_PARAMETERS]; MAX_PARAMETERS];
        for (i, row) in regressor_square.iter_mut().enumerate().take(N) {
            row.iter_mut().enumerate().take(N).for_each(|(j, entry)| *entry = self.excitation[(i, j)]);
        }
        AdaptiveDiagnostics { error: square.sqrt(), energy, regressor_square, parameters: N }
    }

    /// Takes how far the estimator is off at the lines of a frame, and how they excite the parameters.
    fn take_excitation(&mut self, seconds: f64, lines: &[Line], weights: &[f64]) {
        let keep = (-seconds / EXCITATION_MEMORY).exp();
        self.excitation *= keep;
        self.errors = PairErrors::default();
        let parameters = self.parameters();
        let parameters = parameters.fixed_rows::<N>(0);
        for (slot, (line, weight)) in lines.iter().zip(weights).enumerate() {
            let x = RealVariables::from(*line).state();
            let w = self.regressor.at(&x);
            self.excitation += (1.0 - keep) * *weight * w.tr_mul(&w);
            let error = match &self.law {
                Law::Structured(_) | Law::Printed(_) => self.states[slot] - x,
                Law::LeastSquares(_) | Law::Drem(_) => self.filters[slot].error(&x, &parameters.into_owned()),
            };
            self.errors.square += weight * error.norm_squared();
            self.errors.energy += weight * error.dot(&(self.lyapunov * error));
        }
    }

    pub(super) fn shift_origin(&mut self, shift: &OriginShift, by_slopes: bool) {
        let old_from_new = shift.inverse().of_parameters(self.model);
        self.states.iter_mut().for_each(|state| *state = shift.state(state));
        self.filters.iter_mut().for_each(|filter| filter.shift_origin(shift, &old_from_new));
        match &mut self.law {
            Law::Structured(law) => law.shift_origin(shift, by_slopes),
            Law::Printed(law) => law.shift_origin(shift),
            Law::LeastSquares(law) => law.shift_origin(shift, &old_from_new),
            Law::Drem(law) => law.shift_origin(shift, &old_from_new),
        }
    }

    /// What changes with the frames. The filters run with the laws on the filtered regression alone.
    #[cfg(feature = "serde")]
    pub(super) fn numbers_mut(&mut self) -> Vec<&mut f64> {
        let mut numbers: Vec<&mut f64> = self.states.iter_mut().flat_map(|state| state.iter_mut()).collect();
        match &mut self.law {
            Law::Structured(law) => numbers.extend(law.numbers_mut()),
            Law::Printed(law) => numbers.extend(law.numbers_mut()),
            Law::LeastSquares(law) => {
                numbers.extend(law.numbers_mut());
                numbers.extend(self.filters.iter_mut().flat_map(FilteredPair::numbers_mut));
            }
            Law::Drem(law) => {
                numbers.extend(law.numbers_mut());
                numbers.extend(self.filters.iter_mut().flat_map(FilteredPair::numbers_mut));
            }
        }
        numbers.extend(self.excitation.iter_mut());
        numbers.extend([&mut self.errors.square, &mut self.errors.energy]);
        numbers
    }

    /// Whether the linear part of the motion follows the slopes alone, where the law knows such a thing.
    #[cfg(feature = "serde")]
    pub(super) fn by_slopes_mut(&mut self) -> Option<&mut bool> {
        match &mut self.law {
            Law::Structured(law) => Some(law.by_slopes_mut()),
            Law::Printed(_) | Law::LeastSquares(_) | Law::Drem(_) => None,
        }
    }

    pub(super) fn is_finite(&self) -> bool {
        let finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
        finite(self.parameters().as_slice())
            && finite(self.excitation.as_slice())
            && finite(&[self.errors.square, self.errors.energy])
            && self.states.iter().all(|state| finite(state.as_slice()))
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
                Law::LeastSquares(_) | Law::Drem(_) => {
                    for (filter, input) in self.filters.iter_mut().zip(inputs) {
                        filter.advance(step, &input.state, &self.regressor.at(&input.state));
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

fn affine_motion(generator: &Matrix3<f64>) -> AffineMotion {
    let g = generator;
    AffineMotion { a1: g[(0, 0)], a2: g[(0, 1)], a3: g[(1, 0)], a4: g[(1, 1)], b1: g[(0, 2)], b2: g[(1, 2)] }
}
