use freeform_curve_fit::{Fit, FitError, FitSettings, Fitter, Method, Outline, SettingsError};
use freeform_decompose::{Correspondence, CorrespondenceError, Decomposition, DecompositionError, Line};
use freeform_identify::{AdaptiveIdentifier, AdaptiveSettings, IdentifyError, MotionEstimate};

/// Largest number of conjugate pairs, that of an octic.
const MAX_PAIRS: usize = 4;

/// Settings of a [`Pipeline`].
#[derive(Debug, Clone, PartialEq)]
pub struct PipelineSettings {
    /// How a curve is fitted to every outline.
    pub fit: FitSettings,
    /// How the motion is identified from its lines.
    pub identify: AdaptiveSettings,
}

impl Default for PipelineSettings {
    /// A bounded quartic, rounder than the one that follows the outline best: a ridge and a large margin keep the lines
    /// of the leading form away from real ones, whose slopes swing far out as they turn and carry their noise with them.
    fn default() -> Self {
        let method = Method::Bounded { margin: 0.5, ridge_weight: 0.03 };
        let fit = FitSettings { method, offset: 0.15, ..FitSettings::default() };
        Self { fit, identify: AdaptiveSettings::default() }
    }
}

/// What one frame gave.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameResult {
    /// The fitted curve.
    pub fit: Fit,
    /// Its lines, in image coordinates.
    pub decomposition: Decomposition,
    /// How the pairs of lines were matched to the frame before; `None` in the first frame.
    pub correspondence: Option<Correspondence>,
    /// The motion as identified so far; `None` before the second frame.
    pub estimate: Option<MotionEstimate>,
}

/// Why a frame gave nothing, or a pipeline could not be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PipelineError {
    /// The settings of the fit are refused.
    #[error("fit settings: {0}")]
    FitSettings(#[from] SettingsError),
    /// No curve could be fitted.
    #[error("no fit: {0}")]
    Fit(#[from] FitError),
    /// The curve has no decomposition into lines.
    #[error("no line decomposition: {0}")]
    Decomposition(#[from] DecompositionError),
    /// The lines could not be matched to those of the frame before.
    #[error("lines not matched: {0}")]
    Correspondence(#[from] CorrespondenceError),
    /// The identifier refused its settings or the lines.
    #[error("not identified: {0}")]
    Identify(#[from] IdentifyError),
    /// The fitted curve is not bounded, so that some of its lines are real.
    #[error("the fitted curve is not bounded (margin {margin:.1e})")]
    NotBounded {
        /// Minimum of the leading form on the unit circle over its root mean square.
        margin: f64,
    },
}

/// From outlines to motion, frame by frame: fit, decompose, match, identify.
///
/// In steady state a frame costs no allocation.
#[derive(Debug, Clone)]
pub struct Pipeline {
    fitter: Fitter,
    identifier: AdaptiveIdentifier,
    last: Option<MatchedFrame>,
    frames: usize,
    frames_rejected: usize,
}

/// The lines of a frame and in which order its pairs continue those of the first frame.
#[derive(Debug, Clone, Copy)]
struct MatchedFrame {
    decomposition: Decomposition,
    order: [usize; MAX_PAIRS],
}

impl Pipeline {
    /// A pipeline that has seen nothing yet.
    ///
    /// # Errors
    /// A setting outside its range.
    pub fn new(settings: PipelineSettings) -> Result<Self, PipelineError> {
        Ok(Self {
            fitter: Fitter::new(settings.fit)?,
            identifier: AdaptiveIdentifier::new(settings.identify)?,
            last: None,
            frames: 0,
            frames_rejected: 0,
        })
    }

    /// Takes the next outline of the object, at `time` in seconds. After an error the pipeline is as if the frame had
    /// been missing, and counts it as rejected.
    ///
    /// # Errors
    /// Time that does not advance, an outline that cannot be fitted, decomposed or matched.
    pub fn push(&mut self, time: f64, outline: &Outline) -> Result<FrameResult, PipelineError> {
        self.frames += 1;
        let result = self.take(time, outline);
        self.frames_rejected += usize::from(result.is_err());
        result
    }

    fn take(&mut self, time: f64, outline: &Outline) -> Result<FrameResult, PipelineError> {
        let fit = self.fitter.fit(outline)?;
        let Some(curve) = fit.bounded_working() else {
            return Err(PipelineError::NotBounded { margin: fit.diagnostics().boundedness_margin });
        };
        // Decomposed where the fit is well-conditioned; the lines are then moved exactly.
        let normalisation = fit.normalisation();
        let decomposition = Decomposition::of(curve.polynomial())?.moved(&normalisation.image_from_working())?;
        let (matched, correspondence) = self.matched(decomposition, normalisation.radius)?;
        let (lines, count) = matched.lines();
        self.identifier.step(time, &lines[..count])?;
        self.last = Some(matched);
        Ok(FrameResult { fit, decomposition, correspondence, estimate: self.estimate() })
    }

    /// Finds which pair continues which.
    fn matched(
        &self,
        decomposition: Decomposition,
        object_size: f64,
    ) -> Result<(MatchedFrame, Option<Correspondence>), CorrespondenceError> {
        let mut order = [0, 1, 2, 3];
        let Some(last) = &self.last else { return Ok((MatchedFrame { decomposition, order }, None)) };
        let correspondence = Correspondence::between(&last.decomposition, &decomposition, object_size)?;
        for (slot, &before) in order.iter_mut().zip(&last.order).take(correspondence.permutation().len()) {
            *slot = correspondence.permutation()[before];
        }
        Ok((MatchedFrame { decomposition, order }, Some(correspondence)))
    }

    /// The motion as identified so far, in the image frame; `None` before the second frame.
    #[must_use]
    pub fn estimate(&self) -> Option<MotionEstimate> {
        self.identifier.estimate()
    }

    /// The identifier, for what it says beside the estimate.
    #[must_use]
    pub fn identifier(&self) -> &AdaptiveIdentifier {
        &self.identifier
    }

    /// Frames taken, rejected ones included.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.frames
    }

    /// Frames that gave nothing.
    #[must_use]
    pub fn frames_rejected(&self) -> usize {
        self.frames_rejected
    }

    /// What a user should know of the result, one line each.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        Vec::new()
    }
}

impl MatchedFrame {
    /// One line of each conjugate pair, in the order of the first frame, and how many there are.
    fn lines(&self) -> ([Line; MAX_PAIRS], usize) {
        let pairs = self.decomposition.conjugate_pairs(self.decomposition.degree().value());
        let mut found = [self.decomposition.level(self.decomposition.degree().value())[0]; MAX_PAIRS];
        let mut count = 0;
        for (slot, line) in found.iter_mut().zip(pairs) {
            *slot = *line;
            count += 1;
        }
        let mut ordered = found;
        ordered.iter_mut().zip(&self.order).take(count).for_each(|(slot, &pair)| *slot = found[pair]);
        (ordered, count)
    }
}
