//! Hypotheses: turns that explain the frames as well as the one taken, followed until a frame decides.
use freeform_estimate::MotionEstimate;
use freeform_riccati::MAX_PARAMETERS;

use super::{
    settings::FilterSettings,
    tracking::{gate, largest_innovation},
};
use crate::{
    measurement::{Frame, NegativeLogLikelihood},
    track::{Comparison, Outcome, Track},
    tuning::hypotheses as tuning,
    update::Gate,
};

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
}

impl Hypotheses {
    /// Takes the smallest turn of all that are not significantly worse than the best.
    pub(super) fn among(mut candidates: Vec<Candidate>) -> (Option<Candidate>, Self) {
        candidates.sort_by(|a, b| a.likelihood.squares.total_cmp(&b.likelihood.squares));
        let Some(best) = candidates.first().map(|c| c.likelihood) else { return (None, Self::default()) };
        candidates.retain(|candidate| !candidate.likelihood.is_worse_than(&best));
        // The best of those with one turn stands for them.
        let mut different: Vec<Candidate> = Vec::new();
        for candidate in candidates {
            if different.iter().all(|other| apart(other.turn, candidate.turn)) {
                different.push(candidate);
            }
        }
        different.sort_by(|a, b| a.turn.abs().total_cmp(&b.turn.abs()));
        let mut others = different.into_iter();
        let taken = others.next();
        let mut all = Self {
            taken: taken.as_ref().map_or(0.0, |c| c.turn),
            likelihood: taken.as_ref().map_or_else(NegativeLogLikelihood::default, |c| c.likelihood),
            ..Self::default()
        };
        for candidate in others {
            all.turns.push(candidate.turn);
            all.list.push(Hypothesis { likelihood: candidate.likelihood, track: Some(candidate.track) });
        }
        (taken, all)
    }

    pub(super) fn turns(&self) -> &[f64] {
        &self.turns
    }

    pub(super) fn taken(&self) -> f64 {
        self.taken
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
        self.turns[index].abs() < tuning::SURELY_SMALLER * self.taken.abs()
    }

    /// The parameters in which the motion of a doubtful hypothesis differs from an estimate.
    pub(super) fn doubts(&self, estimate: &MotionEstimate) -> [bool; MAX_PARAMETERS] {
        let mut doubts = [false; MAX_PARAMETERS];
        for hypothesis in (0..self.list.len()).filter(|i| self.is_doubtful(*i)).map(|i| &self.list[i]) {
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
        self.frames += 1;
        self.likelihood.add(&outcome.likelihood);
        for index in (0..self.list.len()).rev() {
            let Some(other) = &mut self.list[index].track else { continue };
            other.predict(seconds);
            other.add_process_noise(&settings.process_noise, seconds);
            other.take_noise_of(track);
            let gate = Gate { largest_innovation: Some(largest_innovation(other)), ..gate(settings, other) };
            let found = other.update(frame, &gate, Comparison::Asked);
            other.take_spread(found.measurement.spread);
            self.list[index].likelihood.add(&found.likelihood);
            let of_other = self.list[index].likelihood;
            if found.is_accepted() && (!outcome.is_accepted() || self.likelihood.is_worse_than(&of_other)) {
                if let Some(other) = &mut self.list[index].track {
                    std::mem::swap(other, track);
                }
                std::mem::swap(&mut self.likelihood, &mut self.list[index].likelihood);
                std::mem::swap(&mut self.taken, &mut self.turns[index]);
                if !outcome.is_accepted() || self.list[index].likelihood.is_worse_than(&self.likelihood) {
                    self.remove(index);
                }
                outcome = found;
            } else if outcome.is_accepted() && (!found.is_accepted() || of_other.is_worse_than(&self.likelihood)) {
                self.remove(index);
            }
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

fn apart(a: f64, b: f64) -> bool {
    let turn = (a - b + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
    turn.abs() > tuning::DIFFERENT_TURN
}

#[cfg(feature = "serde")]
impl Hypotheses {
    /// Whether turns belong to hypotheses, and all numbers can be worked with; `restore` makes their tracks usable, or tells that it cannot.
    pub(super) fn restore(&mut self, restore: impl Fn(&mut Track) -> bool) -> bool {
        let numbers = self.turns.iter().chain([&self.taken]);
        let is_sound = numbers.into_iter().all(|turn| turn.is_finite())
            && self.turns.len() == self.list.len()
            && self.likelihood.is_sound()
            && self.list.iter().all(|hypothesis| hypothesis.likelihood.is_sound());
        is_sound && self.list.iter_mut().filter_map(|hypothesis| hypothesis.track.as_mut()).all(restore)
    }
}
