use std::sync::OnceLock;

use freeform_curve_fit::Outline;
use freeform_estimate::TimeNotIncreasing;
use nalgebra::{Point2, Projective2};

use super::{
    between_frames::BetweenFrames,
    clock::Clock,
    counts::Counts,
    error::FilterError,
    filter_step::FilterStep,
    motion_change::MotionHistory,
    repeated_frames::{BeforeRepeated, RepeatedFrames},
    search_memory::SearchMemory,
    settings::FilterSettings,
    stated::Statement,
    tracking::advance,
    turn_hypotheses::TurnHypotheses,
    window::InitialisationWindow,
};
use crate::{
    dynamics::{DynamicsFilter, DynamicsWeights},
    measurement::Frame,
    occlusion::StandingEdges,
    track::{Doubt, KnownOutline, Outcome, Track},
    update::{FrameMeasurement, Rejection},
};

/// The phase of the filter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Phase {
    /// No frame yet.
    Waiting,
    /// The outline is known, its motion is not. The object is searched for in the next frames; after two seconds of video in vain in one of
    /// 16.
    Acquiring,
    /// Outline and motion are known and predict the next frame.
    Tracking,
    /// The object was not found in the last frames. It is searched for in every frame; in fewer where that has been in vain for long.
    Lost,
}

/// Identifies the motion of one object from its outlines, one frame after the other, in constant memory.
///
/// The first frame starts a map of the outline. The pose in the second frame is found by global registration, without an initial guess.
/// From the third frame on, motion, pose and outline are estimated together, with errors near the Cramer-Rao bound. Frames that do not
/// fit are rejected and counted; after a few of them the object is searched for again. Frames may be missing and may come at uneven
/// times.
///
/// A turn is taken from the outline, never from the path of the object alone. For a circle the angular velocity is therefore not
/// observable, also along an arc; [`velocity`](Self::velocity) is still known. [`Dynamics::Generator`](crate::Dynamics::Generator) asks for the
/// turn that the path tells: see [`turn_is_told_by_path`](Self::turn_is_told_by_path).
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
///     assert!(filter.step(time, &outline)?.is_accepted());
/// }
/// let estimate = filter.estimate().expect("ten good frames");
/// let omega = estimate.parameters().next().expect("omega comes first");
/// assert!((omega.value.expect("an egg is not round") + 0.5).abs() < 0.01);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MotionFilter {
    pub(super) settings: FilterSettings,
    pub(super) phase: Phase,
    pub(super) track: Option<Track>,
    pub(super) clock: Clock,
    pub(super) counts: Counts,
    pub(super) search_memory: SearchMemory,
    pub(super) history: MotionHistory,
    /// Whether the motion of the present track has ever been seen to change.
    pub(super) motion_changed: bool,
    pub(super) turn_hypotheses: TurnHypotheses,
    pub(super) window: InitialisationWindow,
    pub(super) repeated: RepeatedFrames,
    pub(super) before_repeated: Option<Box<BeforeRepeated>>,
    /// Straight edges that are not of the object.
    pub(super) edges: StandingEdges,
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) between_frames: BetweenFrames,
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) frame: Frame,
    /// What is stated after the last step, once it has been asked for.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) stated: OnceLock<Option<Statement>>,
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
            track: None,
            clock: Clock::default(),
            counts: Counts::default(),
            search_memory: SearchMemory::default(),
            history: MotionHistory::default(),
            motion_changed: false,
            turn_hypotheses: TurnHypotheses::default(),
            window: InitialisationWindow::default(),
            repeated: RepeatedFrames::default(),
            before_repeated: None,
            edges: StandingEdges::default(),
            between_frames: BetweenFrames::default(),
            frame: Frame::default(),
            stated: OnceLock::new(),
        })
    }

    /// Processes the outline seen at a time in seconds.
    ///
    /// # Errors
    /// A time that is not finite or not after the last one; a first outline with fewer than 8 points. The filter is then unchanged.
    pub fn step(&mut self, time: f64, outline: &Outline) -> Result<FilterStep, FilterError> {
        TimeNotIncreasing::check(self.clock.last_frame * self.seconds_per_unit(), time)?;
        self.do_what_is_due();
        self.between_frames.begin_frame();
        self.stated.take();
        self.choose_time_unit(time);
        let (seconds, time) = (time, time / self.seconds_per_unit());
        if self.track.is_none() {
            self.start(time, outline)?;
            self.look_for_edges(outline, seconds);
            self.repeated.take(seconds, outline);
            return Ok(self.begun(seconds));
        }
        let shows_edge = self.look_for_edges(outline, seconds);
        let is_repeated = self.repeated.take(seconds, outline);
        let Some(left) = self.edges.left_of(outline) else { return Ok(self.be_hidden(seconds, time)) };
        let left = &*left;
        if shows_edge && self.holds_edge(left) && self.begin_beside_edge(time, left) {
            return Ok(self.begun(seconds));
        }
        if is_repeated && self.may_have_moved() {
            self.pass_over(time);
            return Ok(self.step_unmeasured(seconds, Some(Rejection::Repeated)));
        }
        self.go_back_before_repeated();
        let (measurement, rejection) = self.process_beside_edges(time, left, shows_edge);
        Ok(FilterStep { time: seconds, phase: self.phase, measurement, rejection })
    }

    /// Processes a frame after the first, at a time in units of time: it is followed where the object is tracked, else looked for; what is taken is
    /// kept for remapping, and after frames that are not taken the filter may fall back on others.
    pub(super) fn process(&mut self, time: f64, outline: &Outline) -> (Option<FrameMeasurement>, Option<Rejection>) {
        self.do_what_is_due();
        self.measure_before_next();
        self.lose_if_turn_is_unknown(time);
        self.clock.last_frame = time;
        let was_changing = self.history.is_changing();
        let is_searched = self.may_search();
        let outcome = match self.phase {
            _ if !self.shows_enough(outline) => None,
            Phase::Tracking => self.follow_or_lose(time, outline),
            _ => self.acquire(time, outline),
        };
        self.search_memory.budget.add_frame(self.phase == Phase::Tracking);
        let mut rejection = outcome.map_or(Some(Rejection::NotFound), |outcome| outcome.verdict.err());
        if is_searched && rejection.is_some() && self.begin_with_more(time, outline) {
            return (None, None);
        }
        let is_found_elsewhere = rejection.is_none() && self.phase == Phase::Acquiring;
        if is_found_elsewhere && self.rests_on_two_parts() {
            self.begin_unrelated(time, outline);
            rejection = Some(Rejection::NotFound);
        } else if rejection.is_none() {
            self.counts.add_accepted();
            self.search_memory.unfound.clear();
            let changes = !was_changing && self.history.is_changing();
            self.keep(time, outline, changes);
            self.ask_again_for_symmetry(outline);
            self.doubt_large_turns();
            if self.track.as_ref().is_some_and(Track::may_show_turn) {
                self.begin_with_turn(outline);
            }
        } else {
            self.counts.add_rejected();
            self.fall_back(time, outline);
        }
        self.keep_if_sparse(time, outline);
        (outcome.map(|outcome| outcome.measurement), rejection)
    }

    /// Takes the interval between the first two frames, up to a factor of two, as unit of time: so seconds may be nanoseconds or years.
    fn choose_time_unit(&mut self, time: f64) {
        let interval = time - self.clock.last_frame;
        if self.clock.unit.is_some() || self.track.is_none() || !interval.is_finite() {
            return;
        }
        let unit = interval.log2().round().exp2();
        let unit = if unit.is_normal() && (1.0 / unit).is_normal() { unit } else { 1.0 };
        self.clock.unit = Some(unit);
        self.clock.last_frame /= unit;
        self.clock.of_track /= unit;
        self.window.divide_times(unit);
        self.search_memory.sparse.divide_times(unit);
        self.track.as_mut().into_iter().for_each(|track| track.set_time_unit(unit));
    }

    pub(super) fn seconds_per_unit(&self) -> f64 {
        self.clock.unit.unwrap_or(1.0)
    }

    /// Predicts and measures; `None` where the object cannot be predicted, and is lost.
    pub(super) fn follow(&mut self, time: f64, outline: &Outline) -> Option<Outcome> {
        let turns = self.turns();
        let track = self.track.as_mut()?;
        let seconds = time - self.clock.of_track;
        let is_after_rejected = self.counts.rejected_in_a_row > 0;
        let (frame, comparison) = (&mut self.frame, self.turn_hypotheses.comparison());
        frame.load(outline, track.reference());
        let expected = track.is_all_but_round().then(|| (*track.body_pose(), track.turn_in(seconds)));
        let advanced = advance(
            &self.settings,
            (track, frame),
            &mut self.history,
            (seconds, is_after_rejected),
            (turns, comparison),
        );
        let Some(mut outcome) = advanced else {
            self.phase = Phase::Lost;
            return None;
        };
        self.clock.of_track = time;
        self.motion_changed |= self.history.is_changing();
        track.record_spread(&outcome.measurement);
        if outcome.is_accepted() && expected.is_some_and(|(before, turn)| track.turn_leaps(&before, turn)) {
            outcome.doubt = outcome.doubt.or(Some(Doubt::Turn));
        }
        if is_after_rejected {
            outcome = outcome.after_rejected();
        }
        let (turn, was_accepted) = (self.turn_hypotheses.present_turn(), outcome.is_accepted());
        let outcome = self.turn_hypotheses.decide(&self.settings, (track, frame), outcome, seconds);
        if self.turn_hypotheses.present_turn() != turn || outcome.is_accepted() != was_accepted {
            self.history = self.history.begun_anew();
        }
        if outcome.is_accepted() && track.add_to_turn_profile(outline, &outcome, frame) {
            track.refute_turn();
            self.turn_hypotheses = TurnHypotheses::default();
        }
        Some(outcome)
    }

    /// Probabilities of the hypotheses of dynamics; `None` where they are not told: before the third frame, with process noise, and
    /// for projective motion that the outline does not show as a whole.
    #[must_use]
    pub fn dynamics(&self) -> Option<DynamicsWeights> {
        self.history.dynamics.as_ref().map(DynamicsFilter::weights)
    }

    /// Takes another track, and what its motion has been as far as that is known of it.
    pub(super) fn replace(&mut self, track: Track, history: MotionHistory, time: f64, phase: Phase) {
        (self.track, self.history) = (Some(track), history);
        self.clock.of_track = time;
        self.phase = phase;
        self.repeated.forget_steps();
    }

    /// The settings.
    #[must_use]
    pub fn settings(&self) -> &FilterSettings {
        &self.settings
    }

    /// The phase of the filter.
    #[must_use]
    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// The map of the image from the outline of the first frame to its place in the last accepted frame; after rejected frames, to its
    /// predicted place. `None` before the first frame.
    #[must_use]
    pub fn pose(&self) -> Option<Projective2<f64>> {
        self.track.as_ref().map(Track::pose)
    }

    /// The outline as now known, image coordinates: one point per cell of its map. The points are not ordered if the map has grown.
    /// Empty before the first frame.
    pub fn outline_points(&self) -> impl Iterator<Item = Point2<f64>> + '_ {
        self.track.iter().flat_map(Track::outline_points)
    }

    /// The known outline in order along the contour, in its place in the first frame, with the present pose. `None` before the first frame.
    #[must_use]
    pub fn known_outline(&self) -> Option<KnownOutline> {
        self.track.as_ref().map(Track::known_outline)
    }

    /// Standard deviation of the noise on the points, image lengths; `None` before the first frame. Where points state deviations of their
    /// own, that of good ones.
    #[must_use]
    pub fn noise(&self) -> Option<f64> {
        self.track.as_ref().map(|track| track.sigma() * track.reference().radius)
    }

    pub(crate) fn track(&self) -> Option<&Track> {
        self.track.as_ref()
    }

    /// Frames used.
    #[must_use]
    pub fn frames_accepted(&self) -> usize {
        self.counts.accepted_in_recording
    }

    /// Frames that did not fit. A frame that starts a new track after others is included.
    #[must_use]
    pub fn frames_rejected(&self) -> usize {
        self.counts.rejected_in_recording
    }

    /// Mean share of the points of a frame that lie off the known outline together with their neighbours, from 0.08 on:
    /// a part of the object moves by itself or bends, two objects are seen as one, or something covers it. What is stated is the motion of the rest.
    /// `None` before six frames were taken, and below 0.08.
    #[must_use]
    pub fn disagreeing_part(&self) -> Option<f64> {
        self.track()?.disagreeing_part()
    }

    /// The other hypotheses of the turn, in radians, anticlockwise if y points up: turns of the object, up to the frame in which it was last
    /// searched for and found, that explain all frames since then about as well as the turn taken. Of equally good turns the smallest is
    /// taken. Empty for outlines without symmetry, unless they turn by more than a third of a circle: a whole turn more or less looks the
    /// same. [`ambiguity`](Self::ambiguity) tells whether the motion is in doubt.
    #[must_use]
    pub fn rival_turns(&self) -> &[f64] {
        self.turn_hypotheses.rival_turns()
    }

    /// Whether the innovations have shown a change of motion. The estimate is then that of the last frame, not of all frames. Always false
    /// if `FilterSettings::process_noise` allows for changes.
    #[must_use]
    pub fn motion_changed(&self) -> bool {
        self.motion_changed
    }

    /// How often the filter has given up an object and started again.
    #[must_use]
    pub fn restarts(&self) -> usize {
        self.counts.restarts
    }

    /// Counted up from 0 where poses get another reference: the object was [begun anew](Self::restarts), the second frame shows far more of it than
    /// the first, its turn is shown for the first time (nobody knows how far it had turned until then), another of several turns is taken (as with
    /// every tooth of a gear: the outline may have misled), or an [edge](Self::standing_edges) proves not to be of it.
    #[must_use]
    pub fn segment(&self) -> usize {
        self.counts.segment()
    }
}
