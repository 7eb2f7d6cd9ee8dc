//! The pose of every object in every frame.
use std::collections::HashMap;

use freeform_estimate::{
    ExpectedState, MotionEstimate, MotionState, PointVelocity, PoseParameter, ProcessNoise, SmootherError, smooth,
    smooth_changing,
};
use freeform_riccati::{CameraScale, MotionModel};

use super::{
    MethodSettings, Tracker,
    continuous_angle::PoseSource,
    not_stated::NotStated,
    observation::Observation,
    poses::{Poses, TurnAmbiguity},
    result::VELOCITY_NAMES,
};
use crate::rejection::FrameRejection;

/// The pose of every object in every frame: one row per observation, in their order. It needs the motion filter: the adaptive method gives no poses.
///
/// ```
/// use freeform_motion::{Tracker, TrackerSettings};
/// use freeform_motion::outline_io::OutlineFrame;
/// use freeform_motion::sim_camera::{PaperExperiment, SequenceLength, Settings, Simulator};
/// use freeform_motion::tracker::Trajectory;
///
/// let (mut tracker, mut trajectory) = (Tracker::new(TrackerSettings::default())?, Trajectory::default());
/// let settings = Settings { length: SequenceLength::Frames(30), ..Settings::default() };
/// let simulator = Simulator::new(PaperExperiment::FLIGHT_BIRD.scene(0.1)?, settings)?;
/// let frames = (0..).zip(simulator.frames());
/// let outlines = frames.map(|(frame, seen)| OutlineFrame { frame, time: seen.time, object: "bird".into(), outline: seen.outline });
/// tracker.follow(outlines, |observation| trajectory.take(&observation));
/// // Later frames say more of the first ones.
/// for not_smoothed in trajectory.smooth(&tracker) {
///     println!("{not_smoothed}");
/// }
/// let poses = trajectory.poses(tracker.settings().scale);
/// assert!(poses.iter().all(|pose| pose.is_some()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Trajectory {
    rows: Vec<TrajectoryRow>,
}

/// One object in one frame.
#[derive(Debug, Clone, PartialEq)]
pub struct TrajectoryRow {
    /// Name of the object.
    pub object: String,
    /// Number of the frame.
    pub frame: u64,
    /// Time in seconds; `None` where the points are no outline.
    pub time: Option<f64>,
    /// Whether the frame was used.
    pub accepted: bool,
    /// Why the frame was not used, where it was not.
    pub rejection: Option<FrameRejection>,
    /// Counted up from 0 where poses get another reference: the object was begun anew, the second frame shows far more of it than the first, its turn
    /// is shown for the first time, another of several turns is taken, or an edge proves not to be of it. Poses of different segments cannot be
    /// compared: nobody knows how far the object had turned between them.
    pub segment: usize,
    /// The state known then, at a time up to that of the frame.
    state: Option<MotionState>,
    /// What was expected of it, where the tracker recorded that.
    expected: Option<Box<ExpectedState>>,
    /// Why each parameter of the motion that was not stated then was not, and the turn of the pose, where it was not.
    not_stated: Vec<(&'static str, NotStated)>,
    turn_not_stated: NotStated,
    turn_ambiguity: TurnAmbiguity,
    velocity_not_stated: Option<NotStated>,
    aliases: Aliases,
}

/// Angular velocities that explained the outlines until a frame as well as the one that was stated.
#[derive(Debug, Clone, PartialEq, Default)]
struct Aliases {
    others: Vec<f64>,
    stated: Option<f64>,
}

impl Aliases {
    /// Those of a motion at the same time, which later frames may have told better: they lie steps of the symmetry apart.
    fn of(&self, motion: &MotionEstimate) -> Vec<f64> {
        let Some((now, then)) = motion.mean_rate_of_turn().zip(self.stated) else { return Vec::new() };
        self.others.iter().map(|other| other + (now - then)).collect()
    }
}

/// Pose and motion of an object in one frame.
#[derive(Debug, Clone, PartialEq)]
pub struct PoseAndMotion {
    /// The pose parameters as in [`MotionState::pose_parameters`], except that angles are [continuous](super::ContinuousAngle) from row to row of
    /// a segment and may exceed half a turn, and are not finite while whole turns are ambiguous, as [`Poses`] says.
    pub pose: Vec<PoseParameter>,
    /// The motion.
    pub motion: MotionEstimate,
    /// Velocity of the middle of the object, in lengths of the image per second, or of space with a camera scale; `None` where it is not stated.
    pub velocity: Option<PointVelocity>,
    /// Other angular velocities, rad/s, that explain the outlines as well, as in [`ObjectResult::aliases`](super::ObjectResult::aliases).
    pub aliases: Vec<f64>,
}

/// An object whose poses are not smoothed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("the poses of object {object} are not smoothed: {reason}")]
pub struct NotSmoothed {
    /// Its name.
    pub object: String,
    /// Why they are not.
    pub reason: SmoothingError,
}

/// Why the poses of an object cannot be smoothed.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SmoothingError {
    /// The motion of the object changed, and no observation holds what was expected of it.
    #[error("the motion changed, and the tracker has not recorded what was expected in each frame")]
    MotionChanged,
    /// What is expected of a plane in space is not told.
    #[error("what is expected of a plane in space is not told")]
    PlaneInSpace,
    /// The states do not form one sequence.
    #[error(transparent)]
    States(#[from] SmootherError),
}

impl TrajectoryRow {
    /// Pose and motion at the time of the frame, in the image; `None` where they are not known then.
    #[must_use]
    pub fn state(&self) -> Option<&MotionState> {
        let (state, time) = (self.state.as_ref()?, self.time?);
        // Not since it was lost: where it is then is a guess.
        (state.time() == time).then_some(state)
    }

    /// Why a value of the row is not stated, of those that are not: of the motion by the name of the parameter, `v1` or `v2`, of the pose by any
    /// other.
    #[must_use]
    pub fn why_unstated(&self, name: &str) -> NotStated {
        if self.state().is_none() {
            // Not even where it is.
            return NotStated::Unknown;
        }
        if VELOCITY_NAMES.contains(&name) {
            return self.velocity_not_stated.unwrap_or(NotStated::Unknown);
        }
        let of_motion = self.not_stated.iter().find(|(parameter, _)| *parameter == name);
        of_motion.map_or(self.turn_not_stated, |(_, reason)| *reason)
    }

    /// The values of the row that are not stated, each with why: of pose and motion by the names of their parameters, then `v1` and `v2`. `known` is
    /// what [`Trajectory::poses`] has for the row.
    #[must_use]
    pub fn unstated(&self, known: Option<&PoseAndMotion>, model: MotionModel) -> Vec<(&'static str, NotStated)> {
        let pose = |index: usize| known.and_then(|known| known.pose.get(index)).map(|parameter| parameter.value);
        let motion = |index| known.and_then(|known| known.motion.parameters().nth(index)?.value);
        let velocity = known.and_then(|known| known.velocity.filter(PointVelocity::is_finite));
        let poses = Trajectory::pose_names(model).iter().enumerate().map(|(index, name)| (*name, pose(index)));
        let motions = model.parameter_names().iter().enumerate().map(|(index, name)| (*name, motion(index)));
        let velocities = VELOCITY_NAMES.into_iter().enumerate();
        let velocities = velocities.map(|(index, name)| (name, velocity.map(|velocity| velocity.velocity[index])));
        let values = poses.chain(motions).chain(velocities);
        let unstated = values.filter(|(_, value)| !value.is_some_and(f64::is_finite));
        unstated.map(|(name, _)| (name, self.why_unstated(name))).collect()
    }
}

impl Trajectory {
    /// Adds the observation of a frame.
    pub fn take(&mut self, observation: &Observation) {
        let motion = observation.estimate.as_ref();
        self.rows.push(TrajectoryRow {
            object: observation.object.clone(),
            frame: observation.frame,
            time: observation.time,
            accepted: observation.is_accepted(),
            segment: observation.segment,
            rejection: observation.rejection.clone(),
            state: observation.state.clone(),
            expected: observation.expected.clone(),
            not_stated: motion.map_or_else(Vec::new, |motion| observation.unstated(motion.model())),
            turn_not_stated: observation.turn_not_stated(),
            turn_ambiguity: TurnAmbiguity::of(observation),
            velocity_not_stated: observation.velocity_not_stated(),
            aliases: Aliases {
                others: observation.aliases.clone(),
                stated: motion.and_then(MotionEstimate::mean_rate_of_turn),
            },
        });
    }

    /// The rows in the order of the observations.
    #[must_use]
    pub fn rows(&self) -> &[TrajectoryRow] {
        &self.rows
    }

    /// Names of the pose parameters in [`poses`](Self::poses), in their order.
    #[must_use]
    pub fn pose_names(model: MotionModel) -> &'static [&'static str] {
        match model {
            MotionModel::Rigid => &["angle", "x", "y"],
            MotionModel::Similarity => &["scale", "angle", "x", "y"],
            MotionModel::Affine => &["m11", "m12", "m21", "m22", "x", "y"],
            MotionModel::Projective => &["m11", "m12", "m21", "m22", "x", "y", "m31", "m32"],
        }
    }

    /// Pose and motion of every row, `None` where they are not known at its time. With a camera scale f/Z0 they are those in space: positions
    /// and velocities divided by it.
    #[must_use]
    pub fn poses(&self, scale: Option<CameraScale>) -> Vec<Option<PoseAndMotion>> {
        let mut poses = Poses::new(scale);
        let rows = self.rows.iter().map(|row| {
            let state = row.state()?;
            let pose =
                poses.of_state(&row.object, (row.segment, PoseSource::of(row.accepted), row.turn_ambiguity), state);
            let motion = state.motion();
            let velocity = row.velocity_not_stated.is_none().then(|| state.velocity_of_middle());
            Some(PoseAndMotion {
                pose,
                motion: scale.map_or(motion, |scale| motion.in_space(scale)),
                velocity: velocity.map(|velocity| scale.map_or(velocity, |scale| velocity.in_space(scale))),
                aliases: row.aliases.of(&motion),
            })
        });
        rows.collect()
    }

    /// Lets later frames take part, object by object, within each run of frames of a segment through which an object was followed. `tracker` is the
    /// one that followed the objects.
    ///
    /// A motion that was not seen to change is taken for constant: the frames that a run began with, when the motion was not known yet, get their
    /// poses from the ones after them. One that was is smoothed by what was expected of each frame from those before it
    /// ([`smooth_changing`]), if the tracker [recorded](Tracker::record_expected_states) that; the first frames of a run stay as they are, and to
    /// those before a sudden change nothing is handed back.
    ///
    /// Returns the objects that are not smoothed, in the order of their first rows. Their rows stay as filtered.
    #[must_use = "some objects may not be smoothed"]
    pub fn smooth(&mut self, tracker: &Tracker) -> Vec<NotSmoothed> {
        let noise = match &tracker.settings().method {
            MethodSettings::Filter(settings) | MethodSettings::Plane(_, settings) => settings.process_noise,
            MethodSettings::Adaptive(_) => ProcessNoise::default(),
        };
        let is_plane = matches!(tracker.settings().method, MethodSettings::Plane(..));
        let mut positions: HashMap<String, usize> = HashMap::new();
        let mut objects: Vec<Vec<&mut TrajectoryRow>> = Vec::new();
        for row in &mut self.rows {
            let position = *positions.entry(row.object.clone()).or_insert(objects.len());
            if position == objects.len() {
                objects.push(Vec::new());
            }
            objects[position].push(row);
        }
        let not_smoothed = objects.into_iter().filter_map(|mut rows| {
            let object = rows.first()?.object.clone();
            let smoother = match tracker.motion_of_object_changed(&object) {
                false => Smoother::ConstantMotion(noise),
                true if is_plane => return Some(NotSmoothed { object, reason: SmoothingError::PlaneInSpace }),
                true if rows.iter().any(|row| row.expected.is_some()) => Smoother::ByExpectation,
                true => return Some(NotSmoothed { object, reason: SmoothingError::MotionChanged }),
            };
            smooth_object(&mut rows, smoother).err().map(|reason| NotSmoothed { object, reason })
        });
        not_smoothed.collect()
    }
}

/// How later frames take part.
#[derive(Debug, Clone, Copy)]
enum Smoother {
    /// Of a motion that changes by no more than this.
    ConstantMotion(ProcessNoise),
    /// By what was expected of each frame.
    ByExpectation,
}

/// Smooths the rows of an object, or none of them.
fn smooth_object(rows: &mut [&mut TrajectoryRow], smoother: Smoother) -> Result<(), SmoothingError> {
    // Poses of different segments have different references.
    let followed: Vec<(bool, usize)> = rows.iter().map(|row| (row.state.is_some(), row.segment)).collect();
    let (mut start, mut smoothed) = (0, Vec::new());
    for run in followed.chunk_by(|a, b| a == b) {
        if run[0].0 {
            let known = rows[start..start + run.len()]
                .iter()
                .filter_map(|row| Some((row.state()?.clone(), row.expected.as_deref())));
            let (filtered, expected): (Vec<MotionState>, Vec<_>) = known.unzip();
            let states = match &smoother {
                Smoother::ConstantMotion(noise) => smooth(&filtered, noise)?,
                Smoother::ByExpectation => smooth_changing(&filtered, &expected)?,
            };
            smoothed.push((start, run.len(), states));
        }
        start += run.len();
    }
    for (start, count, states) in smoothed {
        let (before, from) = rows.split_at_mut(start);
        let run = &mut from[..count];
        if let Smoother::ConstantMotion(noise) = &smoother {
            tell_all_of_constant_motion(before, run, &states[0], noise);
        }
        let known = run.iter_mut().filter(|row| row.state().is_some());
        known.zip(states).for_each(|(row, state)| row.state = Some(state));
    }
    Ok(())
}

/// What the last frame of a run does not tell of a constant motion, for an ambiguous turn say, none does; what it tells, all do, those too that the
/// run began with, when the motion was not known yet. `first` is the first smoothed state.
fn tell_all_of_constant_motion(
    before: &mut [&mut TrajectoryRow],
    run: &mut [&mut TrajectoryRow],
    first: &MotionState,
    noise: &ProcessNoise,
) {
    let velocity_not_stated = run[run.len() - 1].velocity_not_stated;
    let last = run.iter().rev().find(|row| row.state().is_some());
    let turn_ambiguity = last.map_or(TurnAmbiguity::Unambiguous, |row| row.turn_ambiguity);
    let aliases = last.map_or_else(Aliases::default, |row| row.aliases.clone());
    let tell = |row: &mut TrajectoryRow| {
        (row.velocity_not_stated, row.turn_ambiguity) = (velocity_not_stated, turn_ambiguity);
        row.aliases.clone_from(&aliases);
    };
    let segment = run[0].segment;
    let is_of_beginning = |row: &&mut &mut TrajectoryRow| row.accepted && row.segment == segment && row.state.is_none();
    for row in before.iter_mut().rev().take_while(is_of_beginning) {
        row.state = row.time.map(|time| first.predicted(time, noise));
        tell(row);
    }
    run.iter_mut().filter(|row| row.state().is_some()).for_each(|row| tell(row));
}
