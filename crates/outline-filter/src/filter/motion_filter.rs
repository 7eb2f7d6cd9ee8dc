use freeform_curve_fit::Outline;
use freeform_estimate::{MotionEstimate, TimeNotIncreasing};
use nalgebra::Projective2;

use super::{
    acquisition::Landmarks,
    error::FilterError,
    first_frames::FirstFrames,
    map_update::MapUpdate,
    motion_change::{MotionChange, SUDDEN},
    outline_map::{FEWEST_POINTS, OutlineMap},
    rejection::Rejection,
    rivals::Rivals,
    settings::FilterSettings,
};

/// Noise below this many lengths of a cell is never too much.
const BEND: f64 = 0.1;
/// Frames rejected in a row before the second one was ever found: the first was not the object.
pub(crate) const FALSE_START: usize = 3;
/// A map that has taken no more frames than this may have been begun from what is not the object.
const FEW_FRAMES: usize = 5;
/// Frames rejected in a row after which the object is given up and a new one taken.
pub(crate) const GIVEN_UP: usize = 30;

/// What the filter is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// No frame yet.
    Waiting,
    /// The outline is known, its motion is not: the next frame is searched for it.
    Acquiring,
    /// Outline and motion are known and predict the next frame.
    Tracking,
    /// Frames have not shown the object for a while; it is looked for in every one.
    Lost,
}

/// What became of one frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FilterStep {
    /// Time of the frame in seconds.
    pub time: f64,
    /// Phase after it.
    pub phase: Phase,
    /// Whether it was used.
    pub accepted: bool,
    /// What it said of the map; `None` where no map or no pose was there to measure it against.
    pub update: Option<MapUpdate>,
    /// Why it was not used; `None` where it was.
    pub rejection: Option<Rejection>,
}

/// Identifies the motion of one object from its outlines, one frame after the other, in constant memory.
///
/// The first frame starts an [`OutlineMap`], the second is found by related points and a search over turns without any guess, and from
/// the third on motion, pose and outline are estimated together, at the Cramer-Rao bound of what outlines can tell. Frames that
/// do not fit are rejected and counted; after a few of them the object is searched for again. Frames may be missing and
/// come at uneven times.
///
/// ```
/// use freeform_curve_fit::Outline;
/// use freeform_outline_filter::{FilterSettings, MotionFilter};
/// use nalgebra::{Isometry2, Point2, Vector2};
///
/// // An egg that turns anticlockwise at 0.5 rad/s and drifts to the right.
/// let egg = |i: i32| {
///     let t = std::f64::consts::TAU * f64::from(i) / 300.0;
///     Point2::new(0.5 * t.cos() + 0.05 * (2.0 * t).cos(), 0.35 * t.sin())
/// };
/// let mut filter = MotionFilter::new(FilterSettings::default())?;
/// for frame in 0..10 {
///     let time = f64::from(frame) / 30.0;
///     let pose = Isometry2::new(Vector2::new(0.2 * time, 0.0), 0.5 * time);
///     let outline = Outline::closed((0..300).map(|i| pose * egg(i)).collect())?;
///     assert!(filter.step(time, &outline)?.accepted);
/// }
/// let estimate = filter.estimate().expect("ten good frames");
/// let omega = estimate.parameters().next().expect("omega comes first");
/// assert!((omega.value.expect("an egg is not round") + 0.5).abs() < 0.01);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct MotionFilter {
    pub(super) settings: FilterSettings,
    pub(super) phase: Phase,
    pub(super) map: Option<OutlineMap>,
    /// Of the first outline, in its image coordinates.
    pub(super) landmarks: Option<Landmarks>,
    pub(super) last_time: f64,
    /// Time that the map stands at.
    pub(super) map_time: f64,
    accepted: usize,
    rejected: usize,
    rejected_in_a_row: usize,
    /// Frames that the present map has taken, and that it has not.
    pub(super) taken_by_map: usize,
    pub(super) refused_by_map: usize,
    restarts: usize,
    pub(super) change: MotionChange,
    pub(super) motion_changed: bool,
    pub(super) rivals: Rivals,
    pub(super) first_frames: FirstFrames,
}

impl MotionFilter {
    /// A filter that waits for its first frame.
    ///
    /// # Errors
    /// A setting outside its range.
    pub fn new(settings: FilterSettings) -> Result<Self, FilterError> {
        settings.check()?;
        Ok(Self {
            settings,
            phase: Phase::Waiting,
            map: None,
            landmarks: None,
            last_time: f64::NEG_INFINITY,
            map_time: 0.0,
            accepted: 0,
            rejected: 0,
            rejected_in_a_row: 0,
            taken_by_map: 0,
            refused_by_map: 0,
            restarts: 0,
            change: MotionChange::default(),
            motion_changed: false,
            rivals: Rivals::default(),
            first_frames: FirstFrames::default(),
        })
    }

    /// Takes the outline seen at a time in seconds.
    ///
    /// # Errors
    /// A time that is not finite or not after the last one; a first outline with fewer than 8 points. The filter stays as it was.
    pub fn step(&mut self, time: f64, outline: &Outline) -> Result<FilterStep, FilterError> {
        TimeNotIncreasing::check(self.last_time, time)?;
        if self.map.is_none() {
            self.start(time, outline)?;
            self.accepted += 1;
            return Ok(FilterStep { time, phase: self.phase, accepted: true, update: None, rejection: None });
        }
        self.last_time = time;
        let was_changing = self.change.variances().is_some();
        let update = match self.phase {
            Phase::Tracking => self.track(time, outline),
            _ => self.acquire(time, outline),
        };
        let accepted = update.is_some_and(|update| update.accepted);
        if accepted {
            self.accepted += 1;
            self.taken_by_map += 1;
            self.rejected_in_a_row = 0;
            let changes = !was_changing && self.change.variances().is_some();
            self.keep(time, outline, changes);
            if self.map.as_mut().is_some_and(OutlineMap::may_show_turn) {
                self.begin_with_turn(outline);
            }
        } else {
            self.rejected += 1;
            self.refused_by_map += 1;
            self.rejected_in_a_row += 1;
            self.fall_back(time, outline);
        }
        let rejection = (!accepted).then(|| Rejection::of(update.as_ref(), &self.settings));
        Ok(FilterStep { time, phase: self.phase, accepted, update, rejection })
    }

    /// Builds the map from a first frame.
    fn start(&mut self, time: f64, outline: &Outline) -> Result<(), FilterError> {
        let map = OutlineMap::new(self.settings.model, outline)?;
        self.landmarks = Landmarks::of(outline);
        self.first_frames = FirstFrames::begin(time, outline, &map);
        self.map = Some(map);
        self.rivals = Rivals::default();
        (self.change, self.motion_changed) = (MotionChange::default(), false);
        (self.last_time, self.map_time) = (time, time);
        (self.taken_by_map, self.refused_by_map) = (1, 0);
        self.rejected_in_a_row = 0;
        self.phase = Phase::Acquiring;
        Ok(())
    }

    /// After a rejected frame: look elsewhere, or begin again.
    fn fall_back(&mut self, time: f64, outline: &Outline) {
        let in_a_row = self.rejected_in_a_row;
        // Few frames that more speak against than for did not show the object.
        let is_outvoted = in_a_row >= self.settings.patience
            && self.taken_by_map <= FEW_FRAMES
            && self.refused_by_map > self.taken_by_map;
        let give_up = match self.phase {
            Phase::Acquiring => in_a_row >= FALSE_START,
            _ => in_a_row >= GIVEN_UP || is_outvoted,
        };
        if give_up && outline.point_count() >= FEWEST_POINTS && self.start(time, outline).is_ok() {
            self.restarts += 1;
        } else if self.phase == Phase::Tracking && in_a_row >= self.settings.patience {
            self.phase = Phase::Lost;
        }
    }

    /// Predicts and measures.
    fn track(&mut self, time: f64, outline: &Outline) -> Option<MapUpdate> {
        let map = self.map.as_mut()?;
        let seconds = time - self.map_time;
        self.map_time = time;
        let known = if self.rejected_in_a_row > 0 { Known::OthersRejected } else { Known::Nothing };
        let update = advance(&self.settings, map, &mut self.change, (seconds, outline), known);
        self.motion_changed |= self.change.is_seen();
        map.noise_level.take(update.spread / map.radius);
        Some(self.rivals.decide(&self.settings, map, update, seconds, outline))
    }

    pub(super) fn replace(&mut self, map: OutlineMap, time: f64, phase: Phase) {
        self.map = Some(map);
        self.map_time = time;
        self.phase = phase;
    }

    /// The settings.
    #[must_use]
    pub fn settings(&self) -> &FilterSettings {
        &self.settings
    }

    /// What the filter is doing.
    #[must_use]
    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// The motion as far as it is known; `None` before the second accepted frame, of those too that begin anew with what shows the turn
    /// of an object at last.
    #[must_use]
    pub fn estimate(&self) -> Option<MotionEstimate> {
        if self.phase == Phase::Waiting || (self.phase == Phase::Acquiring) {
            return None;
        }
        let mut estimate = self.map.as_ref()?.estimate()?;
        for (index, doubtful) in self.rivals.doubts(&estimate).into_iter().enumerate() {
            if doubtful {
                estimate = estimate.with_unobservable(index);
            }
        }
        Some(estimate)
    }

    /// The map of the image that has moved the outline of the first frame to where it was in the last frame accepted, or is predicted
    /// after rejected ones; `None` before the first frame.
    #[must_use]
    pub fn pose(&self) -> Option<Projective2<f64>> {
        self.map.as_ref().map(OutlineMap::pose)
    }

    /// The outline map; `None` before the first frame.
    #[must_use]
    pub fn map(&self) -> Option<&OutlineMap> {
        self.map.as_ref()
    }

    /// Frames used.
    #[must_use]
    pub fn frames_accepted(&self) -> usize {
        self.accepted
    }

    /// Frames that did not fit, one that a new map was begun from after others among them.
    #[must_use]
    pub fn frames_rejected(&self) -> usize {
        self.rejected
    }

    /// Turns in radians, anticlockwise where y points up, by which the object may just as well have come to the frame in which it was
    /// last searched for and found, besides the one taken: no frame since then fits significantly worse. Of equals the smallest turn is
    /// taken. Empty for outlines without symmetry.
    #[must_use]
    pub fn rival_turns(&self) -> &[f64] {
        self.rivals.turns()
    }

    /// Whether one of the rival turns is less than twice the one taken, so that nothing speaks for the latter: the parameters in which
    /// they differ are then marked as unobservable, until a frame decides.
    #[must_use]
    pub fn is_ambiguous(&self) -> bool {
        self.rivals.are_doubtful()
    }

    /// Whether the innovations have shown the motion to change, so that the estimate is that of the last frame, not of all. Always
    /// false where `FilterSettings::process_noise` announces changes.
    #[must_use]
    pub fn motion_changed(&self) -> bool {
        self.motion_changed
    }

    /// Times the filter has given up an object and begun anew.
    #[must_use]
    pub fn restarts(&self) -> usize {
        self.restarts
    }
}

/// What is known of a frame before it is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Known {
    Nothing,
    /// The one before it has been rejected: the motion may have changed.
    OthersRejected,
    /// It has been taken once: the noise of its few points on cells seen before tells less.
    ShowsObject,
}

/// Predicts a map over so many seconds, measures the frame, and finds how the motion changes.
pub(super) fn advance(
    settings: &FilterSettings,
    map: &mut OutlineMap,
    change: &mut MotionChange,
    (seconds, outline): (f64, &Outline),
    known: Known,
) -> MapUpdate {
    map.predict(seconds);
    map.add_process_noise(&settings.process_noise, seconds);
    if let Some(variances) = change.variances() {
        map.add_change(variances);
    }
    let parameters = map.information.k;
    let limit = SUDDEN * parameters as f64;
    let (smallest, fits) = (settings.smallest_agreement, fits(map, settings.smallest_agreement));
    let shows = |update: &MapUpdate| match known {
        Known::ShowsObject => update.agreement >= smallest,
        _ => fits(update),
    };
    if !settings.finds_changes() && known == Known::ShowsObject {
        return map.update(outline, shows);
    }
    let mut update = map.update(outline, |update| shows(update) && update.innovation <= limit);
    if !settings.finds_changes() {
        return update;
    }
    let innovation = map.innovation;
    let may_change = known != Known::Nothing && update.agreement >= smallest && innovation.fisher[0] > 0.0;
    if !update.accepted && may_change {
        // If the outline is there, but for the second time (or beyond doubt) not where it was going, the motion has changed.
        let mut changed = map.clone();
        changed.add_change([0, 1].map(|kind| (innovation.gradient[kind] / innovation.fisher[kind]).max(0.0)));
        let found = changed.update(outline, shows);
        if found.accepted {
            *map = changed;
            change.was_sudden = true;
            update = found;
        }
    }
    if update.accepted {
        change.take(&innovation, parameters);
    }
    update
}

/// Whether a frame shows the outline that the map knows.
pub(super) fn fits(map: &OutlineMap, smallest_agreement: f64) -> impl Fn(&MapUpdate) -> bool + Copy + use<> {
    // Exact points leave what the cells do not follow.
    let largest_noise = map.noise_level.tolerated(map.sigma).max(BEND * map.spacing) * map.radius;
    move |update| update.agreement >= smallest_agreement && update.noise.is_none_or(|noise| noise <= largest_noise)
}
