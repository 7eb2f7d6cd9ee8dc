//! Hypotheses of the turn: turns that explain the frames as well as the one taken, followed until a frame decides.
use std::f64::consts::PI;

use freeform_estimate::MotionEstimate;
use freeform_riccati::MAX_PARAMETERS;

use super::{
    candidate::Candidate,
    settings::FilterSettings,
    symmetry_angle::{SymmetryAngle, is_doubtful},
    turn_hypothesis::{Reason, TurnHypothesis, again_if_vouched_for},
};
use crate::{
    measurement::{Frame, NegativeLogLikelihood},
    track::{Comparison, Outcome, Track, wrapped},
    tuning::{
        symmetry::{NEARBY, OFF_MULTIPLE},
        turn_hypotheses as tuning,
    },
};
#[cfg(feature = "serde")]
use freeform_estimate::StateFormat;

/// All other turns than that of the present track, and what it is compared with them by.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct TurnHypotheses {
    rivals: Vec<TurnHypothesis>,
    /// Their turns, in the same order.
    rival_turns: Vec<f64>,
    /// Of the present track.
    present_turn: f64,
    likelihood: NegativeLogLikelihood,
    frames: usize,
    symmetry_angle: SymmetryAngle,
    /// Time that the turns were made in, in units of the filter.
    acquired_over: f64,
    /// Whether frames at uneven intervals have told turns apart that look the same.
    are_told_by_intervals: bool,
}

impl TurnHypotheses {
    /// Of an outline with a symmetry of some order, 1 where there is none, takes the smallest change of all that are not significantly worse than the best.
    pub(super) fn among(mut candidates: Vec<Candidate>, symmetry: usize, seconds: f64) -> (Option<Candidate>, Self) {
        let symmetry_angle = SymmetryAngle::of_order(symmetry);
        let different_turn = symmetry_angle.different_turn();
        candidates.sort_by(|a, b| a.likelihood.squares.total_cmp(&b.likelihood.squares));
        let Some(best) = candidates.first().map(|c| c.likelihood) else { return (None, Self::default()) };
        candidates.retain(|candidate| !candidate.likelihood.is_worse_than(&best));
        // The best of those with one turn stands for them.
        let mut different: Vec<Candidate> = Vec::new();
        for candidate in candidates {
            if different.iter().all(|other| wrapped(other.turn - candidate.turn).abs() > different_turn) {
                different.push(candidate);
            }
        }
        different.sort_by(|a, b| a.change.total_cmp(&b.change));
        let mut others = different.into_iter();
        let taken = others.next();
        let mut all = Self {
            present_turn: taken.as_ref().map_or(0.0, |c| c.turn),
            likelihood: taken.as_ref().map_or_else(NegativeLogLikelihood::default, |c| c.likelihood),
            symmetry_angle,
            acquired_over: seconds,
            ..Self::default()
        };
        if taken.is_some() {
            for turn in symmetry_angle.turns_like(all.present_turn) {
                all.rival_turns.push(turn);
                let found =
                    others.as_slice().iter().find(|candidate| wrapped(candidate.turn - turn).abs() < different_turn);
                let likelihood = found.map_or_else(NegativeLogLikelihood::default, |candidate| candidate.likelihood);
                let track = found.map(|candidate| candidate.track.clone());
                all.rivals.push(TurnHypothesis::new(track, likelihood, Reason::Symmetry));
            }
        }
        let present_turn = all.present_turn;
        for candidate in others.filter(|candidate| !symmetry_angle.makes_alike(candidate.turn, present_turn)) {
            all.rival_turns.push(candidate.turn);
            let (likelihood, track) = (candidate.likelihood, Some(candidate.track));
            all.rivals.push(TurnHypothesis::new(track, likelihood, Reason::Likeness));
        }
        (taken, all)
    }

    /// Puts a turn in doubt that is more than half of what the outline looks the same by, over so short a time that no frames have told it from one in
    /// the other direction.
    pub(super) fn doubt_more_than_half(&mut self, turn: f64, seconds: f64) {
        let angle = self.symmetry_angle.radians();
        let is_in_doubt = |i: usize| self.rivals[i].reason == Reason::Symmetry && self.is_doubtful(i);
        if turn.abs() <= 0.5 * angle || self.are_told_by_intervals || (0..self.rivals.len()).any(is_in_doubt) {
            return;
        }
        self.count_over(turn, seconds);
        self.name_alike(turn - angle.copysign(turn));
    }

    /// Names the turns that look like that of the present track, over so long a time, of an outline that has been found to have a symmetry of some order
    /// after the search that the turn was taken in.
    pub(super) fn name_symmetry(&mut self, symmetry: usize, turn: f64, seconds: f64) {
        if self.are_told_by_intervals {
            return;
        }
        self.count_over(turn, seconds);
        self.symmetry_angle = SymmetryAngle::of_order(symmetry);
        self.name_turns_alike();
    }

    /// Takes as the present turn what is made of it in another time, and the others with it.
    fn count_over(&mut self, turn: f64, seconds: f64) {
        for rival in &mut self.rival_turns {
            let apart = *rival - self.present_turn;
            *rival = turn + if self.acquired_over > 0.0 { apart * seconds / self.acquired_over } else { 0.0 };
        }
        (self.present_turn, self.acquired_over) = (turn, seconds);
    }

    /// After an exchange, names the turns that look like the one taken now in place of those that look like the one before.
    fn name_turns_alike(&mut self) {
        for index in (0..self.rivals.len()).rev() {
            if self.rivals[index].reason == Reason::Symmetry && self.rivals[index].track.is_none() {
                self.remove(index);
            }
        }
        // Some that only looked like the one before look the same as the one taken now: the path does not tell them apart.
        for (hypothesis, turn) in self.rivals.iter_mut().zip(&self.rival_turns) {
            if self.symmetry_angle.makes_alike(*turn, self.present_turn) {
                hypothesis.reason = Reason::Symmetry;
            }
        }
        for turn in self.symmetry_angle.turns_like(self.present_turn) {
            self.name_alike(turn);
        }
    }

    /// Names a turn that looks like the present one: that of a rival which has it already is one that no frame decides against.
    fn name_alike(&mut self, turn: f64) {
        let different_turn = self.symmetry_angle.different_turn();
        match self.rival_turns.iter().position(|other| (other - turn).abs() <= different_turn) {
            Some(index) => self.rivals[index].reason = Reason::Symmetry,
            None => {
                self.rival_turns.push(turn);
                self.rivals.push(TurnHypothesis::new(None, NegativeLogLikelihood::default(), Reason::Symmetry));
            }
        }
    }

    pub(super) fn rival_turns(&self) -> &[f64] {
        &self.rival_turns
    }

    pub(super) fn present_turn(&self) -> f64 {
        self.present_turn
    }

    /// Rates of turning, per unit of time, by which the others differ from the one taken.
    pub(super) fn rates_apart(&self) -> impl Iterator<Item = f64> + '_ {
        self.rival_turns.iter().map(|turn| (turn - self.present_turn) / self.acquired_over)
    }

    /// Turns of those that the smaller turn cannot be taken for granted against.
    pub(super) fn doubtful_turns(&self) -> Vec<f64> {
        (0..self.rivals.len()).filter(|i| self.is_doubtful(*i)).map(|i| self.rival_turns[i]).collect()
    }

    /// Whether the smaller turn cannot be taken for granted.
    pub(super) fn are_doubtful(&self) -> bool {
        (0..self.rivals.len()).any(|i| self.is_doubtful(i))
    }

    /// Whether the smaller turn cannot be taken for granted against one that leads to another pose: a whole turn more or less does not.
    pub(super) fn make_pose_doubtful(&self) -> bool {
        let least = self.symmetry_angle.different_turn();
        let differs = |i: usize| wrapped(self.rival_turns[i] - self.present_turn).abs() > least;
        (0..self.rivals.len()).any(|i| self.is_doubtful(i) && differs(i))
    }

    fn is_doubtful(&self, index: usize) -> bool {
        self.rivals[index].is_shown
            || is_doubtful(self.rival_turns[index], self.present_turn)
            || self.is_preferred(index)
    }

    /// Whether the first frames speak for a rival, though not beyond doubt, and the next ones will tell: a nut with a small mark may have turned by two
    /// of its sides and a little, or by that little.
    fn is_preferred(&self, index: usize) -> bool {
        let TurnHypothesis { track, likelihood, reason, .. } = &self.rivals[index];
        let of = |likelihood: NegativeLogLikelihood| match reason {
            Reason::Likeness => likelihood,
            Reason::Symmetry => likelihood.of_points(),
        };
        let is_told_soon = track.is_some() && self.frames < tuning::FOLLOWED;
        is_told_soon && of(self.likelihood).is_worse_by(tuning::PREFERRED, &of(*likelihood))
    }

    /// The parameters in which the motion of a doubtful hypothesis differs from an estimate.
    pub(super) fn doubts(&self, estimate: &MotionEstimate) -> [bool; MAX_PARAMETERS] {
        let mut doubts = [false; MAX_PARAMETERS];
        for hypothesis in (0..self.rivals.len()).filter(|i| self.is_doubtful(*i)).map(|i| &self.rivals[i]) {
            if hypothesis.reason == Reason::Symmetry {
                return [true; MAX_PARAMETERS];
            }
            let Some(other) = hypothesis.track.as_ref().and_then(Track::estimate) else { continue };
            for ((doubt, parameter), other) in doubts.iter_mut().zip(estimate.parameters()).zip(other.values()) {
                let known = parameter.value.zip(parameter.standard_deviation);
                *doubt |= known.is_some_and(|(value, deviation)| (value - other).abs() > tuning::DIFFERENT * deviation);
            }
        }
        doubts
    }

    /// Whether frames are to be compared.
    pub(super) fn comparison(&self) -> Comparison {
        let is_any_followed = self.rivals.iter().any(|hypothesis| hypothesis.track.is_some());
        if is_any_followed { Comparison::Asked } else { Comparison::NotAsked }
    }

    /// Measures the loaded frame, which the track has just been updated with, or not, with every other hypothesis; the track is exchanged for
    /// one that explains the frames significantly better. Gives what was found of the frame in the end.
    pub(super) fn decide(
        &mut self,
        settings: &FilterSettings,
        (track, frame): (&mut Track, &mut Frame),
        outcome: Outcome,
        seconds: f64,
    ) -> Outcome {
        if self.rivals.is_empty() {
            return outcome;
        }
        let mut outcome = outcome;
        let mut is_another = false;
        self.frames += 1;
        let before = self.likelihood;
        self.likelihood.add(&outcome.likelihood);
        if outcome.is_accepted() {
            self.compare_intervals(seconds);
        }
        for index in (0..self.rivals.len()).rev() {
            if self.rivals[index].track.is_none() {
                continue;
            }
            let farthest_turn = NEARBY * self.apart_from_others(index);
            let rival = &mut self.rivals[index];
            let Some(found) = rival.follow(settings, (track, frame), &outcome, (seconds, farthest_turn)) else {
                // One that cannot be predicted is no way in which the object may have turned.
                self.rule_out(index);
                continue;
            };
            let of_rival = rival.likelihood;
            let is_vouched_for = outcome.is_accepted() && !of_rival.is_worse_than(&self.likelihood);
            let found = if is_vouched_for { rival.again_if_vouched_for(settings, frame, found) } else { found };
            let is_alike = rival.reason == Reason::Likeness;
            // Searches that began apart may find the same motion in the end.
            let are_compared = is_alike && outcome.is_accepted() && found.is_accepted();
            let have_met = are_compared && rival.has_met(track, self.symmetry_angle.different_turn());
            if found.is_accepted() && !self.likelihood.is_worse_than(&of_rival) {
                outcome = again_if_vouched_for(track, settings, frame, outcome);
            }
            // Of what looks the same the path decides nothing.
            let [of_present, of_points] = [self.likelihood, of_rival].map(NegativeLogLikelihood::of_points);
            rival.is_shown = !is_alike && of_present.is_worse_than(&of_points);
            let are_told_apart = rival.is_shown
                && self.frames >= tuning::FOLLOWED
                && of_present.is_worse_by(tuning::NOT_THE_SAME, &of_points);
            let is_worse =
                if is_alike { of_rival.is_worse_than(&self.likelihood) } else { of_points.is_worse_than(&of_present) };
            let is_better = are_told_apart
                || is_alike
                    && (self.likelihood.is_worse_than(&of_rival) || have_met && of_rival.all() < self.likelihood.all());
            if found.is_accepted() && (!outcome.is_accepted() || is_better) {
                self.exchange(index, track);
                if are_told_apart {
                    self.deny_symmetry();
                }
                is_another |= is_alike || are_told_apart;
                let is_ruled_out =
                    !outcome.is_accepted() || self.rivals[index].likelihood.is_worse_than(&self.likelihood);
                if is_ruled_out || have_met {
                    self.rule_out(index);
                }
                outcome = found;
            } else if outcome.is_accepted() && (have_met || !found.is_accepted() || is_worse) {
                self.rule_out(index);
            }
        }
        if !outcome.is_accepted() {
            // A frame that is not taken may show something else: what its points are nearer to says nothing of the turn.
            self.frames -= 1;
            self.likelihood = before;
            for rival in self.rivals.iter_mut().filter(|rival| rival.track.is_some()) {
                rival.forget_last_frame();
                rival.is_shown =
                    rival.reason == Reason::Symmetry && before.of_points().is_worse_than(&rival.likelihood.of_points());
            }
        }
        if is_another {
            self.name_turns_alike();
            self.compare_intervals(seconds);
        }
        self.follow_no_longer_than_needed();
        outcome
    }

    /// The smallest angle between the turns of a rival and of any other hypothesis, over the step that they were taken in, rad.
    fn apart_from_others(&self, index: usize) -> f64 {
        let others = self.rival_turns.iter().enumerate().filter(|(other, _)| *other != index).map(|(_, turn)| turn);
        let apart = others.chain([&self.present_turn]).map(|turn| wrapped(turn - self.rival_turns[index]).abs());
        apart.fold(PI, f64::min)
    }

    /// Makes a rival the present track, and that the rival.
    fn exchange(&mut self, index: usize, track: &mut Track) {
        let rival = &mut self.rivals[index];
        if let Some(other) = &mut rival.track {
            std::mem::swap(other, track);
        }
        std::mem::swap(&mut self.likelihood, &mut rival.likelihood);
        std::mem::swap(&mut self.present_turn, &mut self.rival_turns[index]);
        self.rivals[index].is_shown = false;
    }

    /// After frames that tell turns apart which had looked the same: an outline with a mark that was hidden, or smaller than what one frame shows.
    fn deny_symmetry(&mut self) {
        self.symmetry_angle = SymmetryAngle::WHOLE_TURN;
        // Their paths have not counted so far.
        self.likelihood = self.likelihood.of_points();
        for hypothesis in self.rivals.iter_mut().filter(|hypothesis| hypothesis.track.is_some()) {
            (hypothesis.reason, hypothesis.is_shown) = (Reason::Likeness, false);
            hypothesis.likelihood = hypothesis.likelihood.of_points();
        }
    }

    /// After a frame that decides against a rival.
    fn rule_out(&mut self, index: usize) {
        match self.rivals[index].reason {
            Reason::Likeness => self.remove(index),
            // Its path is no evidence.
            Reason::Symmetry => (self.rivals[index].track, self.rivals[index].is_shown) = (None, false),
        }
    }

    /// Lets go of the tracks of turns that are surely larger, after some frames.
    fn follow_no_longer_than_needed(&mut self) {
        if self.frames < tuning::FOLLOWED {
            return;
        }
        for index in 0..self.rivals.len() {
            if !self.is_doubtful(index) {
                self.rivals[index].track = None;
            }
        }
    }

    /// Leaves out turns of a symmetric outline that are no multiple of its angle apart over another interval between frames.
    fn compare_intervals(&mut self, seconds: f64) {
        for index in (0..self.rivals.len()).rev() {
            if self.rivals[index].reason == Reason::Symmetry {
                let apart = (self.rival_turns[index] - self.present_turn) * seconds
                    / (self.acquired_over * self.symmetry_angle.radians());
                if (apart - apart.round()).abs() > OFF_MULTIPLE {
                    self.are_told_by_intervals = true;
                    self.remove(index);
                }
            }
        }
    }

    /// Turns and tracks of those that are followed.
    pub(super) fn followed(&self) -> impl Iterator<Item = (f64, &Track)> + '_ {
        let tracks = self.rivals.iter().map(|hypothesis| hypothesis.track.as_ref());
        self.rival_turns.iter().zip(tracks).filter_map(|(turn, track)| Some((*turn, track?)))
    }

    /// Exchanges the tracks of all hypotheses, by their turns, for others that have taken the same frames on a map cut anew. Those that have none are
    /// ruled out: on the new map not all of these frames are taken with their motion.
    pub(super) fn remap(&mut self, mut track_of: impl FnMut(f64) -> Option<Track>) {
        for index in (0..self.rivals.len()).rev() {
            if let Some(track) = &mut self.rivals[index].track {
                match track_of(self.rival_turns[index]) {
                    Some(new) => *track = new,
                    None => self.rule_out(index),
                }
            }
        }
    }

    fn remove(&mut self, index: usize) {
        self.rivals.remove(index);
        self.rival_turns.remove(index);
    }
}

#[cfg(feature = "serde")]
impl TurnHypotheses {
    /// Whether turns belong to hypotheses, and all numbers can be worked with; `restore` makes their tracks usable, or tells that it cannot.
    pub(super) fn restore(&mut self, restore: impl Fn(&mut Track) -> bool) -> bool {
        let numbers = self.rival_turns.iter().chain([&self.present_turn]);
        let is_valid = numbers.into_iter().all(|turn| turn.is_finite())
            && self.rival_turns.len() == self.rivals.len()
            && self.likelihood.is_valid()
            && self.rivals.iter().all(|hypothesis| hypothesis.likelihood.is_valid())
            && self.frames < StateFormat::MOST_COUNTED
            && self.symmetry_angle.is_valid()
            && (self.rivals.is_empty() || self.acquired_over.is_finite() && self.acquired_over > 0.0);
        is_valid && self.rivals.iter_mut().filter_map(|hypothesis| hypothesis.track.as_mut()).all(restore)
    }
}
