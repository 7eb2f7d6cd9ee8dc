//! What a method found, frame by frame.
use freeform_curve_fit::Outline;
use freeform_estimate::MotionEstimate;
use freeform_motion::Pipeline;
use freeform_outline_filter::MotionFilter;
use freeform_riccati::{CameraScale, ParameterKind, ProjectiveMotion};
use freeform_sim_camera::Motion;

use super::method::Method;
use super::relative_error::RelativeError;
use super::sequence::Sequence;
use crate::ExperimentError;

/// What a method holds after each frame of a sequence.
#[derive(Debug, Default)]
pub(super) struct Track {
    /// One for each frame, also where it was rejected.
    pub(super) moments: Vec<Moment>,
    pub(super) frames_rejected: usize,
    /// The line pair that the estimate comes from; `None` if from all, or from none.
    pub(super) pair: Option<usize>,
}

/// What a method holds after one frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Moment {
    /// In seconds.
    pub(super) time: f64,
    /// The motion in space; `None` where the method gives none, or not all of its parameters.
    pub(super) motion: Option<ProjectiveMotion>,
}

impl Track {
    pub(super) fn by(method: &Method, sequence: &Sequence) -> Result<Self, ExperimentError> {
        let mut track = Self::default();
        match method {
            Method::Adaptive(settings) => {
                // Initial values are told in space and known to the pipeline in the image.
                let mut settings = settings.as_ref().clone();
                let kinds = settings.identify.model.parameter_kinds();
                for (value, kind) in settings.identify.initial_values.iter_mut().zip(kinds) {
                    *value *= if *kind == ParameterKind::Velocity { sequence.scale.value() } else { 1.0 };
                }
                let mut pipeline = Pipeline::new(settings)?;
                track.follow(sequence, |time, outline| (pipeline.push(time, outline).is_ok(), pipeline.estimate()));
                track.pair = pipeline.identifier().chosen_pair();
            }
            Method::Filter(settings) => {
                let mut filter = MotionFilter::new(*settings)?;
                track.follow(sequence, |time, outline| {
                    (filter.step(time, outline).is_ok_and(|step| step.is_accepted()), filter.estimate())
                });
            }
        }
        Ok(track)
    }

    /// Shows every frame to a method that tells whether it took it and what it then holds.
    fn follow(&mut self, sequence: &Sequence, mut show: impl FnMut(f64, &Outline) -> (bool, Option<MotionEstimate>)) {
        for (time, outline) in &sequence.frames {
            let (is_accepted, estimate) = show(*time, outline);
            self.frames_rejected += usize::from(!is_accepted);
            self.take(*time, estimate, sequence.scale);
        }
    }

    fn take(&mut self, time: f64, estimate: Option<MotionEstimate>, scale: CameraScale) {
        let complete = estimate.filter(|estimate| estimate.parameters().all(|p| p.value.is_some()));
        let motion = complete.map(|estimate| ProjectiveMotion::of_generator(&estimate.in_space(scale).generator()));
        self.moments.push(Moment { time, motion });
    }

    /// How far each moment is from the truth; `None` where there is no estimate.
    pub(super) fn errors(&self, truth: &Motion) -> Vec<Option<RelativeError>> {
        let error = |moment: &Moment| Some(RelativeError::of(&moment.motion?, &truth.at(moment.time)));
        self.moments.iter().map(error).collect()
    }

    /// Frames from the first estimate on that have none.
    pub(super) fn frames_lost(&self) -> usize {
        let from_first = self.moments.iter().skip_while(|moment| moment.motion.is_none());
        from_first.filter(|moment| moment.motion.is_none()).count()
    }

    /// Share of frames rejected.
    pub(super) fn share_rejected(&self) -> f64 {
        self.frames_rejected as f64 / self.moments.len().max(1) as f64
    }
}
