//! What each frame of an object gave, and what was found of it in the end.
use std::collections::HashMap;
use std::rc::Rc;
use std::thread;

use freeform_motion::curve_fit::Fit;
use freeform_motion::estimate::{MotionEstimate, MotionState, ParameterEstimate, PointVelocity};
use freeform_motion::outline_io::OutlineFrame;
use freeform_motion::riccati::{CameraScale, MotionModel};
use nalgebra::Matrix3;

use crate::args::{IdentifyMethod, TrackOptions};
use crate::contour_order::ContourOrder;
use crate::failure::Failure;
use crate::frame_ranges::FrameRanges;
use crate::identifier::{Identifier, Step};
use crate::input::{Input, Item, SeenIn};
use crate::left_out::Missing;
use crate::queues::{Queues, SharedIdentifier};
use crate::reader::{Pace, Reader};
use crate::turns::Turns;
use crate::window::{Pending, Window};

/// Reasons told of frames of an object that were rejected, and of pictures left out.
pub(crate) const REASONS_KEPT: usize = 10;

/// What a frame of an object gave.
#[derive(Debug)]
pub(crate) struct Observation {
    pub(crate) object: String,
    pub(crate) frame: u64,
    /// In seconds; `None` where the outline could not be read.
    pub(crate) time: Option<f64>,
    /// What the identifier was doing after the frame; `None` where it could not take it at all.
    pub(crate) phase: Option<&'static str>,
    /// The motion as known after the frame.
    pub(crate) estimate: Option<Estimate>,
    /// Pose and motion, where the method tells them.
    pub(crate) state: Option<MotionState>,
    /// The curve fitted to the outline, where the method fits one.
    pub(crate) fit: Option<Fit>,
    /// Root mean square distance of the points from the curve or outline known, in image lengths.
    pub(crate) residual: Option<f64>,
    /// Squared innovation of pose and motion in units of its predicted covariance (filter).
    pub(crate) innovation: Option<f64>,
    /// Turns that the outlines so far do not decide between (filter).
    pub(crate) ambiguity: Option<Turns>,
    /// Why the frame was not used; `None` where it was.
    pub(crate) rejected_because: Option<String>,
    /// That points do not follow the contour, told once of every object.
    pub(crate) out_of_order: Option<String>,
}

impl Observation {
    pub(crate) fn is_accepted(&self) -> bool {
        self.rejected_because.is_none()
    }
}

/// What comes of reading on.
pub(crate) enum Event<'a> {
    /// A frame of an object, as far as it could be read, and the picture that it was seen in, if it was.
    Observed { observation: &'a Observation, frame: Option<&'a OutlineFrame>, seen_in: Option<&'a Rc<SeenIn>> },
    /// A picture without an outline.
    Missing(&'a Missing),
}

/// An identified motion as it is reported: finite, and in space where a camera scale was given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Estimate(MotionEstimate);

impl Estimate {
    /// `None` where a number is not finite: the identifier has diverged.
    pub(crate) fn of(estimate: MotionEstimate, scale: Option<CameraScale>) -> Option<Self> {
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

    /// The generator in image lengths, for an estimate that was reported in space.
    pub(crate) fn generator_in_image(&self, scale: Option<CameraScale>) -> Option<Matrix3<f64>> {
        Some(scale.unwrap_or_default().generator_in_image(&self.generator()?))
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
    /// Why the first of them was rejected.
    pub(crate) first_rejection: Option<String>,
    pub(crate) estimate: Option<Estimate>,
    /// Velocity of the object's middle at the end, as its motion is reported: in space where a camera scale was given.
    pub(crate) velocity: Option<PointVelocity>,
    /// Turns that the outlines do not decide between.
    pub(crate) ambiguity: Option<Turns>,
    pub(crate) warnings: Vec<String>,
}

/// A velocity as it is reported; `None` where a number is not finite.
fn in_space(velocity: PointVelocity, scale: Option<CameraScale>) -> Option<PointVelocity> {
    let per_length = 1.0 / scale.map_or(1.0, CameraScale::value);
    let PointVelocity { point, velocity, covariance } = velocity;
    let velocity = PointVelocity {
        point: point * per_length,
        velocity: velocity * per_length,
        covariance: covariance * (per_length * per_length),
    };
    let numbers = velocity.point.iter().chain(&velocity.velocity).chain(&velocity.covariance);
    numbers.copied().all(f64::is_finite).then_some(velocity)
}

/// Follows every object of a sequence.
#[derive(Debug)]
pub(crate) struct Tracking {
    options: TrackOptions,
    objects: Vec<Object>,
    positions: HashMap<String, usize>,
}

#[derive(Debug)]
struct Object {
    name: String,
    identifier: SharedIdentifier,
    contour_order: ContourOrder,
    frames: usize,
    rejected: usize,
    reasons: Vec<String>,
    /// Frames rejected after those whose reasons are kept.
    rejected_later: FrameRanges,
}

impl Tracking {
    /// With no object yet.
    pub(crate) fn new(options: &TrackOptions) -> Result<Self, Failure> {
        // Settings are refused before anything is read.
        Identifier::new(options)?;
        Ok(Self { options: options.clone(), objects: Vec::new(), positions: HashMap::new() })
    }

    /// Takes all frames of an input and hands on what each gave. Returns
    /// the error that ended the reading, if any; what came before it has been taken.
    pub(crate) fn read(
        &mut self,
        input: &mut Input,
        pace: Pace,
        quiet: bool,
        mut observe: impl FnMut(Event<'_>) -> Result<(), Failure>,
    ) -> Result<Option<Failure>, Failure> {
        let mut window = Window::new(pace, input.has_pictures());
        let mut reader = Reader::new(input, pace, quiet);
        let mut first_missing = None;
        let queues = Queues::default();
        thread::scope(|scope| {
            // However this ends, the threads end.
            let _closing = queues.closed_at_the_end();
            let (mut threads, most_threads) = (1, pace.threads());
            loop {
                if window.has_room()
                    && let Some(item) = reader.next()
                {
                    window.push(self.enqueue(item, &queues)?);
                    // This thread and as many as there may be work for.
                    if threads <= self.objects.len() && threads < most_threads {
                        scope.spawn(|| queues.follow());
                        threads += 1;
                    }
                } else if let Some(Pending::Outline { position, .. }) = window.first() {
                    if !queues.help(*position) {
                        return Ok(());
                    }
                } else {
                    return Ok(());
                }
                while let Some(first) = window.first()
                    && self.hand_on(first, &queues, &mut observe)?
                {
                    if let Some(Pending::Missing(missing)) = window.pop() {
                        first_missing.get_or_insert(missing);
                    }
                    reader.progress.advance();
                }
            }
        })?;
        // Nothing but pictures without an object: the first says why.
        let nothing = first_missing.filter(|_| self.objects.is_empty()).map(Missing::into_failure);
        Ok(reader.finish().or(nothing))
    }

    /// Takes the next frame of an object.
    pub(crate) fn push(&mut self, frame: &OutlineFrame) -> Result<Observation, Failure> {
        let position = self.position(&frame.object)?;
        let step = self.objects[position].identifier.hold().push(frame.time, &frame.outline);
        Ok(self.observation(position, frame, step))
    }

    /// Hands an outline to its object.
    fn enqueue(&mut self, item: Item, queues: &Queues) -> Result<Pending, Failure> {
        Ok(match item {
            Item::Outline(frame, seen_in) => {
                let position = self.position(&frame.object)?;
                let points = frame.outline.point_count();
                queues.push(position, &self.objects[position].identifier, frame);
                Pending::Outline { position, points, seen_in }
            }
            Item::Rejected { object, frame, reason } => {
                Pending::Rejected { position: self.position(&object)?, object, frame, reason }
            }
            Item::Missing(missing) => Pending::Missing(missing),
        })
    }

    /// Hands on what was read first, unless that has not been followed yet. Returns whether it did.
    fn hand_on(
        &mut self,
        first: &Pending,
        queues: &Queues,
        observe: &mut impl FnMut(Event<'_>) -> Result<(), Failure>,
    ) -> Result<bool, Failure> {
        match first {
            Pending::Outline { position, seen_in, .. } => {
                let Some((frame, step)) = queues.pop(*position) else { return Ok(false) };
                let (observation, seen_in) = (self.observation(*position, &frame, step), seen_in.as_ref());
                observe(Event::Observed { observation: &observation, frame: Some(&frame), seen_in })?;
            }
            Pending::Rejected { position, object, frame, reason } => {
                let observation = self.reject(*position, object, *frame, reason);
                observe(Event::Observed { observation: &observation, frame: None, seen_in: None })?;
            }
            Pending::Missing(missing) => observe(Event::Missing(missing))?,
        }
        Ok(true)
    }

    fn observation(&mut self, position: usize, frame: &OutlineFrame, step: Step) -> Observation {
        let scale = self.options.scale;
        let in_place = |reason| format!("frame {} of object {:?}: {reason}", frame.frame, frame.object);
        let rejected_because = step.rejected_because.map(in_place);
        let object = &mut self.objects[position];
        object.count(frame.frame, rejected_because.as_deref());
        let out_of_order = object.contour_order.look_at(frame).map(str::to_owned);
        Observation {
            object: frame.object.clone(),
            frame: frame.frame,
            time: Some(frame.time),
            phase: step.phase,
            estimate: step.estimate.and_then(|estimate| Estimate::of(estimate, scale)),
            state: step.state,
            fit: step.fit,
            residual: step.residual,
            innovation: step.innovation,
            ambiguity: step.ambiguity,
            rejected_because,
            out_of_order,
        }
    }

    /// Takes note of a frame whose points are no outline.
    fn reject(&mut self, position: usize, object: &str, frame: u64, reason: &str) -> Observation {
        self.objects[position].count(frame, Some(reason));
        Observation {
            object: object.to_owned(),
            frame,
            time: None,
            phase: None,
            estimate: None,
            state: None,
            fit: None,
            residual: None,
            innovation: None,
            ambiguity: None,
            rejected_because: Some(reason.to_owned()),
            out_of_order: None,
        }
    }

    /// Whether the motion of any object was seen to change.
    pub(crate) fn motion_changed(&self) -> bool {
        self.objects.iter().any(|object| object.identifier.hold().motion_changed())
    }

    /// The objects whose points do not follow the contour, and the warning of each.
    pub(crate) fn out_of_order(&self) -> impl Iterator<Item = (&str, &str)> {
        self.objects.iter().filter_map(|object| Some((object.name.as_str(), object.contour_order.warning()?)))
    }

    /// The results so far, in the order in which the objects first appeared.
    pub(crate) fn results(&self) -> Vec<ObjectResult> {
        self.objects.iter().map(|object| self.result(object)).collect()
    }

    fn result(&self, object: &Object) -> ObjectResult {
        let identifier = object.identifier.hold();
        let raw = identifier.estimate();
        let estimate = raw.and_then(|estimate| Estimate::of(estimate, self.options.scale));
        // First, as it is the reason for others.
        let out_of_order = object.contour_order.warning().map(str::to_owned);
        let mut warnings: Vec<String> = out_of_order.into_iter().chain(identifier.warnings()).collect();
        if raw.is_some() && estimate.is_none() {
            warnings.push("the identifier diverged: its numbers are not finite".to_owned());
        }
        warnings.extend(object.reasons.iter().map(|reason| format!("rejected: {reason}")));
        if object.rejected > object.reasons.len() {
            let (count, frames) = (object.rejected - object.reasons.len(), &object.rejected_later);
            warnings.push(format!("rejected: {count} more frame(s), {frames}"));
        }
        ObjectResult {
            object: object.name.clone(),
            method: self.options.method,
            motion: self.options.motion.model(),
            frames: object.frames,
            frames_rejected: object.rejected,
            first_rejection: object.reasons.first().cloned(),
            estimate,
            velocity: identifier.velocity().and_then(|velocity| in_space(velocity, self.options.scale)),
            ambiguity: identifier.ambiguity(),
            warnings,
        }
    }

    /// Where an object stands among all, new ones at the end.
    fn position(&mut self, name: &str) -> Result<usize, Failure> {
        if let Some(position) = self.positions.get(name) {
            return Ok(*position);
        }
        let identifier = SharedIdentifier::new(Identifier::new(&self.options)?);
        let (name, position) = (name.to_owned(), self.objects.len());
        self.positions.insert(name.clone(), position);
        self.objects.push(Object {
            name,
            identifier,
            contour_order: ContourOrder::default(),
            frames: 0,
            rejected: 0,
            reasons: Vec::new(),
            rejected_later: FrameRanges::default(),
        });
        Ok(position)
    }
}

impl Object {
    /// Counts a frame, and keeps why it was rejected, if it was.
    fn count(&mut self, frame: u64, rejected_because: Option<&str>) {
        self.frames += 1;
        let Some(reason) = rejected_because else { return };
        self.rejected += 1;
        if self.reasons.len() < REASONS_KEPT {
            self.reasons.push(reason.to_owned());
        } else {
            self.rejected_later.add(frame);
        }
    }
}
