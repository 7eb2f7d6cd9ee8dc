//! The object looked for where nothing says how it has moved, with all poses that explain the frame.
use freeform_curve_fit::Outline;

use super::{
    candidate::{Candidate, VerdictOf},
    gates::gate,
    motion_filter::{MotionFilter, Phase},
    tracking::predict,
    turn_hypotheses::TurnHypotheses,
};
use crate::{
    map::TurnEvent,
    measurement::{FirstPose, NegativeLogLikelihood, Tolerance},
    search::{Extent, Landmarks, RegisteredPose, Registration, TurnCentre, symmetry_order},
    track::{Comparison, Doubt, Outcome, Track},
    tuning::{
        supervisor::{FRAMES_OF_SEARCH, LARGEST_INNOVATION},
        turn_profile::LEAP,
        usual_agreement::{BESIDE, ELSEWHERE, FURTHER_ALONG},
    },
    update::Gate,
};

impl MotionFilter {
    /// Goes on as predicted if that fits, searches for the object otherwise.
    pub(super) fn acquire(&mut self, time: f64, outline: &Outline) -> Option<Outcome> {
        let seconds = time - self.clock.of_track;
        let track = self.track.as_ref()?;
        if self.phase == Phase::Lost {
            let gate = Gate { largest_innovation: Some(LARGEST_INNOVATION), ..gate(&self.settings, track) };
            // It is expected as before, by whichever dynamics led then: only a constant generator goes on as the track alone has it.
            let (mut going_on, mut history) = (track.clone(), self.history.clone());
            if !predict(&self.settings, &mut going_on, &mut history, seconds) {
                return self.search(time, seconds, outline);
            }
            let knows_turn = going_on.knows_turn();
            self.frame.load(outline, going_on.reference());
            // Nearly all frames of a lost object show something else.
            let outcome = going_on
                .rejected_at_a_glance(&mut self.frame, &gate)
                .unwrap_or_else(|| going_on.update(&mut self.frame, &gate, Comparison::NotAsked));
            if outcome.is_accepted() {
                // It is there, but nobody knows by how many whole turns.
                if !knows_turn {
                    return self.search(time, seconds, outline);
                }
                history.record(&outcome, seconds, None);
                self.replace(going_on, history, time, Phase::Tracking);
                return Some(self.look_elsewhere(outcome.after_rejected(), time, outline));
            }
            if self.track.as_ref().is_some_and(|track| track.noise().is_found_independent()) {
                return self.search_in_part(time, seconds, outline, outcome);
            }
        }
        self.search(time, seconds, outline)
    }

    /// Searches for a lost object from a part of all turns, and goes on from the others where that leaves hope; `expected` is what became of the
    /// frame where the object was expected. For outlines whose points err independently: where they err together, what a start leaves says little of
    /// whether it leads to the object.
    fn search_in_part(&mut self, time: f64, seconds: f64, outline: &Outline, expected: Outcome) -> Option<Outcome> {
        // Where searches are scarce, whole rounds of parts lie between them.
        let rejected = self.counts.rejected_in_a_row;
        let registration = self.begin_search(outline, Extent::Part(rejected + rejected / FRAMES_OF_SEARCH))?;
        if !registration.is_of_part() {
            return self.measure_found(time, seconds, outline, &registration);
        }
        self.turn_hypotheses = TurnHypotheses::default();
        self.track.as_mut().into_iter().for_each(|track| track.record_normalised_spread(registration.spread()));
        Some(expected)
    }

    /// Where more points than usual of a frame that has been taken disagree, or a turn that little tells is another than expected, they may be those
    /// that tell the pose: the object is searched for, and taken to be where that explains the frame significantly better. A frame that shows no
    /// turn, or another one better, if not significantly, has told none where little tells it, so that others must tell it first. Where few points
    /// agree of those that tell a direction, a pose further along it in which they agree as usual is taken where it explains the
    /// frame better by what few points can say: the others say nothing of it.
    pub(super) fn look_elsewhere(&mut self, outcome: Outcome, time: f64, outline: &Outline) -> Outcome {
        let Some(doubt) = outcome.doubt.filter(|_| outcome.is_accepted()) else { return outcome };
        if !self.may_search() {
            self.track.as_mut().filter(|_| doubt == Doubt::Turn).into_iter().for_each(Track::ask_anew_for_turn);
            return outcome;
        }
        let mut other = self.clone();
        other.phase = Phase::Lost;
        // Turns are counted from where the step to this frame has led.
        let seconds = self.track.as_ref().map_or(0.0, |track| track.belief().memory.step);
        let found = other.search(time, seconds, outline).filter(Outcome::is_accepted);
        self.search_memory.budget = other.search_memory.budget;
        let Some(track) = &mut self.track else { return outcome };
        let (mut is_explained, mut turns_alike) = (false, false);
        if let (Some(found), Some(of_other)) = (found, &other.track) {
            let poses = [*track.body_pose(), *of_other.body_pose()];
            let likelihoods = track.compared(outline, &poses, &mut self.frame);
            // By its own points alone every frame is explained best in a pose beside that which all of them say.
            let is_beside = of_other.displacement_from(&poses[0]) < BESIDE * track.noise().sigma;
            let is_direction = |doubt: Doubt| matches!(doubt, Doubt::Direction { .. });
            let turn = track.turn_to(of_other.body_pose());
            let (lies_near, may_turn) = (turn.abs() < LEAP, doubt.allows_turn(turn));
            let lies_further = is_direction(doubt) && lies_near && !found.doubt.is_some_and(is_direction);
            is_explained = may_turn && !is_beside && likelihoods[0].is_worse_by(0.0, &likelihoods[1]);
            let is_better = lies_further && likelihoods[0].is_worse_by_fit(FURTHER_ALONG, &likelihoods[1])
                || may_turn && likelihoods[0].is_worse_by(ELSEWHERE, &likelihoods[1]);
            if is_better && !is_beside {
                other.counts.turned_elsewhere += usize::from(!lies_near && !track.turn_is_unseen());
                *self = other;
                return found;
            }
            turns_alike = is_explained && track.turn_leaps(of_other.body_pose(), 0.0);
        }
        if !is_explained {
            track.record_as_usual(outcome.measurement.agreement, doubt);
        }
        let pose = *track.body_pose();
        if turns_alike || doubt == Doubt::Turn && !track.shows_turn(outline, &pose, &mut self.frame) {
            track.ask_anew_for_turn();
        }
        outcome
    }

    /// Searches for the object without a guess.
    fn search(&mut self, time: f64, seconds: f64, outline: &Outline) -> Option<Outcome> {
        let registration = self.begin_search(outline, Extent::Whole)?;
        self.measure_found(time, seconds, outline, &registration)
    }

    /// The outline of the track, asked anew whether it shows its turn, brought onto that of the frame; `None` where no more frames are searched.
    fn begin_search(&mut self, outline: &Outline, extent: Extent) -> Option<Registration> {
        if !self.may_search() {
            return None;
        }
        self.search_memory.budget.spend();
        self.track.as_mut().into_iter().for_each(Track::show_turn);
        self.registered(outline, extent)
    }

    /// Measures the poses that a search has found, and takes one of those that explain the frame.
    fn measure_found(
        &mut self,
        time: f64,
        seconds: f64,
        outline: &Outline,
        registration: &Registration,
    ) -> Option<Outcome> {
        if registration.is_hopeless()
            && let Some(outcome) = self.rejected_at_a_glance(registration, seconds)
        {
            return Some(outcome);
        }
        // The contour of one frame may hide errors that are smooth along it and change from frame to frame: they are only allowed for
        // where nothing fits without.
        let mut candidates = self.candidates(outline, seconds, Tolerance::Known, registration);
        let is_relaxed = self.track.as_ref().is_some_and(Track::tolerates_more_relaxed);
        if is_relaxed && !candidates.iter().any(|candidate| candidate.outcome.is_accepted()) {
            let relaxed = self.candidates(outline, seconds, Tolerance::Relaxed, registration);
            candidates = if relaxed.is_empty() { candidates } else { relaxed };
        }
        let agreement = |c: &Candidate| c.outcome.measurement.agreement;
        let nearest = candidates.iter().max_by(|a, b| agreement(a).total_cmp(&agreement(b)))?.outcome;
        let lost = self.phase == Phase::Lost;
        candidates.retain(|candidate| candidate.outcome.is_accepted());
        let (taken, others) = TurnHypotheses::among(candidates, self.search_memory.symmetry, seconds);
        self.turn_hypotheses = others;
        let outcome = taken.as_ref().map_or(nearest, |candidate| candidate.outcome);
        if let Some(taken) = taken {
            // Where a lost object is now says nothing of how it moves now.
            let phase = if lost { Phase::Acquiring } else { Phase::Tracking };
            self.replace(taken.track, self.history.begun_anew(), time, phase);
            self.track.as_mut().into_iter().for_each(|track| track.record_turn(TurnEvent::Confirmed));
        }
        if let Some(track) = self.track.as_mut().filter(|_| outcome.is_accepted() || lost) {
            track.record_spread(&outcome.measurement);
        }
        Some(outcome)
    }

    /// What the loaded frame is off by in the best pose of a registration which says that it shows something else, where one linearisation leaves
    /// no doubt of it. Nothing is found then.
    fn rejected_at_a_glance(&mut self, registration: &Registration, seconds: f64) -> Option<Outcome> {
        let poses = registration.poses(self.track.as_ref()?, &self.frame.points, self.search_memory.symmetry);
        let mut moved = self.moved(&self.tried()?, poses.first()?, seconds)?;
        moved.set_tolerance(Tolerance::Relaxed);
        let outcome = moved.rejected_at_a_glance(&mut self.frame, &gate(&self.settings, &moved))?;
        self.turn_hypotheses = TurnHypotheses::default();
        if let Some(track) = self.track.as_mut().filter(|_| self.phase == Phase::Lost) {
            track.record_spread(&outcome.measurement);
        }
        Some(outcome)
    }

    /// All poses found, measured. A turn of which the frame shows next to nothing is taken to be unseen. The registration is one of the same
    /// frame, in which the turn was asked for.
    fn candidates(
        &mut self,
        outline: &Outline,
        seconds: f64,
        tolerance: Tolerance,
        registration: &Registration,
    ) -> Vec<Candidate> {
        self.track.as_mut().into_iter().for_each(Track::show_turn);
        let (candidates, first) = self.candidates_of(outline, seconds, tolerance, registration, Vec::new());
        let fitting = candidates.iter().filter(|c| c.outcome.is_accepted());
        let Some(best) = fitting.min_by(|a, b| a.likelihood.squares.total_cmp(&b.likelihood.squares)) else {
            return candidates;
        };
        let pose = *best.track.body_pose();
        let Some(track) = self.track.as_mut().filter(|track| !track.turn_is_unseen()) else { return candidates };
        let first = first.unwrap_or_else(|| track.first_of_compared(outline, &pose, &mut self.frame));
        if track.shows_turn_beside(&first, outline, &pose, &mut self.frame) {
            let symmetry = symmetry_order(track, &first, (&pose, TurnCentre::Middle), &mut self.frame);
            if symmetry == self.search_memory.symmetry {
                return candidates;
            }
            self.search_memory.symmetry = symmetry;
            // What has been measured is so in the same way, unless others have vouched for it.
            let is_measured = candidates.iter().all(|candidate| candidate.verdict_of == VerdictOf::Itself);
            let measured = if is_measured { candidates } else { Vec::new() };
            return self.candidates_of(outline, seconds, tolerance, registration, measured).0;
        }
        track.hide_turn();
        let Some(found) = self.registered(outline, Extent::Whole) else { return candidates };
        self.candidates_of(outline, seconds, tolerance, &found, Vec::new()).0
    }

    /// The outline of the track brought onto that of the frame.
    fn registered(&mut self, outline: &Outline, extent: Extent) -> Option<Registration> {
        let track = self.track.as_ref()?;
        let landmarks = self.search_memory.landmarks.and_then(|landmarks| {
            let pose = track.affine_pose()?;
            Some([landmarks.moved(&pose), Landmarks::of(outline)?])
        });
        self.frame.load(outline, track.reference());
        Some(Registration::search(track, &self.frame.points, landmarks, extent))
    }

    /// The poses of a registration with the frame, and those that the symmetry of the outline adds, measured, as far as they are not among
    /// those measured before; of one alone, also what others may be compared with, as long as its frame is loaded.
    fn candidates_of(
        &mut self,
        outline: &Outline,
        seconds: f64,
        tolerance: Tolerance,
        registration: &Registration,
        measured: Vec<Candidate>,
    ) -> (Vec<Candidate>, Option<FirstPose>) {
        let Some(track) = self.track.as_ref() else { return (Vec::new(), None) };
        self.frame.load(outline, track.reference());
        let poses = registration.poses(track, &self.frame.points, self.search_memory.symmetry);
        self.candidates_at(outline, seconds, tolerance, (&poses, measured))
    }

    /// These poses, measured as far as they are not yet.
    fn candidates_at(
        &mut self,
        outline: &Outline,
        seconds: f64,
        tolerance: Tolerance,
        (poses, mut measured): (&[RegisteredPose], Vec<Candidate>),
    ) -> (Vec<Candidate>, Option<FirstPose>) {
        let Some(track) = self.track.as_ref() else { return (Vec::new(), None) };
        let is_same = |(found, candidate): (&RegisteredPose, &Candidate)| found.pose == candidate.found_in;
        if !poses.is_empty() && poses.len() == measured.len() && poses.iter().zip(&measured).all(is_same) {
            // Nothing has been added to what was measured and compared.
            return (measured, None);
        }
        self.frame.load(outline, track.reference());
        let (mut candidates, Some(tried)) = (Vec::new(), self.tried()) else { return (Vec::new(), None) };
        for found in poses {
            if let Some(at) = measured.iter().position(|candidate| candidate.found_in == found.pose) {
                candidates.push(measured.swap_remove(at));
                continue;
            }
            let (turn, change) = (found.turn, track.change_to(&found.pose));
            let Some(mut track) = self.moved(&tried, found, seconds) else { continue };
            track.set_tolerance(tolerance);
            let gate = gate(&self.settings, &track);
            let outcome = track.update(&mut self.frame, &gate, Comparison::NotAsked);
            track.set_tolerance(Tolerance::Known);
            // A projective pose may be all but singular.
            if !track.outline_points().all(|point| point.coords.iter().all(|c| c.is_finite())) {
                continue;
            }
            let likelihood = NegativeLogLikelihood::default();
            let (found_in, verdict_of) = (found.pose, VerdictOf::Itself);
            candidates.push(Candidate { track, outcome, found_in, turn, change, likelihood, verdict_of });
        }
        // Only those that are accepted are compared, with each other and the others.
        let is_any_accepted = candidates.iter().any(|candidate| candidate.outcome.is_accepted());
        if let (Some(track), true, [alone]) = (&self.track, is_any_accepted, candidates.as_mut_slice()) {
            let first = track.first_of_compared(outline, alone.track.body_pose(), &mut self.frame);
            alone.likelihood = track.of_first(&first);
            return (candidates, Some(first));
        }
        if let Some(track) = self.track.as_ref().filter(|_| is_any_accepted) {
            let poses: Vec<_> = candidates.iter().map(|candidate| *candidate.track.body_pose()).collect();
            let likelihoods = track.compared(outline, &poses, &mut self.frame);
            candidates.iter_mut().zip(likelihoods).for_each(|(candidate, of_it)| candidate.likelihood = of_it);
        }
        self.accept_vouched_for(outline, tolerance, &mut candidates);
        (candidates, None)
    }

    /// Accepts candidates too that scatter too much, or have too much beyond known ends, if one that is accepted explains it no better: the frame
    /// shows the object then, and the noise of its points, which few of them hardly tell, and parts that were never seen say nothing against their
    /// poses.
    fn accept_vouched_for(&mut self, outline: &Outline, tolerance: Tolerance, candidates: &mut [Candidate]) {
        let accepted = candidates.iter().filter(|candidate| candidate.outcome.is_accepted()).map(|c| c.likelihood);
        let Some(best) = accepted.min_by(|a, b| a.squares.total_cmp(&b.squares)) else { return };
        for candidate in candidates.iter_mut() {
            let Candidate { track, outcome, likelihood, verdict_of, .. } = candidate;
            if outcome.is_accepted() || likelihood.is_worse_than(&best) {
                continue;
            }
            self.frame.load(outline, track.reference());
            let gate = gate(&self.settings, track);
            let Some(gate) = outcome.gate_if_vouched_for(gate, self.frame.points.len()) else { continue };
            track.set_tolerance(tolerance);
            *verdict_of = VerdictOf::Others;
            *outcome = track.update(&mut self.frame, &gate, Comparison::NotAsked);
            track.set_tolerance(Tolerance::Known);
        }
    }

    /// The track that the poses of a search are tried with: that of a lost object keeps what its poses have in error.
    fn tried(&self) -> Option<Track> {
        let mut track = self.track.clone()?;
        if self.phase == Phase::Lost {
            track.keep_common_error(self.history.dynamics.as_ref());
        }
        Some(track)
    }

    /// A track that poses are tried with, moved into one that was found.
    fn moved(&self, tried: &Track, found: &RegisteredPose, seconds: f64) -> Option<Track> {
        let mut track = tried.clone();
        if self.phase == Phase::Lost {
            track.relocate(found.pose, seconds);
            return track.is_shown().then_some(track);
        }
        let change = found.pose * track.body_pose().try_inverse()?;
        track.set_motion(self.settings.model.motion_between(&change, seconds)?);
        track.predict(seconds).then_some(track)
    }
}
