//! A tracker as bytes and back.
use std::sync::Arc;

use freeform_estimate::{MotionEstimate, StateFormat};
use freeform_outline_filter::{FilterSettings, MotionFilter, StateError, state_format};
use freeform_riccati::CameraScale;
use nalgebra::{Matrix3, Projective2};
use serde::{Deserialize, Serialize};

use super::{
    Objects, Tracker,
    contour_order::{ContourOrder, FRAMES},
    filtered_object::FilteredObject,
    identifier::Identifier,
    object::{Extras, REJECTIONS_KEPT, TrackedObject},
    repeat_pattern::RepeatPattern,
    settings::{MethodSettings, TrackerSettings},
};
use crate::frame_ranges::FrameRanges;
use crate::rejection::{FrameRejection, RejectionCause};
use crate::{Pipeline, PipelineSettings, Rectification, Warning};

/// The format of the bytes. They hold states of filters, so that its version is theirs.
const FORMAT: StateFormat = state_format(*b"trak", "tracker");

/// Why a tracker cannot be saved or restored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum TrackerStateError {
    /// The motion of a plane in space, which is that of all frames together, has no saved state.
    #[error("objects whose motion in space is followed cannot be saved, those whose motion in the picture is can")]
    Plane,
    /// The bytes are no saved state.
    #[error(transparent)]
    State(#[from] StateError),
}

/// What is saved.
#[derive(Serialize, Deserialize)]
struct SavedTracker {
    method: SavedMethod,
    scale: Option<f64>,
    /// From the picture to the plane.
    rectification: Option<Matrix3<f64>>,
    objects: Vec<SavedObject>,
}

/// The method and its settings.
#[derive(Clone, Serialize, Deserialize)]
enum SavedMethod {
    Filter(FilterSettings),
    Adaptive(Box<PipelineSettings>),
}

/// What is known of an object. States have a header of their own.
#[derive(Serialize, Deserialize)]
enum SavedIdentifier {
    Filter { state: Vec<u8>, last_known: Box<Option<(f64, MotionEstimate)>> },
    Adaptive { state: Vec<u8> },
}

/// What is saved of an object.
#[derive(Serialize, Deserialize)]
struct SavedObject {
    name: String,
    identifier: SavedIdentifier,
    frames_looked_at: usize,
    /// Frame and length of the line through its points.
    out_of_order: Option<(u64, f64)>,
    frames: usize,
    rejected: usize,
    rejections: Vec<SavedRejection>,
    rejected_later: FrameRanges,
    repeats: RepeatPattern,
}

/// A rejected frame and what is told of it.
#[derive(Serialize, Deserialize)]
struct SavedRejection {
    frame: u64,
    reason: Reason,
}

#[derive(Serialize, Deserialize)]
enum Reason {
    /// Names the frame.
    NoOutline(String),
    Other(String),
}

impl Tracker {
    /// Everything that the tracker knows, as bytes: 50 to 100 kB for each object. A tracker [made from them](Self::from_bytes) goes on as this
    /// one would, to the last bit. The first four bytes are the version of the format, little-endian.
    ///
    /// ```
    /// use freeform_motion::{Tracker, TrackerSettings};
    /// use freeform_motion::outline_io::OutlineFrame;
    /// use freeform_motion::sim_camera::{PaperExperiment, SequenceLength, Settings, Simulator};
    ///
    /// let settings = Settings { length: SequenceLength::Frames(20), ..Settings::default() };
    /// let simulator = Simulator::new(PaperExperiment::FLIGHT_BIRD.scene(0.1)?, settings)?;
    /// let frames = (0..).zip(simulator.frames());
    /// let frames: Vec<_> =
    ///     frames.map(|(frame, seen)| OutlineFrame { frame, time: seen.time, object: "bird".into(), outline: seen.outline }).collect();
    ///
    /// let mut tracker = Tracker::new(TrackerSettings::default())?;
    /// frames[..10].iter().for_each(|frame| drop(tracker.push(frame)));
    /// let mut restored = Tracker::from_bytes(&tracker.to_bytes()?)?;
    /// for frame in &frames[10..] {
    ///     assert_eq!(restored.push(frame), tracker.push(frame));
    /// }
    /// assert_eq!(restored.results(), tracker.results());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// The motion of a plane in space, and a state that waits in a file and cannot be had back.
    pub fn to_bytes(&self) -> Result<Vec<u8>, TrackerStateError> {
        let TrackerSettings { method, scale, rectification } = &self.settings;
        let method = match method {
            MethodSettings::Filter(settings) => SavedMethod::Filter(*settings),
            MethodSettings::Adaptive(settings) => SavedMethod::Adaptive(settings.clone()),
            MethodSettings::Plane(..) => return Err(TrackerStateError::Plane),
        };
        let objects = self.objects.list.iter().map(saved).collect::<Result<_, _>>()?;
        Ok(FORMAT.encoded(&SavedTracker {
            method,
            scale: scale.map(CameraScale::value),
            rectification: rectification.map(|plane| *plane.plane_from_picture()),
            objects,
        })?)
    }

    /// A tracker from the bytes of [`to_bytes`](Self::to_bytes). Bytes from anywhere may be given: everything is checked.
    ///
    /// # Errors
    /// Bytes of another version or kind, damaged ones, and ones that describe no tracker.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, TrackerStateError> {
        let inconsistent = |part| StateError::Inconsistent { part };
        let state: SavedTracker = FORMAT.decoded(bytes)?;
        let scale = state.scale.map(CameraScale::new).transpose().map_err(|_| inconsistent("settings"))?;
        let plane = |map: Matrix3<f64>| Rectification::new(&Projective2::from_matrix_unchecked(map));
        let rectification = state.rectification.map(plane).transpose().map_err(|_| inconsistent("settings"))?;
        let method = match state.method {
            SavedMethod::Filter(settings) => MethodSettings::Filter(settings),
            SavedMethod::Adaptive(settings) => MethodSettings::Adaptive(settings),
        };
        let settings = TrackerSettings { method, scale, rectification };
        let mut tracker = Self::new(settings.clone()).map_err(|_| inconsistent("settings"))?;
        let mut objects = Objects::default();
        for saved in state.objects {
            let object = restored(saved, &settings)?;
            if objects.positions.insert(object.name().to_owned(), objects.list.len()).is_some() {
                return Err(inconsistent("two objects of one name").into());
            }
            objects.list.push(object);
        }
        tracker.objects = objects;
        Ok(tracker)
    }
}

fn saved(object: &TrackedObject) -> Result<SavedObject, TrackerStateError> {
    let lost = |_| StateError::Inconsistent { part: "what an object left in a file" };
    let awake = object.identifier.awake().map_err(lost)?;
    let identifier = match awake.as_ref().unwrap_or(&object.identifier) {
        Identifier::Filter(filtered) => {
            SavedIdentifier::Filter { state: filtered.filter.to_bytes()?, last_known: Box::new(filtered.last_known) }
        }
        Identifier::Adaptive(pipeline) => SavedIdentifier::Adaptive { state: pipeline.to_bytes()? },
        Identifier::Plane(_) | Identifier::Resting(_) => return Err(TrackerStateError::Plane),
    };
    let rejections = object.rejections.iter().map(|rejection| {
        let text = rejection.cause.to_string();
        let reason = match rejection.cause {
            RejectionCause::NoOutline(_) => Reason::NoOutline(text),
            _ => Reason::Other(text),
        };
        SavedRejection { frame: rejection.frame, reason }
    });
    Ok(SavedObject {
        name: object.name.clone(),
        identifier,
        frames_looked_at: object.contour_order.seen,
        out_of_order: match object.contour_order.warning {
            Some(Warning::PointsOutOfOrder { frame, perimeters }) => Some((frame, perimeters)),
            _ => None,
        },
        frames: object.frames,
        rejected: object.rejected,
        rejections: rejections.collect(),
        rejected_later: object.rejected_later.clone(),
        repeats: object.repeats.clone(),
    })
}

/// What was known of an object that was followed with these settings.
fn restored_identifier(saved: SavedIdentifier, method: &MethodSettings) -> Result<Identifier, StateError> {
    let inconsistent = |part| Err(StateError::Inconsistent { part });
    match (saved, method) {
        (SavedIdentifier::Filter { state, last_known }, MethodSettings::Filter(settings)) => {
            let (filter, last_known) = (MotionFilter::from_bytes(&state)?, *last_known);
            let is_of_model = last_known.is_none_or(|(_, motion)| motion.model() == settings.model);
            if filter.settings() != settings || !is_of_model {
                return inconsistent("settings of an object");
            }
            if last_known.is_some_and(|(time, motion)| !(time.is_finite() && motion.is_finite())) {
                return inconsistent("last known motion");
            }
            Ok(Identifier::Filter(Arc::new(FilteredObject { filter, last_known })))
        }
        (SavedIdentifier::Adaptive { state }, MethodSettings::Adaptive(settings)) => {
            let pipeline = Pipeline::from_bytes(&state)?;
            if pipeline.settings() != &**settings {
                return inconsistent("settings of an object");
            }
            Ok(Identifier::Adaptive(Arc::new(pipeline)))
        }
        _ => inconsistent("method of an object"),
    }
}

fn restored(saved: SavedObject, settings: &TrackerSettings) -> Result<TrackedObject, StateError> {
    let inconsistent = |part| Err(StateError::Inconsistent { part });
    let identifier = restored_identifier(saved.identifier, &settings.method)?;
    let SavedObject { name, frames_looked_at, frames, rejected, rejections, rejected_later, repeats, .. } = saved;
    let counts = [frames, StateFormat::MOST_COUNTED].is_sorted() && [rejections.len(), rejected, frames].is_sorted();
    if !counts
        || rejections.len() > REJECTIONS_KEPT
        || frames_looked_at > FRAMES
        || !rejected_later.is_sound()
        || !repeats.is_valid(rejected)
    {
        return inconsistent("counts of frames");
    }
    let warning = saved.out_of_order.map(|(frame, perimeters)| Warning::PointsOutOfOrder { frame, perimeters });
    let rejections = rejections.into_iter().map(|SavedRejection { frame, reason }| {
        let cause = match reason {
            Reason::NoOutline(text) => RejectionCause::NoOutline(text),
            Reason::Other(text) => RejectionCause::Saved(text),
        };
        FrameRejection { object: name.clone(), frame, cause }
    });
    Ok(TrackedObject {
        identifier,
        scale: settings.scale,
        rectification: settings.rectification,
        contour_order: ContourOrder { seen: frames_looked_at, warning },
        extras: Extras::default(),
        frames,
        rejected,
        rejections: rejections.collect(),
        rejected_later,
        repeats,
        name,
    })
}
