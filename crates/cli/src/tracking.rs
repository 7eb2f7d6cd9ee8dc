//! One pipeline per object, and what each frame gave.
use std::collections::HashMap;

use freeform_motion::identify::{MotionEstimate, ParameterEstimate};
use freeform_motion::outline_io::{OutlineFrame, ReadError, ReadErrorKind};
use freeform_motion::riccati::MotionModel;
use freeform_motion::{FrameResult, Pipeline, PipelineSettings};
use nalgebra::Matrix3;

use crate::args::{IdentifyMethod, TrackOptions};
use crate::failure::Failure;
use crate::input::{Input, unreadable};
use crate::progress::Progress;

/// Reasons of rejected frames kept for each object.
const REASONS_KEPT: usize = 10;

/// What a frame of an object gave.
#[derive(Debug)]
pub(crate) struct Observation {
    pub(crate) object: String,
    pub(crate) frame: u64,
    /// In seconds; `None` where the outline could not be read.
    pub(crate) time: Option<f64>,
    /// The result, or why the frame was rejected.
    pub(crate) outcome: Result<Accepted, String>,
}

/// What a frame gave that was not rejected.
#[derive(Debug)]
pub(crate) struct Accepted {
    pub(crate) phase: &'static str,
    pub(crate) result: FrameResult,
    pub(crate) estimate: Option<Estimate>,
}

/// An identified motion as it is reported: finite, and in space where a camera scale was given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Estimate(MotionEstimate);

impl Estimate {
    /// `None` where a number is not finite: the identifier has diverged.
    pub(crate) fn of(estimate: MotionEstimate, scale: Option<f64>) -> Option<Self> {
        let estimate = scale.map_or(estimate, |scale| estimate.in_space(scale));
        let is_finite = |p: ParameterEstimate| {
            p.value.is_none_or(f64::is_finite) && p.standard_deviation.is_none_or(f64::is_finite)
        };
        estimate.parameters().all(is_finite).then_some(Self(estimate))
    }

    /// The parameters in the order of the model.
    pub(crate) fn parameters(&self) -> impl Iterator<Item = ParameterEstimate> + '_ {
        self.0.parameters()
    }

    /// The generator of the motion; `None` where a parameter is not observable.
    pub(crate) fn generator(&self) -> Option<Matrix3<f64>> {
        let generator = self.0.generator();
        let known = self.parameters().all(|p| p.value.is_some()) && generator.iter().all(|a| a.is_finite());
        known.then_some(generator)
    }
}

/// What was found for an object in the end.
#[derive(Debug)]
pub(crate) struct ObjectResult {
    pub(crate) object: String,
    pub(crate) method: IdentifyMethod,
    pub(crate) motion: MotionModel,
    pub(crate) frames: usize,
    pub(crate) frames_rejected: usize,
    pub(crate) estimate: Option<Estimate>,
    pub(crate) warnings: Vec<String>,
}

/// Follows every object of a sequence.
#[derive(Debug)]
pub(crate) struct Tracking {
    settings: PipelineSettings,
    motion: MotionModel,
    method: IdentifyMethod,
    scale: Option<f64>,
    objects: Vec<Object>,
    positions: HashMap<String, usize>,
}

#[derive(Debug)]
struct Object {
    name: String,
    pipeline: Pipeline,
    /// Frames whose outline could not be read.
    unread: usize,
    reasons: Vec<String>,
    reasons_left_out: usize,
}

impl Tracking {
    /// With no object yet.
    pub(crate) fn new(options: &TrackOptions) -> Result<Self, Failure> {
        let motion = options.motion.model();
        let mut settings = PipelineSettings::default();
        settings.identify.model = motion;
        if let Some(degree) = options.degree {
            settings.fit.degree = degree;
        }
        // Settings are refused before anything is read.
        Pipeline::new(settings.clone()).map_err(Failure::unusable)?;
        Ok(Self {
            settings,
            motion,
            method: options.method,
            scale: options.scale,
            objects: Vec::new(),
            positions: HashMap::new(),
        })
    }

    /// Takes all frames of an input and hands on what each gave, with the frame itself where it could be read. Returns the error that ended the reading, if any; what
    /// came before it has been taken.
    pub(crate) fn read(
        &mut self,
        input: Input,
        mut observe: impl FnMut(Observation, Option<&OutlineFrame>) -> Result<(), Failure>,
    ) -> Result<Option<Failure>, Failure> {
        let progress = Progress::of_frames(None);
        for item in input.outlines {
            match item {
                Ok(frame) => observe(self.push(&frame)?, Some(&frame))?,
                Err(error) if error.is_recoverable() => {
                    if let Some(observation) = self.reject(&error)? {
                        observe(observation, None)?;
                    }
                }
                Err(error) => return Ok(Some(unreadable(&error))),
            }
            progress.advance();
        }
        Ok(None)
    }

    /// Takes the next frame of an object.
    pub(crate) fn push(&mut self, frame: &OutlineFrame) -> Result<Observation, Failure> {
        let (method, scale) = (self.method, self.scale);
        let object = self.object(&frame.object)?;
        let outcome = match object.pipeline.push(frame.time, &frame.outline) {
            Ok(result) => Ok(accepted(method, scale, result)),
            Err(error) => {
                let reason = format!("frame {} of object {:?}: {}", frame.frame, frame.object, with_causes(&error));
                object.note(&reason);
                Err(reason)
            }
        };
        Ok(Observation { object: frame.object.clone(), frame: frame.frame, time: Some(frame.time), outcome })
    }

    /// Takes note of a frame whose points are no outline.
    fn reject(&mut self, error: &ReadError) -> Result<Option<Observation>, Failure> {
        let ReadErrorKind::Degenerate { object, frame, .. } = &error.kind else { return Ok(None) };
        let reason = error.to_string();
        let entry = self.object(object)?;
        entry.unread += 1;
        entry.note(&reason);
        Ok(Some(Observation { object: object.clone(), frame: *frame, time: None, outcome: Err(reason) }))
    }

    /// The results so far, in the order in which the objects first appeared.
    pub(crate) fn results(&self) -> Vec<ObjectResult> {
        self.objects.iter().map(|object| self.result(object)).collect()
    }

    fn result(&self, object: &Object) -> ObjectResult {
        let raw = object.pipeline.estimate();
        let estimate = raw.and_then(|estimate| Estimate::of(estimate, self.scale));
        let mut warnings = object.pipeline.warnings();
        if raw.is_some() && estimate.is_none() {
            warnings.push("the identifier diverged: its numbers are not finite".to_owned());
        }
        warnings.extend(object.reasons.iter().map(|reason| format!("rejected: {reason}")));
        if object.reasons_left_out > 0 {
            warnings.push(format!("rejected: {} more frame(s)", object.reasons_left_out));
        }
        ObjectResult {
            object: object.name.clone(),
            method: self.method,
            motion: self.motion,
            frames: object.pipeline.frames() + object.unread,
            frames_rejected: object.pipeline.frames_rejected() + object.unread,
            estimate,
            warnings,
        }
    }

    fn object(&mut self, name: &str) -> Result<&mut Object, Failure> {
        let position = match self.positions.get(name) {
            Some(position) => *position,
            None => {
                let pipeline = Pipeline::new(self.settings.clone()).map_err(Failure::unusable)?;
                let (name, position) = (name.to_owned(), self.objects.len());
                self.positions.insert(name.clone(), position);
                self.objects.push(Object { name, pipeline, unread: 0, reasons: Vec::new(), reasons_left_out: 0 });
                position
            }
        };
        Ok(&mut self.objects[position])
    }
}

impl Object {
    fn note(&mut self, reason: &str) {
        if self.reasons.len() < REASONS_KEPT {
            self.reasons.push(reason.to_owned());
        } else {
            self.reasons_left_out += 1;
        }
    }
}

fn accepted(method: IdentifyMethod, scale: Option<f64>, result: FrameResult) -> Accepted {
    let estimate = result.estimate.and_then(|estimate| Estimate::of(estimate, scale));
    let phase = match (method, &estimate) {
        (_, None) => "start",
        (IdentifyMethod::Adaptive, Some(_)) => "adapt",
    };
    Accepted { phase, result, estimate }
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
