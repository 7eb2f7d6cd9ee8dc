//! One object of a sequence.
use freeform_estimate::{MotionEstimate, PointVelocity};
use freeform_outline_filter::Rejection;
use freeform_outline_io::OutlineFrame;
use freeform_riccati::CameraScale;

use super::{
    contour_order::ContourOrder,
    identifier::Identifier,
    observation::Observation,
    repeat_pattern::{Content, RepeatPattern},
    result::ObjectResult,
    settings::TrackerSettings,
};
use crate::Rectification;
use crate::frame_ranges::FrameRanges;
use crate::polygon::outline_of_pixel_polygon;
use crate::rejection::{FrameRejection, RejectionCause};
use crate::warning::Warning;

/// Rejected frames of an object that are kept with their reasons.
pub(super) const REJECTIONS_KEPT: usize = 10;

/// An object, what is known of it, and what became of its frames.
#[derive(Debug, Clone)]
pub(super) struct TrackedObject {
    pub(super) name: String,
    pub(super) identifier: Identifier,
    pub(super) scale: Option<CameraScale>,
    pub(super) rectification: Option<Rectification>,
    pub(super) contour_order: ContourOrder,
    pub(super) repeats: RepeatPattern,
    pub(super) extras: Extras,
    pub(super) frames: usize,
    pub(super) rejected: usize,
    /// The first of them.
    pub(super) rejections: Vec<FrameRejection>,
    /// Numbers of the others.
    pub(super) rejected_later: FrameRanges,
}

/// What observations hold beside the results, each at the price of memory and time for every frame.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Extras {
    /// What is known of the outline.
    pub(super) known_outline: Extra,
    /// What was expected of the object, which smoothing needs where its motion changes.
    pub(super) expected_state: Extra,
}

/// Whether observations hold something.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum Extra {
    Given,
    #[default]
    LeftOut,
}

impl Extra {
    /// What is worked out only where it is given.
    fn of<T>(self, value: impl FnOnce() -> Option<T>) -> Option<Box<T>> {
        match self {
            Self::Given => value().map(Box::new),
            Self::LeftOut => None,
        }
    }
}

impl TrackedObject {
    /// A new object without frames.
    pub(super) fn new(name: String, identifier: Identifier, settings: &TrackerSettings, extras: Extras) -> Self {
        Self {
            name,
            identifier,
            scale: settings.scale,
            rectification: settings.rectification,
            contour_order: ContourOrder::default(),
            repeats: RepeatPattern::default(),
            extras,
            frames: 0,
            rejected: 0,
            rejections: Vec::new(),
            rejected_later: FrameRanges::default(),
        }
    }

    /// Lets its observations hold what was expected of it.
    pub(super) fn record_expected_states(&mut self) {
        self.extras.expected_state = Extra::Given;
    }

    /// Its name.
    pub(super) fn name(&self) -> &str {
        &self.name
    }

    /// Takes its next outline.
    pub(super) fn push(&mut self, frame: &OutlineFrame) -> Observation {
        if let Err(lost) = self.wake() {
            let unusable = self.unusable(frame.frame, lost);
            return Observation { time: Some(frame.time), ..unusable };
        }
        let filled = outline_of_pixel_polygon(&frame.outline);
        let seen = filled.as_ref().unwrap_or(&frame.outline);
        let in_plane = match self.rectification.map(|plane| plane.outline(seen)).transpose() {
            Ok(in_plane) => in_plane,
            Err(error) => {
                let unusable = self.unusable(frame.frame, RejectionCause::NotRectified(error));
                return Observation { time: Some(frame.time), ..unusable };
            }
        };
        let expected = self.extras.expected_state.of(|| self.identifier.expected_state(frame.time));
        let step = self.identifier.push(frame.time, in_plane.as_ref().unwrap_or(seen));
        let content = match step.rejected_because {
            Some(RejectionCause::NotAccepted(Rejection::Repeated)) => Content::Repeated,
            _ => Content::New,
        };
        self.repeats.take(frame.frame, frame.time, content);
        let rejection = self.count(frame.frame, step.rejected_because);
        Observation {
            object: self.name.clone(),
            frame: frame.frame,
            time: Some(frame.time),
            phase: step.phase,
            estimate: step.estimate.and_then(|estimate| self.reported(estimate)),
            hidden: step.hidden,
            velocity: step.velocity.and_then(|velocity| self.velocity_reported(velocity)),
            hides_velocity: step.hides_velocity,
            plane: step.plane,
            state: step.state,
            expected,
            fit: step.fit,
            progress: step.progress,
            residual: step.residual,
            innovation: step.innovation,
            ambiguity: step.ambiguity,
            plane_ambiguity: step.plane_ambiguity,
            aliases: step.aliases,
            known_outline: self.extras.known_outline.of(|| self.identifier.known_outline()),
            rejection,
            segment: self.identifier.segment(),
            warning: self.contour_order.look_at(frame).cloned(),
        }
    }

    /// Reads what is known of it from the file that it rests in, if it does.
    #[cfg(feature = "serde")]
    fn wake(&mut self) -> Result<(), RejectionCause> {
        match self.identifier.awake() {
            Ok(awake) => {
                awake.into_iter().for_each(|awake| self.identifier = awake);
                Ok(())
            }
            Err(error) => Err(RejectionCause::StateLost(error.to_string())),
        }
    }

    #[cfg(not(feature = "serde"))]
    #[expect(clippy::unnecessary_wraps, clippy::unused_self, reason = "objects rest only where they can be saved")]
    fn wake(&mut self) -> Result<(), RejectionCause> {
        Ok(())
    }

    /// Takes note of a frame whose points are no outline.
    pub(super) fn reject(&mut self, frame: u64, reason: String) -> Observation {
        self.unusable(frame, RejectionCause::NoOutline(reason))
    }

    /// A frame that does not come to the method.
    fn unusable(&mut self, frame: u64, cause: RejectionCause) -> Observation {
        let rejection = self.count(frame, Some(cause));
        Observation {
            object: self.name.clone(),
            frame,
            time: None,
            phase: None,
            estimate: None,
            hidden: Vec::new(),
            velocity: None,
            hides_velocity: false,
            plane: None,
            state: None,
            expected: None,
            fit: None,
            progress: None,
            residual: None,
            innovation: None,
            ambiguity: None,
            plane_ambiguity: None,
            aliases: Vec::new(),
            known_outline: None,
            rejection,
            segment: self.identifier.segment(),
            warning: None,
        }
    }

    /// Counts a frame, and keeps why it was rejected, if it was.
    fn count(&mut self, frame: u64, cause: Option<RejectionCause>) -> Option<FrameRejection> {
        self.frames += 1;
        let rejection = FrameRejection { object: self.name.clone(), frame, cause: cause? };
        self.rejected += 1;
        if self.rejections.len() < REJECTIONS_KEPT {
            self.rejections.push(rejection.clone());
        } else {
            self.rejected_later.add(frame);
        }
        Some(rejection)
    }

    /// An estimate as it is handed out; `None` where a number is not finite.
    fn reported(&self, estimate: MotionEstimate) -> Option<MotionEstimate> {
        let estimate = self.scale.map_or(estimate, |scale| estimate.in_space(scale));
        estimate.is_finite().then_some(estimate)
    }

    /// A velocity as it is handed out; `None` where a number is not finite.
    fn velocity_reported(&self, velocity: PointVelocity) -> Option<PointVelocity> {
        Some(self.scale.map_or(velocity, |scale| velocity.in_space(scale))).filter(PointVelocity::is_finite)
    }

    /// Whether its motion was seen to change.
    pub(super) fn motion_changed(&self) -> bool {
        self.identifier.motion_changed()
    }

    /// What is known of it now.
    pub(super) fn result(&self, settings: &TrackerSettings) -> ObjectResult {
        #[cfg(feature = "serde")]
        match self.identifier.awake() {
            Ok(Some(awake)) => return self.result_of(&awake, settings),
            Ok(None) => {}
            Err(error) => {
                let mut result = self.result_of(&self.identifier, settings);
                result.warnings.insert(0, Warning::StateLost { reason: error.to_string() });
                return result;
            }
        }
        self.result_of(&self.identifier, settings)
    }

    fn result_of(&self, identifier: &Identifier, settings: &TrackerSettings) -> ObjectResult {
        let raw = identifier.estimate();
        let estimate = raw.and_then(|estimate| self.reported(estimate));
        // First, as it is the reason for others.
        let out_of_order = self.contour_order.warning().cloned();
        let mut warnings: Vec<Warning> = out_of_order.into_iter().chain(identifier.warnings()).collect();
        if raw.is_some() && estimate.is_none() {
            warnings.push(Warning::Diverged);
        }
        if let Some(repeats) = self.repeats.warning() {
            warnings.push(repeats);
            warnings.sort_by_key(Warning::order);
        }
        warnings.extend(self.rejections.iter().cloned().map(Warning::FrameRejected));
        if self.rejected > self.rejections.len() {
            let count = self.rejected - self.rejections.len();
            warnings.push(Warning::MoreFramesRejected { count, frames: self.rejected_later.clone() });
        }
        let velocity = identifier.velocity().and_then(|velocity| self.velocity_reported(velocity));
        ObjectResult {
            object: self.name.clone(),
            method: settings.method(),
            motion: settings.motion(),
            frames: self.frames,
            frames_rejected: self.rejected,
            first_rejection: self.rejections.first().cloned(),
            estimate,
            covariance: estimate.and_then(|estimate| {
                let image = identifier.covariance()?;
                Some(match self.scale {
                    Some(scale) => scale.covariance_in_space(estimate.model(), &image),
                    None => image,
                })
            }),
            plane: identifier.plane().map(Box::new),
            velocity,
            hides_velocity: identifier.hides_velocity(),
            ambiguity: identifier.ambiguity(),
            plane_ambiguity: identifier.plane_ambiguity().map(Box::new),
            aliases: identifier.aliases(),
            dynamics: identifier.dynamics(),
            warnings,
        }
        .with_others_rejected()
    }
}
