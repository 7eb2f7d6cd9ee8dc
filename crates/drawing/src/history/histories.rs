//! What was found of every object over time.
use std::collections::HashMap;

use freeform_motion::curve_fit::Outline;
use freeform_motion::estimate::ParameterEstimate;
use freeform_motion::outline_io::OutlineFrame;
use freeform_motion::tracker::Observation;
use freeform_motion::{FittedOutline, Rectification};

use super::curve_fitter::CurveFitter;
use super::playback::Playback;
use super::pose_history::PoseHistory;

/// Objects whose poses are kept: the first so many.
pub(crate) const OBJECTS_WITH_POSES: usize = 12;

/// Objects that a report plays frame by frame: the first so many. It shows what is known of their outlines where the tracker says it:
/// [`Tracker::with_known_outlines`](freeform_motion::Tracker::with_known_outlines).
pub const OBJECTS_PLAYED: usize = 3;

/// Points of all objects that are played together, so that a page stays below a few megabytes.
const POINTS_PLAYED: usize = 220_000;

/// What was found of one object over time, kept for figures.
#[derive(Debug)]
pub(crate) struct History {
    pub(crate) object: String,
    /// Time of the first frame in seconds.
    pub(crate) start: Option<f64>,
    /// Time of the last frame of the recording in seconds, whether it shows the object or not.
    pub(crate) end: Option<f64>,
    /// Time in seconds and what was known then, if anything was.
    pub(crate) estimates: Vec<(f64, Option<Vec<ParameterEstimate>>)>,
    /// Time in seconds and root mean square residual, of frames that were used.
    pub(crate) residuals: Vec<[f64; 2]>,
    /// Time in seconds and squared innovation, of frames that were used.
    pub(crate) innovations: Vec<[f64; 2]>,
    /// Number and time in seconds of every frame that was rejected, as far as its time is known.
    pub(crate) rejected: Vec<(u64, Option<f64>)>,
    /// The latest outline that was not rejected, with its curve; `None` where the method fits none.
    pub(crate) latest: Option<(FittedOutline, Outline)>,
    /// Where it was, for a report.
    pub(crate) poses: Option<PoseHistory>,
    /// Its frames, for a report.
    pub(crate) playback: Option<Playback>,
}

/// What histories are kept for.
#[derive(Debug, Clone, Copy, Default)]
pub enum Purpose {
    /// Figures of the parameters.
    #[default]
    Figures,
    /// A report, with poses and players; of outlines that are mapped to a plane, if there is one.
    Report(Option<Rectification>),
}

impl History {
    /// An empty history.
    pub(crate) fn of(object: String) -> Self {
        let (estimates, residuals, innovations, rejected) = Default::default();
        Self {
            object,
            start: None,
            end: None,
            estimates,
            residuals,
            innovations,
            rejected,
            latest: None,
            poses: None,
            playback: None,
        }
    }
}

/// Objects that figures are drawn of: as many as anybody will look at.
const MOST_DRAWN: usize = 200;

/// What was found over time of the objects that figures are drawn of: the first 200, in the order in which they appeared.
#[derive(Debug)]
pub struct Histories {
    pub(crate) list: Vec<History>,
    purpose: Purpose,
    curves: CurveFitter,
    /// Time of the last frame so far in seconds.
    end: Option<f64>,
    /// By their names.
    positions: HashMap<String, usize>,
}

impl Histories {
    /// Empty histories for a purpose, with curves from `curves`.
    #[must_use]
    pub fn new(purpose: Purpose, curves: CurveFitter) -> Self {
        Self { list: Vec::new(), purpose, curves, end: None, positions: HashMap::new() }
    }

    /// The history of an object, if it has one.
    pub(crate) fn of(&self, object: &str) -> Option<&History> {
        self.positions.get(object).map(|&position| &self.list[position])
    }

    /// What is to be said of so many objects, if they are not all drawn.
    #[must_use]
    pub fn left_out(&self, objects: usize) -> Option<String> {
        let drawn = self.list.len();
        (drawn == MOST_DRAWN && objects > drawn)
            .then(|| format!("figures are drawn of the first {drawn} of {objects} objects"))
    }

    /// Takes note of a frame at a time in seconds, in which no object may have been seen.
    pub fn pass(&mut self, time: f64) {
        self.end = Some(self.end.map_or(time, |end| end.max(time)));
    }

    /// Adds what a frame of an object gave, with its outline, if it has one.
    pub fn take(&mut self, observation: &Observation, frame: Option<&OutlineFrame>) {
        observation.time.into_iter().for_each(|time| self.pass(time));
        let position = match self.positions.get(&observation.object) {
            Some(position) => *position,
            None if self.list.len() == MOST_DRAWN => return,
            None => {
                self.positions.insert(observation.object.clone(), self.list.len());
                self.list.push(self.new_history(observation.object.clone()));
                self.list.len() - 1
            }
        };
        let played = self.list.len().min(OBJECTS_PLAYED);
        let history = &mut self.list[position];
        history.start = history.start.or(observation.time);
        if let Some(poses) = &mut history.poses {
            poses.take(observation);
        }
        if let (Some(playback), Purpose::Report(plane)) = (&mut history.playback, &self.purpose) {
            let outline = frame.map(|frame| &frame.outline);
            let in_plane = plane.as_ref().and_then(|plane| plane.outline(outline?).ok());
            playback.take(observation, if plane.is_some() { in_plane.as_ref() } else { outline });
            playback.keep_points(POINTS_PLAYED / played);
        }
        history.estimates.extend(observation.time.map(|time| (time, observation.parameters())));
        if !observation.is_accepted() {
            history.rejected.push((observation.frame, observation.time));
            return;
        }
        if let Some(time) = observation.time {
            history.residuals.extend(observation.residual.map(|residual| [time, residual]));
            history.innovations.extend(observation.innovation.map(|innovation| [time, innovation]));
        }
        if let Some((frame, fit)) = frame.and_then(|frame| Some((frame, self.curves.of(observation, frame)?))) {
            history.latest = Some((FittedOutline::new(frame, fit), frame.outline.clone()));
        }
    }

    fn new_history(&self, object: String) -> History {
        let mut history = History::of(object);
        if let Purpose::Report(_) = self.purpose {
            history.poses = (self.list.len() < OBJECTS_WITH_POSES).then(PoseHistory::default);
            history.playback = (self.list.len() < OBJECTS_PLAYED).then(Playback::default);
        }
        history
    }

    /// After the last frame: figures go on to that, and no more is kept of the objects that are played than there is room for in a page.
    pub fn close(&mut self) {
        self.list.iter_mut().for_each(|history| history.end = self.end);
        let most = POINTS_PLAYED / self.list.len().clamp(1, OBJECTS_PLAYED);
        self.list
            .iter_mut()
            .filter_map(|history| history.playback.as_mut())
            .for_each(|playback| playback.keep_points(most));
    }
}
