//! What is stated of the motion, with how well it is known, or why nothing is.
use freeform_estimate::{MotionEstimate, MotionState, PointVelocity};
use freeform_riccati::MAX_PARAMETERS;
use nalgebra::{DMatrix, Point2};

use super::{
    counts::Counts,
    motion_filter::{MotionFilter, Phase},
    stated::Statement,
};
use crate::{
    belief::StateMatrix,
    dynamics::{
        CentredDeviations, Dynamics, DynamicsFilter, Purpose, Summary, UnmodelledEstimate, WrongFamily,
        centred_velocity,
    },
    prediction::PoseMatrix,
    track::{Track, TurnOfPose, TurnTold, of_pose, of_pose_alone},
    tuning::statement as tuning,
};

/// Why nothing is stated of a motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unstated {
    /// The object is lost.
    Lost,
    /// More than 40 % of five frames or more were rejected, or two or more and no fewer than were taken, so that the others are not to be
    /// trusted.
    ManyRejected {
        /// Frames rejected since the object was begun with.
        rejected: usize,
        /// All of them.
        frames: usize,
    },
}

impl MotionFilter {
    fn statement(&self) -> Option<&Statement> {
        self.stated.get_or_init(|| self.stated_now()).as_ref()
    }

    /// The covariance that is stated: what the track knows, with the hypotheses of dynamics, the dependence of frames and what contradicts it
    /// (random); then what the motion model leaves out, edges and rounding (systematic).
    fn stated_now(&self) -> Option<Statement> {
        let track = self.track.as_ref().filter(|track| track.is_shown())?;
        let own = track.summary_in_body_frame()?;
        let (model, centroid) = (self.settings.model, self.centroid_of(track));
        let none = CentredDeviations::zeros();
        let mut random = own;
        let mut factors = CentredDeviations::from_element(1.0);
        if let Some(dynamics) = &self.history.dynamics {
            let summary = dynamics.combined((!dynamics.leads()).then_some(&own), Purpose::Statement).unwrap_or(own);
            (random, factors) = (summary, dynamics.factors());
        }
        random = random.widened(model, &centroid, &factors, [&none, &none])?;
        let mut body_frame = None;
        let beyond =
            self.history.dynamics.as_ref().map_or(Some(PoseMatrix::zeros()), DynamicsFilter::error_beyond_outline);
        if let Some((kept, beyond)) = track.kept_error(&random.pose).zip(beyond) {
            let kept = kept + beyond;
            // It was told by frames that depended on each other as well.
            let kept = Summary { covariance: of_pose_alone(&kept), ..random };
            let widened = kept.widened(model, &centroid, &factors, [&none, &none]);
            body_frame = widened.map(|widened| of_pose(&widened.covariance));
        }
        let doubts = [self.history.contradicted(model.parameter_count()), track.covariance_of_untold_turn()];
        random.covariance += doubts.into_iter().flatten().sum::<StateMatrix>();
        let (unmodelled, moments) = track.unmodelled_motions();
        let mut all = random;
        all.covariance += moments;
        let ones = CentredDeviations::from_element(1.0);
        let [pose, motion] = self.systematic(track, &own, &unmodelled);
        all = all.widened(model, &centroid, &ones, [&pose, &motion])?;
        // Edges may move points by as much, and that is in the deviations already.
        let displacement = unmodelled.displacement * track.reference().radius;
        let is_beyond_doubt = unmodelled.is_beyond_doubt && displacement > self.settings.edge_uncertainty;
        let family = unmodelled.family.filter(|_| is_beyond_doubt);
        Some(Statement { random, all, body_frame, family })
    }

    /// The centroid, in the body frame that the pose which is stated is counted from.
    fn centroid_of(&self, track: &Track) -> Point2<f64> {
        self.history.dynamics.as_ref().map_or(track.map().centroid(), DynamicsFilter::centroid)
    }

    /// Deviations of pose and motion about the centroid, normalised, by what frames do not average out: edges that are displaced, rounding to pixels,
    /// what the motion model leaves out, light, and a motion that changes within the one step that it is known from.
    fn systematic(&self, track: &Track, own: &Summary, unmodelled: &UnmodelledEstimate) -> [CentredDeviations; 2] {
        // Rounding to pixels is a saw tooth as the object moves, whose mean falls with the teeth that the frames show.
        let [pixel, of_side] = track.rounding_of_side();
        let span = track.span_of_motion(self.history.memory());
        let rounding = if pixel > 0.0 { of_side / track.rounding_teeth_seen(span, pixel).max(1.0) } else { 0.0 };
        let [mut of_pose, mut of_motion] = track.systematic([self.settings.edge_uncertainty.hypot(rounding); 2], span);
        // What the motion model does not have need not be constant.
        let sizes = [unmodelled.displacement_of_poses(), unmodelled.displacement];
        let sizes = sizes.map(|size| size * track.reference().radius);
        let [pose, motion] = track.systematic(sizes, track.span_of_motion(None));
        of_pose.zip_apply(&pose, |all, of_model| *all = all.hypot(of_model));
        of_motion.zip_apply(&motion, |all, of_model| *all = all.hypot(of_model));
        let [of_place, of_velocity] = track.shift_by_light(unmodelled);
        for i in centred_velocity(self.settings.model) {
            of_pose[i] = of_pose[i].hypot(of_place);
            of_motion[i] = of_motion[i].hypot(of_velocity);
        }
        if let Some(change) = self.possible_change(track, own) {
            of_motion.apply(|all| *all = all.hypot(change));
        }
        [of_pose, of_motion]
    }

    /// By how much a motion that is known from one step alone, a mean over it, may be off by now, as a deviation of every parameter about the
    /// centroid. None where it is said to be constant, or how it changes.
    fn possible_change(&self, track: &Track, own: &Summary) -> Option<f64> {
        let may_change = matches!(self.settings.followed_dynamics(), Some(Dynamics::Auto | Dynamics::Accelerating));
        let steps = track.belief().memory.steps_since_middle();
        let speed = || own.speed(self.settings.model, &track.centred_pose().centroid);
        (may_change && track.is_found_one_step_ago()).then(|| steps * tuning::CHANGE_IN_A_STEP * speed())
    }

    /// What the outlines do that the motion model does not have, if that is beyond doubt: the model to try is another.
    #[must_use]
    pub fn wrong_family(&self) -> Option<WrongFamily> {
        self.statement()?.family
    }

    /// The estimated motion, at the time of [`state`](Self::state). `None` before the second accepted frame, also after a restart of the
    /// map by a frame that shows the turn of the object for the first time; before the third where the first shows a part of the outline.
    #[must_use]
    pub fn estimate(&self) -> Option<MotionEstimate> {
        if matches!(self.phase, Phase::Waiting | Phase::Acquiring) || self.rests_on_two_parts() {
            return None;
        }
        let track = self.track.as_ref()?;
        let Statement { random, all, .. } = self.statement()?;
        let estimate = track.estimate_of(all, self.turn_told())?.with_random_part(&track.deviations_of(random)?);
        let doubts = self.turn_hypotheses.doubts(&estimate).into_iter().enumerate();
        let is_stated = self.is_stated();
        let unknown =
            doubts.take(self.settings.model.parameter_count()).filter(|(_, doubtful)| *doubtful || !is_stated);
        Some(unknown.fold(estimate, |e, (j, _)| e.with_unobservable(j)))
    }

    /// Whether anything is stated of the motion, be it known well or not.
    fn is_stated(&self) -> bool {
        self.unstated().is_none() && !self.may_still_change() && !self.contradicts_path()
    }

    /// Whether the motion has been seen to change, or not where it was expected, and is known from one step alone since the object was found again:
    /// what that tells is a mean over the step, and by how much it is off the motion at its end nothing says.
    fn may_still_change(&self) -> bool {
        let is_contradicted = self.motion_changed || self.counts.rejected_in_recording > 0;
        is_contradicted && self.track.as_ref().is_some_and(Track::is_found_one_step_ago)
    }

    /// Whether a turn is told by the path of the object, and more frames were rejected than that of a constant generator has.
    fn contradicts_path(&self) -> bool {
        let Counts { accepted_by_track: accepted, rejected_by_track: rejected, .. } = self.counts;
        self.turn_told() == TurnTold::ByPath
            && rejected as f64 > tuning::MOST_REJECTED_OF_PATH * (accepted + rejected) as f64
    }

    /// Whether the turn that is stated is told by the path of the object alone: the outline does not show it, and
    /// [`Dynamics::Generator`](crate::Dynamics::Generator) asks for what a constant generator tells.
    #[must_use]
    pub fn turn_is_told_by_path(&self) -> bool {
        self.turn_told() == TurnTold::ByPath
    }

    fn turn_told(&self) -> TurnTold {
        match &self.history.dynamics {
            Some(dynamics) if dynamics.turn_is_of_path() => TurnTold::ByPath,
            _ => TurnTold::ByOutline,
        }
    }

    /// Which parameters, in the order of the model, the outline does not show, as far as it is known by now. Others that are not stated are
    /// not known well enough.
    #[must_use]
    pub fn hidden_parameters(&self) -> [bool; MAX_PARAMETERS] {
        let none = [false; MAX_PARAMETERS];
        if self.turn_is_told_by_path() {
            return none;
        }
        self.track.as_ref().map_or(none, |track| track.blind_parameters(track.body_pose()))
    }

    /// Whether the outline does not show how the object's centroid moves, as far as it is known by now: some motion that the outline does not show
    /// would move it, no point nearby stays under all of them, and the path does not [tell](Self::turn_is_told_by_path) the turn. Where it does, a
    /// [velocity](Self::velocity) that is not stated is not known well enough.
    #[must_use]
    pub fn hides_velocity(&self) -> bool {
        !self.turn_is_told_by_path() && self.track.as_ref().is_some_and(Track::hides_velocity)
    }

    /// Why nothing is stated of the motion although frames have been taken; `None` where it is stated.
    #[must_use]
    pub fn unstated(&self) -> Option<Unstated> {
        let Counts { accepted_by_track: accepted, rejected_by_track: rejected, .. } = self.counts;
        let frames = accepted + rejected;
        let are_many = rejected >= tuning::FEWEST_REJECTED && rejected as f64 > tuning::MOST_REJECTED * frames as f64;
        // The first frame shows what the object is, but not that it is one.
        let are_outvoted = accepted > 1 && rejected >= tuning::FEWEST_AGAINST && rejected >= accepted;
        if self.phase == Phase::Lost {
            Some(Unstated::Lost)
        } else if are_many || are_outvoted {
            Some(Unstated::ManyRejected { rejected, frames })
        } else {
            None
        }
    }

    /// Other angular velocities, in rad/s, that explain the outlines as well as the one stated: those of the turns of
    /// [`rival_turns`](Self::rival_turns). Empty where those are, and where it is not stated. Where omega is not one of the parameters, the mean
    /// angular velocity (a2 - a3) / 2 of an affine or projective motion stands for it.
    #[must_use]
    pub fn aliases(&self) -> Vec<f64> {
        if self.turn_hypotheses.rival_turns().is_empty() {
            return Vec::new();
        }
        let Some((estimate, track)) = self.estimate().zip(self.track.as_ref()) else { return Vec::new() };
        let Some(omega) = estimate.mean_rate_of_turn() else { return Vec::new() };
        let unit = track.mean_rate_of_turn() / self.seconds_per_unit();
        // Omega is positive clockwise where y points up, turns the other way.
        self.turn_hypotheses.rates_apart().map(|apart| omega - apart * unit).collect()
    }

    /// Pose and motion with their joint covariance, at the time of the last frame that was accepted, or rejected while tracking. `None`
    /// if [`estimate`](Self::estimate) is.
    #[must_use]
    pub fn state(&self) -> Option<MotionState> {
        let Statement { all, body_frame, .. } = self.statement()?;
        let body_frame = body_frame.as_ref()?;
        let estimate = self.estimate()?;
        let mut observable = [false; MAX_PARAMETERS];
        observable.iter_mut().zip(estimate.parameters()).for_each(|(seen, p)| *seen = p.value.is_some());
        let is_ambiguous = self.turn_hypotheses.make_pose_doubtful() && self.ambiguity().is_some();
        let turn = if is_ambiguous { TurnOfPose::Ambiguous } else { TurnOfPose::AsTheOutlineShows };
        let track = self.track.as_ref()?;
        track.state_of((all, body_frame, self.centroid_of(track)), self.clock.of_track, observable, turn)
    }

    /// Velocity of the object's centroid, that of the area within its known outline (the centre of its cells where that is not one closed
    /// contour), at the time of [`state`](Self::state). Where the outline does not show how that moves, it is of the point that it does show: the
    /// centre of a disc of which half is seen. It may be
    /// known while the velocity `b` at the image origin is not, as for a circle. `None` if it is not known, if no such point is nearby, if the
    /// motion is [ambiguous](Self::ambiguity), or if [`estimate`](Self::estimate) is `None`.
    #[must_use]
    pub fn velocity(&self) -> Option<PointVelocity> {
        if self.turn_hypotheses.are_doubtful() || !self.is_stated() || self.hides_velocity() {
            return None;
        }
        self.track.as_ref()?.velocity_of_centroid(&self.state()?)
    }

    /// Covariance of the motion parameters in the order of the model, image units; `None` before the first frame, or if it is not
    /// finite.
    #[must_use]
    pub fn covariance(&self) -> Option<DMatrix<f64>> {
        self.track.as_ref()?.covariance_of(&self.statement()?.all)
    }
}
