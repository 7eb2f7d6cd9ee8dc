//! Hypotheses: turns that explain the frames as well as the one taken, followed until a frame decides.
use std::f64::consts::TAU;

use freeform_estimate::MotionEstimate;
use freeform_riccati::MAX_PARAMETERS;

use super::{
    settings::FilterSettings,
    tracking::{gate, largest_innovation},
};
use crate::{
    measurement::{Frame, NegativeLogLikelihood},
    track::{Comparison, Outcome, Track, wrapped},
    tuning::{
        hypotheses as tuning,
        symmetry::{OFF_MULTIPLE, SAME},
    },
    update::Gate,
};
#[cfg(feature = "serde")]
use freeform_estimate::StateFormat;

/// The track in a pose that was tried.
#[derive(Debug, Clone)]
pub(super) struct Candidate {
    pub(super) track: Track,
    pub(super) outcome: Outcome,
    /// Turn from the pose before, rad, anticlockwise where y points up.
    pub(super) turn: f64,
    pub(super) likelihood: NegativeLogLikelihood,
}

/// One other way in which the object may have turned.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Hypothesis {
    /// While it is followed.
    track: Option<Track>,
    likelihood: NegativeLogLikelihood,
    ground: Ground,
}

/// Why a turn may have been another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
enum Ground {
    /// It explains the frames so far as well, and is followed until a frame decides.
    Likeness,
    /// The outline has a symmetry: no frame will decide, and the path of the object must not.
    Symmetry,
}

/// All others, and what the one taken is compared with them by.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Hypotheses {
    list: Vec<Hypothesis>,
    /// Their turns, in the same order.
    turns: Vec<f64>,
    taken: f64,
    likelihood: NegativeLogLikelihood,
    frames: usize,
    /// Angle of symmetry, rad.
    pitch: f64,
    /// Time that the turns were made in, in units of the filter.
    acquired_over: f64,
}

impl Hypotheses {
    /// Of an outline with a symmetry of some order, 1 where there is none, takes the smallest turn of all that are not significantly worse than the best.
    pub(super) fn among(mut candidates: Vec<Candidate>, symmetry: usize, seconds: f64) -> (Option<Candidate>, Self) {
        let pitch = TAU / symmetry as f64;
        let different_turn = different_turn(pitch);
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
        different.sort_by(|a, b| a.turn.abs().total_cmp(&b.turn.abs()));
        let mut others = different.into_iter();
        let taken = others.next();
        let mut all = Self {
            taken: taken.as_ref().map_or(0.0, |c| c.turn),
            likelihood: taken.as_ref().map_or_else(NegativeLogLikelihood::default, |c| c.likelihood),
            pitch,
            acquired_over: seconds,
            ..Self::default()
        };
        if taken.is_some() {
            for turn in all.alike() {
                all.turns.push(turn);
                let found =
                    others.as_slice().iter().find(|candidate| wrapped(candidate.turn - turn).abs() < different_turn);
                let likelihood = found.map_or_else(NegativeLogLikelihood::default, |candidate| candidate.likelihood);
                let track = found.map(|candidate| candidate.track.clone());
                all.list.push(Hypothesis { likelihood, track, ground: Ground::Symmetry });
            }
        }
        let others: Vec<Candidate> =
            others.filter(|candidate| !look_the_same(candidate.turn, all.taken, pitch)).collect();
        for candidate in others {
            all.turns.push(candidate.turn);
            let (likelihood, track) = (candidate.likelihood, Some(candidate.track));
            all.list.push(Hypothesis { likelihood, track, ground: Ground::Likeness });
        }
        (taken, all)
    }

    /// Turns by the angle of symmetry from the one taken, which look the same.
    fn alike(&self) -> Vec<f64> {
        let (taken, pitch) = (self.taken, self.pitch);
        let mut turns: Vec<f64> = [-1.0, 1.0, -2.0, 2.0].map(|step| taken + step * pitch).into();
        if pitch < TAU {
            let different_turn = different_turn(pitch);
            turns.iter_mut().for_each(|turn| *turn = wrapped(*turn));
            turns.dedup_by(|a, b| (*a - *b).abs() < different_turn);
            turns.retain(|turn| (turn - taken).abs() > different_turn);
        } else {
            // A whole turn more or less looks the same; where it is surely the larger one it is not named.
            turns.retain(|turn| is_doubtful(*turn, taken));
        }
        turns
    }

    /// After an exchange, names the turns that look like the one taken now in place of those that look like the one before.
    fn name_alike(&mut self) {
        for index in (0..self.list.len()).rev() {
            if self.list[index].ground == Ground::Symmetry && self.list[index].track.is_none() {
                self.remove(index);
            }
        }
        // Some that only looked like the one before look the same as the one taken now: the path does not tell them apart.
        for (hypothesis, turn) in self.list.iter_mut().zip(&self.turns) {
            if look_the_same(*turn, self.taken, self.pitch) {
                hypothesis.ground = Ground::Symmetry;
            }
        }
        let different_turn = different_turn(self.pitch);
        for turn in self.alike() {
            if self.turns.iter().all(|other| (other - turn).abs() > different_turn) {
                self.turns.push(turn);
                let likelihood = NegativeLogLikelihood::default();
                self.list.push(Hypothesis { likelihood, track: None, ground: Ground::Symmetry });
            }
        }
    }

    pub(super) fn turns(&self) -> &[f64] {
        &self.turns
    }

    pub(super) fn taken(&self) -> f64 {
        self.taken
    }

    /// Rates of turning, per unit of time, by which the others differ from the one taken.
    pub(super) fn rates_apart(&self) -> impl Iterator<Item = f64> + '_ {
        self.turns.iter().map(|turn| (turn - self.taken) / self.acquired_over)
    }

    /// Turns of those that the smaller turn cannot be taken for granted against.
    pub(super) fn doubtful_turns(&self) -> Vec<f64> {
        (0..self.list.len()).filter(|i| self.is_doubtful(*i)).map(|i| self.turns[i]).collect()
    }

    /// Whether the smaller turn cannot be taken for granted.
    pub(super) fn are_doubtful(&self) -> bool {
        (0..self.list.len()).any(|i| self.is_doubtful(i))
    }

    fn is_doubtful(&self, index: usize) -> bool {
        is_doubtful(self.turns[index], self.taken)
    }

    /// The parameters in which the motion of a doubtful hypothesis differs from an estimate.
    pub(super) fn doubts(&self, estimate: &MotionEstimate) -> [bool; MAX_PARAMETERS] {
        let mut doubts = [false; MAX_PARAMETERS];
        for hypothesis in (0..self.list.len()).filter(|i| self.is_doubtful(*i)).map(|i| &self.list[i]) {
            if hypothesis.ground == Ground::Symmetry {
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
        let is_any_followed = self.list.iter().any(|hypothesis| hypothesis.track.is_some());
        if is_any_followed { Comparison::Asked } else { Comparison::NotAsked }
    }

    /// Measures the loaded frame, which the track has just taken, or not, with every other hypothesis; the track is exchanged for one that
    /// explains the frames significantly better. Gives what was found of the frame in the end.
    pub(super) fn decide(
        &mut self,
        settings: &FilterSettings,
        (track, frame): (&mut Track, &mut Frame),
        outcome: Outcome,
        seconds: f64,
    ) -> Outcome {
        if self.list.is_empty() {
            return outcome;
        }
        let mut outcome = outcome;
        let mut is_another = false;
        self.frames += 1;
        self.likelihood.add(&outcome.likelihood);
        if outcome.is_accepted() {
            self.compare_intervals(seconds);
        }
        for index in (0..self.list.len()).rev() {
            let ground = self.list[index].ground;
            let Some(other) = &mut self.list[index].track else { continue };
            other.predict(seconds);
            other.add_process_noise(&settings.process_noise, seconds);
            other.take_noise_of(track);
            let gate = Gate { largest_innovation: Some(largest_innovation(other)), ..gate(settings, other) };
            let gate = if outcome.is_accepted() { gate.without_noise() } else { gate };
            let found = other.update(frame, &gate, Comparison::Asked);
            other.take_spread(&found.measurement);
            // Searches that began apart may find the same motion in the end.
            let are_compared = ground == Ground::Likeness && outcome.is_accepted() && found.is_accepted();
            let have_met = are_compared && track.has_met(other, different_turn(self.pitch));
            self.list[index].likelihood.add(&found.likelihood);
            let of_other = self.list[index].likelihood;
            if found.is_accepted() && !self.likelihood.is_worse_than(&of_other) && outcome.is_noisy() {
                let gate = Gate { largest_innovation: Some(largest_innovation(track)), ..gate };
                let again = track.update(frame, &gate.without_noise(), Comparison::NotAsked);
                outcome = if again.is_accepted() { again } else { outcome };
            }
            let is_better = ground == Ground::Likeness
                && (self.likelihood.is_worse_than(&of_other) || have_met && of_other.squares < self.likelihood.squares);
            if found.is_accepted() && (!outcome.is_accepted() || is_better) {
                if let Some(other) = &mut self.list[index].track {
                    std::mem::swap(other, track);
                }
                std::mem::swap(&mut self.likelihood, &mut self.list[index].likelihood);
                std::mem::swap(&mut self.taken, &mut self.turns[index]);
                is_another |= ground == Ground::Likeness;
                let is_worse = !outcome.is_accepted() || self.list[index].likelihood.is_worse_than(&self.likelihood);
                match ground {
                    Ground::Likeness if is_worse || have_met => self.remove(index),
                    Ground::Symmetry if is_worse => self.list[index].track = None,
                    _ => {}
                }
                outcome = found;
            } else if outcome.is_accepted()
                && (have_met || !found.is_accepted() || of_other.is_worse_than(&self.likelihood))
            {
                match ground {
                    Ground::Likeness => self.remove(index),
                    // Its path is no evidence.
                    Ground::Symmetry => self.list[index].track = None,
                }
            }
        }
        if is_another {
            self.name_alike();
            self.compare_intervals(seconds);
        }
        if self.frames >= tuning::FOLLOWED {
            for index in 0..self.list.len() {
                if !self.is_doubtful(index) {
                    self.list[index].track = None;
                }
            }
        }
        outcome
    }

    /// Leaves out turns of a symmetric outline that are no multiple of its angle apart over another interval between frames.
    fn compare_intervals(&mut self, seconds: f64) {
        for index in (0..self.list.len()).rev() {
            if self.list[index].ground == Ground::Symmetry {
                let apart = (self.turns[index] - self.taken) * seconds / (self.acquired_over * self.pitch);
                if (apart - apart.round()).abs() > OFF_MULTIPLE {
                    self.remove(index);
                }
            }
        }
    }

    /// Cuts the maps of all hypotheses anew; those that cannot be are none any more.
    pub(super) fn remap(&mut self, mut cut: impl FnMut(&Track) -> Option<Track>) {
        for index in (0..self.list.len()).rev() {
            if let Some(track) = &mut self.list[index].track {
                match cut(track) {
                    Some(new) => *track = new,
                    None => self.remove(index),
                }
            }
        }
    }

    fn remove(&mut self, index: usize) {
        self.list.remove(index);
        self.turns.remove(index);
    }
}

/// Turns this far apart are different, with an angle of symmetry.
fn different_turn(pitch: f64) -> f64 {
    tuning::DIFFERENT_TURN.min(SAME * pitch)
}

/// Whether turns differ by a multiple of the angle of a symmetry, so that they look the same.
fn look_the_same(turn: f64, other: f64, pitch: f64) -> bool {
    let steps = (turn - other) / pitch;
    pitch < TAU && (steps - steps.round()).abs() <= SAME
}

/// Whether a turn cannot be taken for granted against another.
fn is_doubtful(other: f64, taken: f64) -> bool {
    other.abs() < tuning::SURELY_SMALLER * taken.abs()
}

#[cfg(feature = "serde")]
impl Hypotheses {
    /// Whether turns belong to hypotheses, and all numbers can be worked with; `restore` makes their tracks usable, or tells that it cannot.
    pub(super) fn restore(&mut self, restore: impl Fn(&mut Track) -> bool) -> bool {
        let numbers = self.turns.iter().chain([&self.taken]);
        let is_sound = numbers.into_iter().all(|turn| turn.is_finite())
            && self.turns.len() == self.list.len()
            && self.likelihood.is_sound()
            && self.list.iter().all(|hypothesis| hypothesis.likelihood.is_sound())
            && self.frames < StateFormat::MOST_COUNTED
            && (self.list.is_empty() || [self.pitch, self.acquired_over].iter().all(|n| n.is_finite() && *n > 0.0));
        is_sound && self.list.iter_mut().filter_map(|hypothesis| hypothesis.track.as_mut()).all(restore)
    }
}
