//! The identifier of one object, whichever method it is.
use freeform_motion::curve_fit::{Fit, Outline};
use freeform_motion::identify::{FilterSettings, FilterStep, MotionEstimate, MotionFilter, Phase};
use freeform_motion::{Pipeline, PipelineSettings};

use crate::args::{IdentifyMethod, TrackOptions};
use crate::failure::Failure;

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

/// The filter, and what it knew before it began to look for the object again.
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
                    let (estimate, fit) = (result.estimate, Some(result.fit));
                    Step { phase: Some(phase), estimate, fit, rejected_because: None }
                }
                Err(error) => Step::refused(&error),
            },
            Self::Filter(object) => match object.filter.step(time, outline) {
                Ok(step) => {
                    let estimate = object.filter.estimate();
                    object.last_known = estimate.map(|estimate| (time, estimate)).or(object.last_known);
                    let rejected_because = (!step.accepted).then(|| why_rejected(&step, object.filter.settings()));
                    Step { phase: Some(phase_name(step.phase)), estimate, fit: None, rejected_because }
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

    /// What a user should know of the result, one line each.
    pub(crate) fn warnings(&self) -> Vec<String> {
        match self {
            Self::Adaptive(pipeline) => pipeline.warnings(),
            Self::Filter(object) => object.warnings(),
        }
    }
}

impl TrackedObject {
    fn warnings(&self) -> Vec<String> {
        let Self { filter, last_known } = self;
        let mut warnings = Vec::new();
        if let Some((_, estimate)) = last_known {
            let unknown: Vec<_> = estimate.parameters().filter(|p| p.value.is_none()).map(|p| p.name).collect();
            if !unknown.is_empty() {
                warnings.push(format!("not observable from these outlines: {}", unknown.join(", ")));
            }
        }
        match (filter.phase(), last_known) {
            (Phase::Lost, _) => warnings.push("the object was lost at the end".to_owned()),
            (Phase::Acquiring, Some((time, _))) => {
                warnings.push(format!("the object was looked for again at the end; this is its motion at {time} s"));
            }
            _ => {}
        }
        if filter.restarts() > 0 {
            warnings.push(format!("given up and begun anew {} time(s)", filter.restarts()));
        }
        let (rejected, frames) = (filter.frames_rejected(), filter.frames_rejected() + filter.frames_accepted());
        if rejected as f64 > MANY_REJECTED * frames as f64 {
            warnings.push(format!("{rejected} of {frames} frames rejected"));
        }
        warnings
    }
}

impl Step {
    fn refused(error: &dyn std::error::Error) -> Self {
        Self { phase: None, estimate: None, fit: None, rejected_because: Some(with_causes(error)) }
    }
}

/// What the options ask of a pipeline.
pub(crate) fn pipeline_settings(options: &TrackOptions) -> PipelineSettings {
    let mut settings = PipelineSettings::default();
    settings.identify.model = options.motion.model();
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

fn why_rejected(step: &FilterStep, settings: &FilterSettings) -> String {
    match step.update {
        Some(update) if update.agreement < settings.smallest_agreement => {
            format!("does not fit the object, {:.0} % of the points lie on its outline", 100.0 * update.agreement)
        }
        Some(update) => {
            format!("does not go on from the frames before it, squared innovation {:.0}", update.innovation)
        }
        None => "the object was not found".to_owned(),
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
