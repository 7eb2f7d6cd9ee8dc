//! The poses of objects as they are stated, one after another.
use std::collections::HashMap;

use freeform_estimate::{MotionState, PoseParameter};
use freeform_riccati::CameraScale;

use super::{
    continuous_angle::{ContinuousAngle, PoseSource},
    observation::Observation,
};

/// The poses of objects as they are stated, frame after frame: with angles that are [continuous](ContinuousAngle) within each
/// [segment](Observation::segment) and may exceed half a turn, and in space if a camera scale is given. Memory does not grow with the number of
/// frames.
///
/// While the outlines leave open by how many whole turns the object turns from frame to frame ([`Observation::ambiguity`]), how far it has turned
/// is not known, and the angle is not stated. The outline is in the same place by each of these turns: the matrix of an affine or projective pose
/// is stated, and [`MotionState::pose_parameters`] has the angle between -pi and pi rad.
///
/// ```
/// use freeform_motion::{Tracker, TrackerSettings};
/// use freeform_motion::outline_io::OutlineFrame;
/// use freeform_motion::sim_camera::{PaperExperiment, SequenceLength, Settings, Simulator};
/// use freeform_motion::tracker::Poses;
///
/// let (mut tracker, mut poses) = (Tracker::new(TrackerSettings::default())?, Poses::new(None));
/// let settings = Settings { length: SequenceLength::Frames(120), ..Settings::default() };
/// let simulator = Simulator::new(PaperExperiment::FLIGHT_BIRD.scene(0.1)?, settings)?;
/// let mut angle = None;
/// for (frame, seen) in (0..).zip(simulator.frames()) {
///     let outline = OutlineFrame { frame, time: seen.time, object: "bird".to_owned(), outline: seen.outline };
///     angle = poses.take(&tracker.push(&outline)).map(|pose| pose[0]);
/// }
/// // It turns by a quarter in a second.
/// assert!(angle.is_some_and(|angle| angle.name == "angle" && (angle.value - 119.0 / 30.0 * 1.571).abs() < 0.02));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct Poses {
    scale: Option<CameraScale>,
    /// By the names of the objects: the segment that each is in, and its angle so far.
    angles: HashMap<String, (usize, ContinuousAngle)>,
}

impl Poses {
    /// Poses of which none has come yet. With a camera scale f/Z0 positions are divided by it.
    #[must_use]
    pub fn new(scale: Option<CameraScale>) -> Self {
        Self { scale, angles: HashMap::new() }
    }

    /// The pose of an object after a frame, which is its next one; `None` where it is not known then. What the outline does not show, or leaves
    /// open, is not finite.
    pub fn take(&mut self, observation: &Observation) -> Option<Vec<PoseParameter>> {
        let (segment, source) = (observation.segment, PoseSource::of(observation.is_accepted()));
        let state = observation.present_state()?;
        Some(self.of_state(&observation.object, (segment, source, TurnAmbiguity::of(observation)), state))
    }

    /// Forgets an object: if the name comes again, it is that of a new one.
    pub fn forget(&mut self, object: &str) {
        self.angles.remove(object);
    }

    /// The pose of an object in a state, which is its next one.
    pub(super) fn of_state(
        &mut self,
        object: &str,
        (segment, source, turn): (usize, PoseSource, TurnAmbiguity),
        state: &MotionState,
    ) -> Vec<PoseParameter> {
        let mut pose = state.pose_parameters();
        if !self.angles.contains_key(object) {
            self.angles.insert(object.to_owned(), (segment, ContinuousAngle::default()));
        }
        if let Some((current, angle)) = self.angles.get_mut(object) {
            // Nobody knows how far the object has turned between segments.
            if *current != segment {
                (*current, *angle) = (segment, ContinuousAngle::default());
            }
            match turn {
                TurnAmbiguity::Unambiguous => angle.go_on(state, source, &mut pose),
                TurnAmbiguity::Ambiguous => angle.leave_out(state.time()),
            }
        }
        if turn == TurnAmbiguity::Ambiguous {
            pose.iter_mut().filter(|parameter| parameter.name == "angle").for_each(|angle| {
                (angle.value, angle.standard_deviation) = (f64::NAN, f64::INFINITY);
            });
        }
        if let Some(scale) = self.scale {
            pose.iter_mut().for_each(|parameter| to_space(parameter, scale));
        }
        pose
    }
}

/// Whether the outlines leave open by how much an object turns from frame to frame: [`Observation::ambiguity`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum TurnAmbiguity {
    /// One turn is stated. Where several explain the outlines and nothing decides, that is the smallest, if the others are far larger.
    Unambiguous,
    /// Several turns explain the outlines, and none is stated. They may be whole turns apart, and lead to the same pose, or to different ones.
    Ambiguous,
}

impl TurnAmbiguity {
    pub(super) fn of(observation: &Observation) -> Self {
        if observation.ambiguity.is_some() { Self::Ambiguous } else { Self::Unambiguous }
    }
}

/// Changes a number of a pose in the image to that in space: as a generator changes between them, so does a map.
fn to_space(parameter: &mut PoseParameter, scale: CameraScale) {
    let PoseParameter { name, value, standard_deviation } = parameter;
    let factor = match *name {
        "x" | "y" => 1.0 / scale.value(),
        "m31" | "m32" => scale.value(),
        _ => return,
    };
    (*value, *standard_deviation) = (*value * factor, *standard_deviation * factor);
}
