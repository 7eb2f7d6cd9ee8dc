use freeform_curve_fit::Outline;
use nalgebra::{Affine2, Projective2};

use super::{
    acquisition::{Hypothesis, KEPT, Landmarks, find_pose, motion_between},
    error::FilterError,
    map_update::MapUpdate,
    motion_change::{MotionChange, SUDDEN},
    outline_map::{FEWEST_POINTS, OutlineMap},
    settings::{FilterSettings, ProcessNoise},
};
use crate::estimate::MotionEstimate;

/// Squared innovation of one frame beyond which the motion has not gone on as it was.
const LARGEST_INNOVATION: f64 = 80.0;
/// Noise below this many lengths of a cell is never too much.
const BEND: f64 = 0.1;
/// Share of the points that one pose must explain beyond another to be preferred to a likelier one.
const CLEARLY_BETTER: f64 = 0.03;
/// Spread about the map, as a multiple of the best, with which another turn explains a frame as well.
const AS_GOOD: f64 = 1.15;
/// Turns that differ by less are the same, rad.
const DIFFERENT_TURN: f64 = 0.15;
/// Frames rejected in a row before the second one was ever found: the first was not the object.
const FALSE_START: usize = 3;
/// Frames rejected in a row after which the object is given up and a new one taken.
const GIVEN_UP: usize = 30;

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
/// use freeform_identify::{FilterSettings, MotionFilter};
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
    settings: FilterSettings,
    phase: Phase,
    map: Option<OutlineMap>,
    /// Of the first outline, in its image coordinates.
    landmarks: Option<Landmarks>,
    last_time: f64,
    /// Time that the map stands at.
    pub(super) map_time: f64,
    accepted: usize,
    rejected: usize,
    rejected_in_a_row: usize,
    restarts: usize,
    change: MotionChange,
    rivals: Rivals,
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
            restarts: 0,
            change: MotionChange::default(),
            rivals: Rivals::default(),
        })
    }

    /// Takes the outline seen at a time in seconds.
    ///
    /// # Errors
    /// A time that is not finite or not after the last one; a first outline with fewer than 8 points. The filter stays as it was.
    pub fn step(&mut self, time: f64, outline: &Outline) -> Result<FilterStep, FilterError> {
        if !time.is_finite() || time <= self.last_time {
            return Err(FilterError::TimeNotIncreasing { previous: self.last_time, time });
        }
        if self.map.is_none() {
            self.start(time, outline)?;
            return Ok(FilterStep { time, phase: self.phase, accepted: true, update: None });
        }
        self.last_time = time;
        let update = match self.phase {
            Phase::Tracking => self.track(time, outline),
            _ => self.acquire(time, outline),
        };
        let accepted = update.is_some_and(|update| update.accepted);
        if accepted {
            self.accepted += 1;
            self.rejected_in_a_row = 0;
        } else {
            self.rejected += 1;
            self.rejected_in_a_row += 1;
            self.fall_back(time, outline);
        }
        Ok(FilterStep { time, phase: self.phase, accepted, update })
    }

    /// Builds the map from a first frame.
    fn start(&mut self, time: f64, outline: &Outline) -> Result<(), FilterError> {
        self.map = Some(OutlineMap::new(self.settings.model, outline)?);
        self.landmarks = Landmarks::of(outline);
        (self.last_time, self.map_time) = (time, time);
        self.accepted += 1;
        self.rejected_in_a_row = 0;
        self.phase = Phase::Acquiring;
        Ok(())
    }

    /// After a rejected frame: look elsewhere, or begin again.
    fn fall_back(&mut self, time: f64, outline: &Outline) {
        let in_a_row = self.rejected_in_a_row;
        let give_up = match self.phase {
            Phase::Acquiring => in_a_row >= FALSE_START,
            _ => in_a_row >= GIVEN_UP,
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
        map.predict(seconds);
        self.map_time = time;
        map.add_process_noise(&self.settings.process_noise, seconds);
        let adaptive = self.settings.adaptive && self.settings.process_noise == ProcessNoise::default();
        if adaptive && self.change.variance > 0.0 {
            map.add_change(self.change.variance);
        }
        let parameters = map.information.k;
        let limit = SUDDEN * parameters as f64;
        let fits = fits(map, self.settings.smallest_agreement);
        let mut update = map.update(outline, |update| fits(update) && update.innovation <= limit);
        let innovation = map.innovation;
        let has_changed = !update.accepted && fits(&update) && self.rejected_in_a_row > 0;
        if adaptive && has_changed && innovation.fisher > 0.0 {
            // The outline is there, but for the second time not where it was going: the motion has changed.
            map.add_change((innovation.gradient / innovation.fisher).max(0.0));
            update = map.update(outline, fits);
        }
        if adaptive && update.accepted {
            self.change.take(&innovation, parameters);
        }
        map.noise_level.take(update.spread / map.radius);
        Some(update)
    }

    /// Goes on as predicted if that fits, searches for the object otherwise.
    fn acquire(&mut self, time: f64, outline: &Outline) -> Option<MapUpdate> {
        let seconds = time - self.map_time;
        let smallest = self.settings.smallest_agreement;
        let fits = fits(self.map.as_ref()?, smallest);
        if self.phase == Phase::Lost {
            let mut going_on = self.map.clone()?;
            going_on.predict(seconds);
            let update = going_on.update(outline, |u| fits(u) && u.innovation <= LARGEST_INNOVATION);
            if update.accepted {
                self.replace(going_on, time, Phase::Tracking);
                return Some(update);
            }
        }
        let map = self.map.as_mut()?;
        let landmarks = self.landmarks.and_then(|landmarks| {
            let pose: Affine2<f64> = nalgebra::try_convert(map.pose())?;
            Some([landmarks.moved(&pose), Landmarks::of(outline)?])
        });
        let hypotheses = find_pose(map, outline, landmarks);
        // The contour of one frame may hide errors that are smooth along it and change from frame to frame: they are only allowed for
        // where nothing fits without.
        let mut best = self.try_poses(&hypotheses, outline, seconds, false);
        if best.as_ref().is_none_or(|(update, ..)| !update.accepted) {
            best = self.try_poses(&hypotheses, outline, seconds, true).or(best);
        }
        let (update, candidate, phase, rivals) = best?;
        let known = update.accepted || self.phase == Phase::Lost;
        if update.accepted {
            self.rivals = rivals;
            self.replace(candidate, time, phase);
        }
        if let Some(map) = self.map.as_mut().filter(|_| known) {
            map.noise_level.take(update.spread / map.radius);
        }
        Some(update)
    }

    /// Measures the frame in the poses given; best the first that fits clearly better than those before it.
    fn try_poses(
        &self,
        hypotheses: &[Hypothesis],
        outline: &Outline,
        seconds: f64,
        relaxed: bool,
    ) -> Option<(MapUpdate, OutlineMap, Phase, Rivals)> {
        let mut best: Option<(MapUpdate, OutlineMap, Phase, f64)> = None;
        let mut candidates = Vec::with_capacity(2 * KEPT);
        for hypothesis in hypotheses {
            let mut candidate = self.map.clone()?;
            candidate.noise_level.relaxed = relaxed;
            let fits = fits(&candidate, self.settings.smallest_agreement);
            let phase = if self.phase == Phase::Lost {
                // Where it is now says nothing of how it moves now.
                candidate.relocate(hypothesis.pose);
                Phase::Acquiring
            } else {
                let change = hypothesis.pose * candidate.pose.try_inverse()?;
                let Some(motion) = motion_between(self.settings.model, &change, seconds) else { continue };
                candidate.motion = motion;
                candidate.predict(seconds);
                Phase::Tracking
            };
            let update = candidate.update(outline, fits);
            candidates.push((hypothesis.turn, update));
            // The hypotheses come in order: a later one has to be clearly better.
            let better = best.as_ref().is_none_or(|(other, ..)| {
                (update.accepted && !other.accepted)
                    || (update.accepted == other.accepted
                        && ((relaxed && AS_GOOD * update.spread < other.spread)
                            || update.agreement > other.agreement + CLEARLY_BETTER))
            });
            if better {
                best = Some((update, candidate, phase, hypothesis.turn));
            }
        }
        let (update, mut candidate, phase, turn) = best?;
        candidate.noise_level.relaxed = false;
        Some((update, candidate, phase, Rivals::of(turn, &update, &candidates)))
    }

    fn replace(&mut self, map: OutlineMap, time: f64, phase: Phase) {
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

    /// The motion as far as it is known; `None` before the second accepted frame.
    #[must_use]
    pub fn estimate(&self) -> Option<MotionEstimate> {
        if self.phase == Phase::Waiting || (self.phase == Phase::Acquiring) {
            return None;
        }
        self.map.as_ref()?.estimate()
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

    /// Frames that did not fit.
    #[must_use]
    pub fn frames_rejected(&self) -> usize {
        self.rejected
    }

    /// Turns in radians, anticlockwise where y points up, by which the object may just as well have come to the frame in which it was
    /// last searched for and found, besides the one taken: its outline fits equally well there. Of equals the smallest turn is
    /// taken. Empty for outlines without symmetry.
    #[must_use]
    pub fn rival_turns(&self) -> &[f64] {
        &self.rivals.turns[..self.rivals.count]
    }

    /// Times the filter has given up an object and begun anew.
    #[must_use]
    pub fn restarts(&self) -> usize {
        self.restarts
    }
}

/// Turns that explain a frame as well as the one taken.
#[derive(Debug, Clone, Copy, Default)]
struct Rivals {
    turns: [f64; KEPT],
    count: usize,
}

impl Rivals {
    fn of(taken: f64, best: &MapUpdate, candidates: &[(f64, MapUpdate)]) -> Self {
        let mut rivals = Self::default();
        let apart = |a: f64, b: f64| {
            let turn = (a - b + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
            turn.abs() > DIFFERENT_TURN
        };
        for (turn, update) in candidates {
            let equal = update.accepted
                && update.agreement + CLEARLY_BETTER >= best.agreement
                && update.spread <= AS_GOOD * best.spread;
            let known = rivals.turns[..rivals.count].iter().any(|other| !apart(*other, *turn));
            if equal && apart(*turn, taken) && !known && rivals.count < KEPT {
                rivals.turns[rivals.count] = *turn;
                rivals.count += 1;
            }
        }
        rivals
    }
}

/// Whether a frame shows the outline that the map knows.
fn fits(map: &OutlineMap, smallest_agreement: f64) -> impl Fn(&MapUpdate) -> bool + Copy + use<> {
    // Exact points leave what the cells do not follow.
    let largest_noise = map.noise_level.tolerated(map.sigma).max(BEND * map.spacing) * map.radius;
    move |update| update.agreement >= smallest_agreement && update.noise.is_none_or(|noise| noise <= largest_noise)
}
