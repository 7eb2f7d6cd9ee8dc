//! The identifier of one object, whichever method it is.
use freeform_motion::curve_fit::{Fit, Outline};
use freeform_motion::estimate::{MotionEstimate, MotionState, PointVelocity};
use freeform_motion::outline_filter::{FilterSettings, MotionFilter, Phase};
use freeform_motion::{Pipeline, PipelineSettings};

use crate::args::{IdentifyMethod, TrackOptions};
use crate::failure::Failure;
use crate::output::significant;
use crate::turns::Turns;

/// Share of rejected frames that is worth a warning.
const MANY_REJECTED: f64 = 0.05;

/// What is known of one object.
#[derive(Debug)]
pub(crate) enum Identifier {
    /// The paper's identifier on the lines of fitted curves.
    Adaptive(Box<Pipeline>),
    /// The motion filter on the points of the outlines.
    Filter(Box<TrackedObject>),
}

/// A filter, and what it knew before it began to look for the object again.
#[derive(Debug)]
pub(crate) struct TrackedObject {
    filter: MotionFilter,
    /// Time in seconds and motion when it was last known.
    last_known: Option<(f64, MotionEstimate)>,
}

/// What became of one frame.
#[derive(Debug)]
pub(crate) struct Step {
    /// What the identifier is doing; `None` where it could not take the frame at all.
    pub(crate) phase: Option<&'static str>,
    pub(crate) estimate: Option<MotionEstimate>,
    pub(crate) fit: Option<Fit>,
    /// Root mean square distance of the points from the curve, or this frame's noise, in image lengths.
    pub(crate) residual: Option<f64>,
    /// Squared innovation of pose and motion, as a filter gives it.
    pub(crate) innovation: Option<f64>,
    /// Pose and motion, where the method tells them.
    pub(crate) state: Option<MotionState>,
    /// Turns that the outlines do not decide between.
    pub(crate) ambiguity: Option<Turns>,
    pub(crate) rejected_because: Option<String>,
}

impl Identifier {
    /// One that has seen nothing yet.
    pub(crate) fn new(options: &TrackOptions) -> Result<Self, Failure> {
        Ok(match options.method {
            IdentifyMethod::Adaptive => {
                let pipeline = Pipeline::new(pipeline_settings(options)).map_err(Failure::unusable)?;
                Self::Adaptive(Box::new(pipeline))
            }
            IdentifyMethod::Filter => {
                let filter = MotionFilter::new(filter_settings(options)).map_err(Failure::unusable)?;
                Self::Filter(Box::new(TrackedObject { filter, last_known: None }))
            }
        })
    }

    /// Takes the outline seen at a time in seconds.
    pub(crate) fn push(&mut self, time: f64, outline: &Outline) -> Step {
        match self {
            Self::Adaptive(pipeline) => match pipeline.push(time, outline) {
                Ok(result) => {
                    let phase = if result.estimate.is_some() { "adapt" } else { "start" };
                    let residual = Some(result.fit.diagnostics().geometric_residual);
                    let (estimate, fit) = (result.estimate, Some(result.fit));
                    Step { phase: Some(phase), estimate, fit, residual, ..Step::EMPTY }
                }
                Err(error) => Step::refused(&error),
            },
            Self::Filter(object) => match object.filter.step(time, outline) {
                Ok(step) => {
                    let estimate = object.filter.estimate();
                    object.last_known = estimate.map(|estimate| (time, estimate)).or(object.last_known);
                    let rejected_because = step.rejection.map(|rejection| rejection.to_string());
                    let residual = step.update.and_then(|update| update.noise);
                    let innovation = step.update.map(|update| update.innovation);
                    let (phase, state) = (Some(phase_name(step.phase)), object.filter.state());
                    let ambiguity = object.filter.ambiguity().map(Turns::from);
                    Step { phase, estimate, residual, innovation, state, ambiguity, rejected_because, ..Step::EMPTY }
                }
                Err(error) => Step::refused(&error),
            },
        }
    }

    /// The motion as it was last known; `None` before two frames were used.
    pub(crate) fn estimate(&self) -> Option<MotionEstimate> {
        match self {
            Self::Adaptive(pipeline) => pipeline.estimate(),
            Self::Filter(object) => object.last_known.map(|(_, estimate)| estimate),
        }
    }

    /// Velocity of the middle of the object at the end, where the method tells it and it is known.
    pub(crate) fn velocity(&self) -> Option<PointVelocity> {
        match self {
            Self::Filter(object) => object.filter.velocity(),
            Self::Adaptive(_) => None,
        }
    }

    /// Turns that the outlines do not decide between, if any.
    pub(crate) fn ambiguity(&self) -> Option<Turns> {
        match self {
            Self::Filter(object) => object.filter.ambiguity().map(Turns::from),
            Self::Adaptive(_) => None,
        }
    }

    /// Whether the motion was seen to change, which a smoother that takes it for constant does not know.
    pub(crate) fn motion_changed(&self) -> bool {
        matches!(self, Self::Filter(object) if object.filter.motion_changed())
    }

    /// What a user should know of the result, one line each.
    pub(crate) fn warnings(&self) -> Vec<String> {
        match self {
            Self::Adaptive(pipeline) => pipeline.warnings(),
            Self::Filter(object) => {
                let filter = &object.filter;
                let frames = (filter.frames_accepted(), filter.frames_rejected());
                let ambiguity = self.ambiguity();
                let ambiguous = ambiguity.as_ref().map_or(&[][..], |turns| &turns.parameters);
                let mut warnings =
                    filter_warnings(object.last_known.as_ref(), ambiguous, filter.phase(), filter.restarts(), frames);
                if let Some(turns) = ambiguity {
                    warnings.push(format!("ambiguous: {turns}"));
                }
                if filter.motion_changed() {
                    warnings.push("the motion changed on the way: these are its values at the end".to_owned());
                }
                warnings
            }
        }
    }
}

fn filter_warnings(
    last_known: Option<&(f64, MotionEstimate)>,
    ambiguous: &[&str],
    phase: Phase,
    restarts: usize,
    (accepted, rejected): (usize, usize),
) -> Vec<String> {
    let mut warnings = Vec::new();
    if let Some((_, estimate)) = last_known {
        let unknown = estimate.parameters().filter(|p| p.value.is_none()).map(|p| p.name);
        let unknown: Vec<_> = unknown.filter(|name| !ambiguous.contains(name)).collect();
        if !unknown.is_empty() {
            warnings.push(format!("not observable from these outlines: {}", unknown.join(", ")));
        }
    }
    match (phase, last_known) {
        (Phase::Lost, _) => warnings.push("the object was lost at the end".to_owned()),
        (Phase::Acquiring, Some((time, _))) => {
            warnings.push(format!(
                "the object was looked for again at the end; this is its motion at {} s",
                significant(*time, 4)
            ));
        }
        _ => {}
    }
    if restarts > 0 {
        warnings.push(format!("given up and begun anew {restarts} time(s)"));
    }
    let frames = accepted + rejected;
    if rejected as f64 > MANY_REJECTED * frames as f64 {
        warnings.push(format!("{rejected} of {frames} frames rejected"));
    }
    warnings
}

impl Step {
    const EMPTY: Self = Self {
        phase: None,
        estimate: None,
        fit: None,
        residual: None,
        innovation: None,
        state: None,
        ambiguity: None,
        rejected_because: None,
    };

    fn refused(error: &dyn std::error::Error) -> Self {
        Self { rejected_because: Some(with_causes(error)), ..Self::EMPTY }
    }
}

/// What the options ask of a pipeline.
pub(crate) fn pipeline_settings(options: &TrackOptions) -> PipelineSettings {
    let mut settings = PipelineSettings::for_model(options.motion.model());
    if let Some(degree) = options.degree {
        settings.fit.degree = degree;
    }
    settings
}

/// What the options ask of the filter.
pub(crate) fn filter_settings(options: &TrackOptions) -> FilterSettings {
    FilterSettings { model: options.motion.model(), ..FilterSettings::default() }
}

fn phase_name(phase: Phase) -> &'static str {
    match phase {
        Phase::Waiting => "waiting",
        Phase::Acquiring => "acquiring",
        Phase::Tracking => "tracking",
        Phase::Lost => "lost",
    }
}

/// An error and what caused it, without what its own text already says.
fn with_causes(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut source = error.source();
    while let Some(cause) = source {
        let cause_text = cause.to_string();
        if !text.contains(&cause_text) {
            text = format!("{text}: {cause_text}");
        }
        source = cause.source();
    }
    text
}
