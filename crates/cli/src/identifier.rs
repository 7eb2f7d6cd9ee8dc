//! One object by a method of its own, for `evaluate`.
use freeform_motion::Pipeline;
use freeform_motion::curve_fit::Outline;
use freeform_motion::estimate::MotionEstimate;
use freeform_motion::outline_filter::MotionFilter;
use freeform_motion::tracker::MethodSettings;

use crate::args::TrackOptions;
use crate::failure::Failure;

/// A method at work on one object.
#[derive(Debug)]
pub(crate) enum Identifier {
    Adaptive(Box<Pipeline>),
    /// A filter and the motion when it was last known.
    Filter(Box<MotionFilter>, Option<MotionEstimate>),
}

/// What became of one frame.
pub(crate) struct Step {
    pub(crate) rejected_because: Option<String>,
}

impl Identifier {
    /// One that has seen nothing yet.
    pub(crate) fn new(options: &TrackOptions) -> Result<Self, Failure> {
        Ok(match options.tracker_settings().method {
            MethodSettings::Adaptive(settings) => {
                Self::Adaptive(Box::new(Pipeline::new(*settings).map_err(Failure::unusable)?))
            }
            MethodSettings::Filter(settings) => {
                Self::Filter(Box::new(MotionFilter::new(settings).map_err(Failure::unusable)?), None)
            }
        })
    }

    /// Takes the outline seen at a time in seconds.
    pub(crate) fn push(&mut self, time: f64, outline: &Outline) -> Step {
        let rejected_because = match self {
            Self::Adaptive(pipeline) => pipeline.push(time, outline).err().map(|error| error.to_string()),
            Self::Filter(filter, last_known) => match filter.step(time, outline) {
                Ok(step) => {
                    *last_known = filter.estimate().or(*last_known);
                    step.rejection.map(|rejection| rejection.to_string())
                }
                Err(error) => Some(error.to_string()),
            },
        };
        Step { rejected_because }
    }

    /// The motion as it was last known.
    pub(crate) fn estimate(&self) -> Option<MotionEstimate> {
        match self {
            Self::Adaptive(pipeline) => pipeline.estimate(),
            Self::Filter(_, last_known) => *last_known,
        }
    }
}
