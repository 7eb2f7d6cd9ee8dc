use freeform_decompose::{Line, MAX_PAIRS};
use freeform_estimate::{MotionEstimate, TimeNotIncreasing};
use freeform_riccati::MotionModel;
use nalgebra::{Const, DimMin, SMatrix, Vector2};

use super::{
    lyapunov::solve_lyapunov,
    origin_shift::OriginShift,
    pair_quality::PairQuality,
    running_law::{Frame, Last, RunningLaw},
    settings::{AdaptiveDiagnostics, AdaptiveLaw, AdaptiveSettings, PairChoice},
};
use crate::error::IdentifyError;

/// An origin that moves faster than this, in lengths per second, lets the structured law take the linear part of the
/// motion from the slopes alone. Objects are about of size 1, and the gains of the paper of rate 1 per second.
const FAST_TRAVEL: f64 = 0.8;
/// Pairs whose expected errors differ by less than this factor differ by rounding; the first of them is taken, whatever the
/// processor.
const ALIKE: f64 = 1.0 + 1e-6;

/// The paper's adaptive identifier (section 4), over matched conjugate pairs of lines frame by frame.
///
/// Cost and memory per frame are constant; nothing is allocated.
#[derive(Debug, Clone)]
pub struct AdaptiveIdentifier {
    pub(super) settings: AdaptiveSettings,
    pub(super) laws: Laws,
    /// The laws before the present frame, to go back to.
    pub(super) laws_before: Laws,
    pub(super) qualities: [PairQuality; MAX_PAIRS],
    pub(super) last: Option<Last>,
    /// Time of the last frame before the origin moved, or of the first frame.
    pub(super) origin_since: f64,
    pub(super) frames: usize,
    /// Intervals between frames over which the law ran, one pair at least being followed.
    pub(super) followed: usize,
}

/// The laws that run side by side: one per candidate pair until the best pair is known, then one.
#[derive(Debug, Clone)]
pub(super) enum Laws {
    Three(Vec<RunningLaw<3>>),
    Four(Vec<RunningLaw<4>>),
    Six(Vec<RunningLaw<6>>),
    Eight(Vec<RunningLaw<8>>),
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
            Self::Eight(laws) => take_all(laws, frame),
        }
    }

    /// Copies other laws of the same kind and number, without allocation.
    fn set_to(&mut self, other: &Self) {
        match (self, other) {
            (Self::Three(laws), Self::Three(other)) => laws.clone_from_slice(other),
            (Self::Four(laws), Self::Four(other)) => laws.clone_from_slice(other),
            (Self::Six(laws), Self::Six(other)) => laws.clone_from_slice(other),
            (Self::Eight(laws), Self::Eight(other)) => laws.clone_from_slice(other),
            (laws, other) => *laws = other.clone(),
        }
    }

    /// What changes with the frames, law by law.
    #[cfg(feature = "serde")]
    pub(super) fn numbers_mut(&mut self) -> Vec<&mut f64> {
        match self {
            Self::Three(laws) => laws.iter_mut().flat_map(RunningLaw::numbers_mut).collect(),
            Self::Four(laws) => laws.iter_mut().flat_map(RunningLaw::numbers_mut).collect(),
            Self::Six(laws) => laws.iter_mut().flat_map(RunningLaw::numbers_mut).collect(),
            Self::Eight(laws) => laws.iter_mut().flat_map(RunningLaw::numbers_mut).collect(),
        }
    }

    /// Whether the linear part of the motion follows the slopes alone, for each law that knows such a thing.
    #[cfg(feature = "serde")]
    pub(super) fn by_slopes_mut(&mut self) -> Vec<&mut bool> {
        match self {
            Self::Three(laws) => laws.iter_mut().filter_map(RunningLaw::by_slopes_mut).collect(),
            Self::Four(laws) => laws.iter_mut().filter_map(RunningLaw::by_slopes_mut).collect(),
            Self::Six(laws) => laws.iter_mut().filter_map(RunningLaw::by_slopes_mut).collect(),
            Self::Eight(laws) => laws.iter_mut().filter_map(RunningLaw::by_slopes_mut).collect(),
        }
    }

    /// Whether every law can go on from its numbers.
    #[cfg(feature = "serde")]
    pub(super) fn is_finite(&self) -> bool {
        match self {
            Self::Three(laws) => laws.iter().all(RunningLaw::is_finite),
            Self::Four(laws) => laws.iter().all(RunningLaw::is_finite),
            Self::Six(laws) => laws.iter().all(RunningLaw::is_finite),
            Self::Eight(laws) => laws.iter().all(RunningLaw::is_finite),
        }
    }

    fn shift_origin(&mut self, shift: &OriginShift, by_slopes: bool) {
        match self {
            Self::Three(laws) => laws.iter_mut().for_each(|law| law.shift_origin(shift, by_slopes)),
            Self::Four(laws) => laws.iter_mut().for_each(|law| law.shift_origin(shift, by_slopes)),
            Self::Six(laws) => laws.iter_mut().for_each(|law| law.shift_origin(shift, by_slopes)),
            Self::Eight(laws) => laws.iter_mut().for_each(|law| law.shift_origin(shift, by_slopes)),
        }
    }
}

impl AdaptiveIdentifier {
    /// An identifier that has seen nothing yet.
    ///
    /// # Errors
    /// Am not stable, Q not symmetric positive definite, the printed law for projective motion, or initial values that do not fit it.
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
            MotionModel::Projective if settings.law == AdaptiveLaw::Printed => {
                return Err(IdentifyError::UnsupportedModel { model: settings.model });
            }
            MotionModel::Projective => Laws::Eight(RunningLaw::candidates(&settings, lyapunov)),
        };
        let laws_before = laws.clone();
        Ok(Self {
            settings,
            laws,
            laws_before,
            qualities: Default::default(),
            last: None,
            origin_since: 0.0,
            frames: 0,
            followed: 0,
        })
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
        TimeNotIncreasing::check(previous, time)?;
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
        if self.last.is_none() {
            self.origin_since = time;
        }
        self.last = Some(Last { time, lines: padded, count });
        self.frames += 1;
        Ok(())
    }

    /// Goes on in coordinates whose origin lies at `origin` of the present ones: the lines of later frames are taken to
    /// be in them, and the estimate is.
    ///
    /// Far from the origin k is as noisy as it is large, and the laws, which take all entries of X alike, follow its noise.
    pub fn shift_origin(&mut self, origin: Vector2<f64>) {
        let now = self.last.map_or(self.origin_since, |last| last.time);
        let by_slopes = origin.norm() > FAST_TRAVEL * (now - self.origin_since);
        self.origin_since = now;
        let shift = OriginShift::to(origin);
        self.laws.shift_origin(&shift, by_slopes);
        if let Some(last) = &mut self.last {
            last.lines.iter_mut().for_each(|line| *line = shift.line(line));
        }
    }

    /// Number of frames taken.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.frames
    }

    /// Number of lines of a frame; `None` before the first.
    #[must_use]
    pub fn line_count(&self) -> Option<usize> {
        self.last.as_ref().map(|last| last.count)
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
                Laws::Eight(laws) => laws[self.chosen_law(laws.len())].parameters(),
            };
            let model = self.settings.model;
            let count = model.parameter_count();
            let estimate = MotionEstimate::new(model, &parameters.as_slice()[..count], None);
            if self.is_observable() { estimate } else { (0..count).fold(estimate, MotionEstimate::with_unobservable) }
        })
    }

    /// Error, Lyapunov function and excitation of the law that the [estimate](Self::estimate) comes from; `None` as there.
    #[must_use]
    pub fn diagnostics(&self) -> Option<AdaptiveDiagnostics> {
        (self.followed > 0).then(|| match &self.laws {
            Laws::Three(laws) => laws[self.chosen_law(laws.len())].diagnostics(),
            Laws::Four(laws) => laws[self.chosen_law(laws.len())].diagnostics(),
            Laws::Six(laws) => laws[self.chosen_law(laws.len())].diagnostics(),
            Laws::Eight(laws) => laws[self.chosen_law(laws.len())].diagnostics(),
        })
    }

    /// The 36 numbers `[A | C | B]` of equation 19 (4 by 9) as the printed law has adapted them so far, in the coordinates of the lines;
    /// `None` for the other laws, and before the lines were followed once. Those of a motion are [`plant_matrices`](crate::plant_matrices).
    #[must_use]
    pub fn matrices(&self) -> Option<SMatrix<f64, 4, 9>> {
        match &self.laws {
            _ if self.followed == 0 => None,
            Laws::Three(laws) => laws[self.chosen_law(laws.len())].matrices(),
            Laws::Four(laws) => laws[self.chosen_law(laws.len())].matrices(),
            Laws::Six(laws) => laws[self.chosen_law(laws.len())].matrices(),
            Laws::Eight(laws) => laws[self.chosen_law(laws.len())].matrices(),
        }
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

    /// `|w| = |(l - j) / (l + j)|` of a pair, averaged over the frames: 0 if the pair contains no information on rotation.
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
            PairChoice::Given(index) => index..index.saturating_add(1),
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
