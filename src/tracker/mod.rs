//! Many objects followed through a sequence of outlines.
//!
//! A [`Tracker`] takes outlines with the names of their objects, frame by frame ([`push`](Tracker::push)) or as a whole recording on
//! several threads ([`follow`](Tracker::follow)). It uses the motion filter or the paper's adaptive identifier. It gives an
//! [`Observation`] for each frame of each object, and an [`ObjectResult`] with [`Warning`](crate::Warning)s for each object. A
//! [`Trajectory`] keeps the poses.
mod attendance;
mod continuous_angle;
mod contour_order;
mod edge_seeker;
mod family;
mod filtered_object;
mod identifier;
mod not_stated;
mod object;
mod observation;
mod plane_object;
mod poses;
mod queues;
mod recording;
mod repeat_pattern;
#[cfg(feature = "serde")]
mod resting;
mod result;
mod result_csv;
mod seeking;
mod settings;
#[cfg(feature = "serde")]
mod state_bytes;
mod step;
mod trajectory;
mod trajectory_csv;

use std::collections::HashMap;

use freeform_outline_io::OutlineFrame;

use self::{
    identifier::Identifier,
    object::{Extra, Extras, TrackedObject},
};

#[cfg(feature = "serde")]
pub use self::state_bytes::TrackerStateError;
pub use freeform_outline_filter::ExpectedOutline;

pub use self::{
    attendance::{Attendance, Sighting},
    continuous_angle::{ContinuousAngle, PoseSource},
    edge_seeker::EdgeSeeker,
    family::MotionFamily,
    not_stated::NotStated,
    observation::{ObjectPhase, Observation},
    poses::Poses,
    recording::{Followed, ReadAhead, Recorded},
    result::{ObjectResult, VELOCITY_NAMES},
    result_csv::{AdaptiveColumns, POINT_COLUMNS, TraceWriter, write_results},
    settings::{Method, MethodSettings, TrackerError, TrackerSettings},
    trajectory::{NotSmoothed, PoseAndMotion, SmoothingError, Trajectory, TrajectoryRow},
    trajectory_csv::write_trajectory,
};
pub use crate::{
    frame_ranges::FrameRanges,
    rejection::{FrameRejection, RejectionCause},
};

/// Identifies the motion of many objects from their outlines. Memory does not grow with the number of frames.
///
/// ```
/// use freeform_motion::{Tracker, TrackerSettings};
/// use freeform_motion::outline_io::OutlineFrame;
/// use freeform_motion::sim_camera::{PaperExperiment, SequenceLength, Settings, Simulator};
///
/// let mut tracker = Tracker::new(TrackerSettings::default())?;
/// let settings = Settings { length: SequenceLength::Frames(30), ..Settings::default() };
/// let simulator = Simulator::new(PaperExperiment::FLIGHT_BIRD.scene(0.1)?, settings)?;
/// for (frame, seen) in (0..).zip(simulator.frames()) {
///     let outline = OutlineFrame { frame, time: seen.time, object: "bird".to_owned(), outline: seen.outline };
///     let observation = tracker.push(&outline);
///     // Pose and motion in this frame, with their joint covariance.
///     if let Some(state) = observation.state {
///         let angle = state.pose_parameters()[0];
///         println!("{frame}: {} = {:.3} +- {:.3} rad", angle.name, angle.value, angle.standard_deviation);
///     }
/// }
/// for result in tracker.results() {
///     let omega = result.estimate.and_then(|motion| motion.parameters().next()?.value);
///     assert!(omega.is_some_and(|omega| (omega - std::f64::consts::FRAC_PI_2).abs() < 0.05));
///     result.warnings.iter().for_each(|warning| println!("{}: {}: {warning}", result.object, warning.code()));
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Tracker {
    settings: TrackerSettings,
    /// One that has seen nothing yet.
    unused: Identifier,
    /// Objects whose observations hold what is known of the outline.
    known_outlines_of: usize,
    expected_states: Extra,
    objects: Objects,
    #[cfg(feature = "serde")]
    rest: Option<resting::Rest>,
}

/// Objects in the order in which they first appeared.
#[derive(Debug, Clone, Default)]
struct Objects {
    list: Vec<TrackedObject>,
    /// By their names.
    positions: HashMap<String, usize>,
}

impl Tracker {
    /// A tracker without objects.
    ///
    /// # Errors
    /// A setting outside its range.
    pub fn new(settings: TrackerSettings) -> Result<Self, TrackerError> {
        let unused = Identifier::new(&settings.method)?;
        Ok(Self {
            settings,
            unused,
            known_outlines_of: 0,
            expected_states: Extra::LeftOut,
            objects: Objects::default(),
            #[cfg(feature = "serde")]
            rest: None,
        })
    }

    /// While a recording is followed, keeps the states of no more than about so many objects of the motion filter in memory, and those of
    /// the others in `file`, which should be temporary and empty, open for reading and writing. Results are the same to the last bit. Which
    /// objects are put there is left to chance, as any rule would put many of them there just before they are needed again.
    ///
    /// Where the file cannot be written, what is not in it stays in memory. What cannot be read back is lost, with a rejection of each
    /// further frame and a [`Warning`](crate::Warning) that say so.
    ///
    /// An object that rests has no [`expected_outline`](Self::expected_outline) and is not found by [`seek`](Self::seek) or
    /// [`push_or_seek`](Self::push_or_seek) until its next outline wakes it. Only
    /// [`follow_recording`](Self::follow_recording) puts objects to rest, so that a program that seeks, and deals with each picture before the
    /// next, is not concerned.
    #[cfg(feature = "serde")]
    pub fn keep_states_in(&mut self, file: std::fs::File, most_in_memory: usize) {
        let file = std::sync::Arc::new(resting::StateFile::new(file));
        self.rest = Some(resting::Rest { file, most_awake: most_in_memory });
    }

    /// This tracker, whose observations hold what is known of the outline ([`Observation::known_outline`]), for the first so many of the
    /// objects that are new from now on. It takes memory and time for every frame, so that it is for drawings.
    #[must_use]
    pub fn with_known_outlines(self, objects: usize) -> Self {
        Self { known_outlines_of: objects, ..self }
    }

    /// From now on observations hold what was expected before each frame ([`Observation::expected`]), which
    /// [`Trajectory::smooth`] needs where the motion of an object changes (motion filter). A frame takes about twice as long.
    pub fn record_expected_states(&mut self) {
        self.expected_states = Extra::Given;
        self.objects.list.iter_mut().for_each(TrackedObject::record_expected_states);
    }

    /// Its settings.
    #[must_use]
    pub fn settings(&self) -> &TrackerSettings {
        &self.settings
    }

    /// Takes the next outline of an object. A new name starts a new object. Objects may come in any order; the times of each object must
    /// increase. A frame that cannot be used is rejected, with the reason in the observation.
    pub fn push(&mut self, frame: &OutlineFrame) -> Observation {
        self.object(&frame.object).push(frame)
    }

    /// Does a part of the work that waits for the next outlines, in every object, while nothing else is to be done; whether more is waiting. All
    /// results are the same to the last bit whether, when and how often this is called: what is not done by then, the next [`push`](Self::push) of
    /// the object does. A control loop that calls this between frames, as long as it has time and it returns true, has no long step to wait for where
    /// the map of an outline is cut anew: see [`MotionFilter::prepare`](freeform_outline_filter::MotionFilter::prepare).
    pub fn prepare(&mut self) -> bool {
        let mut is_more_waiting = false;
        for object in &mut self.objects.list {
            is_more_waiting |= object.identifier.prepare();
        }
        is_more_waiting
    }

    /// Records a frame of an object whose points are not an outline. It counts as rejected. The reason should name the frame.
    pub fn reject(&mut self, object: &str, frame: u64, reason: String) -> Observation {
        self.object(object).reject(frame, reason)
    }

    /// Forgets an object and gives its result; `None` if there is none of this name. If the name comes again, it is that of a new object.
    /// In a stream without end, [`Attendance`] tells which objects have not been seen for long.
    pub fn close(&mut self, object: &str) -> Option<ObjectResult> {
        let position = self.objects.positions.remove(object)?;
        self.objects.positions.values_mut().filter(|other| **other > position).for_each(|other| *other -= 1);
        Some(self.objects.list.remove(position).result(&self.settings))
    }

    /// The result for each object so far, in the order in which the objects first appeared.
    #[must_use]
    pub fn results(&self) -> Vec<ObjectResult> {
        self.objects.list.iter().map(|object| object.result(&self.settings)).collect()
    }

    /// Names of the objects so far, in the order in which they first appeared.
    pub fn objects(&self) -> impl ExactSizeIterator<Item = &str> {
        self.objects.list.iter().map(TrackedObject::name)
    }

    /// Whether the motion of any object changed.
    #[must_use]
    pub fn motion_changed(&self) -> bool {
        self.objects.list.iter().any(TrackedObject::motion_changed)
    }

    /// Whether the motion of an object changed; not that of one that the tracker does not know.
    #[must_use]
    pub fn motion_of_object_changed(&self, object: &str) -> bool {
        let position = self.objects.positions.get(object);
        position.is_some_and(|position| self.objects.list[*position].motion_changed())
    }

    fn object(&mut self, name: &str) -> &mut TrackedObject {
        let position = self.objects.positions.get(name).copied().unwrap_or_else(|| {
            let position = self.objects.list.len();
            self.objects.positions.insert(name.to_owned(), position);
            self.objects.list.push(self.new_object(name, position));
            position
        });
        &mut self.objects.list[position]
    }

    fn new_object(&self, name: &str, position: usize) -> TrackedObject {
        let known_outline = if position < self.known_outlines_of { Extra::Given } else { Extra::LeftOut };
        let extras = Extras { known_outline, expected_state: self.expected_states };
        TrackedObject::new(name.to_owned(), self.unused.clone(), &self.settings, extras)
    }
}
