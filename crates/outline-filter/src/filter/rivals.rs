//! Poses that explain the frames as well as the one taken, followed until a frame decides.
use freeform_curve_fit::Outline;
use freeform_estimate::MotionEstimate;
use freeform_riccati::MAX_PARAMETERS;

use super::{
    map_update::MapUpdate, misfit::Misfit, motion_change::SUDDEN, motion_filter::fits, outline_map::OutlineMap,
    pose_search::Candidate, settings::FilterSettings,
};

/// Turns that differ by less are the same, rad.
const DIFFERENT_TURN: f64 = 0.15;
/// Of turns that explain the frames alike the smallest is taken for granted if the others are so many times as large: the turn per
/// frame is then less than two thirds of half the angle of symmetry.
const SURELY_SMALLER: f64 = 2.0;
/// Frames after which rivals that are surely larger turns are no longer followed: a symmetric outline will not tell them apart.
const FOLLOWED: usize = 8;
/// Standard deviations by which the motions of rivals must differ to be in doubt.
const DIFFERENT: f64 = 2.0;

/// One other way in which the object may have turned.
#[derive(Debug, Clone)]
struct Rival {
    /// While it is followed.
    map: Option<OutlineMap>,
    misfit: Misfit,
}

/// All others, and what the one taken is compared with them by.
#[derive(Debug, Clone, Default)]
pub(crate) struct Rivals {
    list: Vec<Rival>,
    /// Their turns, in the same order.
    turns: Vec<f64>,
    taken: f64,
    misfit: Misfit,
    frames: usize,
}

impl Rivals {
    /// Takes the smallest turn of all that are not significantly worse than the best.
    pub(crate) fn among(mut candidates: Vec<Candidate>) -> (Option<Candidate>, Self) {
        candidates.sort_by(|a, b| a.misfit.squares.total_cmp(&b.misfit.squares));
        let Some(best) = candidates.first().map(|c| c.misfit) else { return (None, Self::default()) };
        candidates.retain(|candidate| !candidate.misfit.is_worse_than(&best));
        // The best of those with one turn stands for them.
        let mut different: Vec<Candidate> = Vec::new();
        for candidate in candidates {
            if different.iter().all(|other| apart(other.turn, candidate.turn)) {
                different.push(candidate);
            }
        }
        different.sort_by(|a, b| a.turn.abs().total_cmp(&b.turn.abs()));
        let mut others = different.into_iter();
        let mut taken = others.next();
        let mut rivals = Self {
            taken: taken.as_ref().map_or(0.0, |c| c.turn),
            misfit: taken.as_ref().map_or_else(Misfit::default, |c| c.misfit),
            ..Self::default()
        };
        for candidate in others {
            rivals.turns.push(candidate.turn);
            rivals.list.push(Rival { misfit: candidate.misfit, map: Some(candidate.map) });
        }
        if let Some(taken) = &mut taken {
            taken.map.is_compared = !rivals.list.is_empty();
        }
        (taken, rivals)
    }

    pub(crate) fn turns(&self) -> &[f64] {
        &self.turns
    }

    pub(crate) fn taken(&self) -> f64 {
        self.taken
    }

    /// Turns of those that the smaller turn cannot be taken for granted against.
    pub(crate) fn doubtful_turns(&self) -> Vec<f64> {
        (0..self.list.len()).filter(|i| self.is_doubtful(*i)).map(|i| self.turns[i]).collect()
    }

    /// Whether the smaller turn cannot be taken for granted.
    pub(crate) fn are_doubtful(&self) -> bool {
        (0..self.list.len()).any(|i| self.is_doubtful(i))
    }

    fn is_doubtful(&self, index: usize) -> bool {
        self.turns[index].abs() < SURELY_SMALLER * self.taken.abs()
    }

    /// The parameters in which the motion of a doubtful rival differs from an estimate.
    pub(crate) fn doubts(&self, estimate: &MotionEstimate) -> [bool; MAX_PARAMETERS] {
        let mut doubts = [false; MAX_PARAMETERS];
        for rival in (0..self.list.len()).filter(|i| self.is_doubtful(*i)).map(|i| &self.list[i]) {
            let Some(other) = rival.map.as_ref().and_then(OutlineMap::estimate) else { continue };
            for ((doubt, parameter), other) in doubts.iter_mut().zip(estimate.parameters()).zip(other.values()) {
                let known = parameter.value.zip(parameter.standard_deviation);
                *doubt |= known.is_some_and(|(value, deviation)| (value - other).abs() > DIFFERENT * deviation);
            }
        }
        doubts
    }

    /// Measures the frame that the map has just taken, or not, with every rival; the map is exchanged for one that explains the frames
    /// significantly better. Gives what was found of the frame in the end.
    pub(crate) fn decide(
        &mut self,
        settings: &FilterSettings,
        map: &mut OutlineMap,
        update: MapUpdate,
        seconds: f64,
        outline: &Outline,
    ) -> MapUpdate {
        map.is_compared = false;
        if self.list.is_empty() {
            return update;
        }
        let mut update = update;
        self.frames += 1;
        self.misfit.add(&map.last_misfit);
        let limit = SUDDEN * map.information.k as f64;
        for index in (0..self.list.len()).rev() {
            let Some(rival) = &mut self.list[index].map else { continue };
            rival.predict(seconds);
            rival.add_process_noise(&settings.process_noise, seconds);
            // The noise is the same whatever the turn.
            rival.sigma = map.sigma;
            rival.is_compared = true;
            let fits = fits(rival, settings.smallest_agreement);
            let found = rival.update(outline, |update| fits(update) && update.innovation <= limit);
            rival.noise_level.take(found.spread / rival.radius);
            let misfit = rival.last_misfit;
            self.list[index].misfit.add(&misfit);
            let of_rival = self.list[index].misfit;
            if found.accepted && (!update.accepted || self.misfit.is_worse_than(&of_rival)) {
                if let Some(rival) = &mut self.list[index].map {
                    std::mem::swap(rival, map);
                }
                std::mem::swap(&mut self.misfit, &mut self.list[index].misfit);
                std::mem::swap(&mut self.taken, &mut self.turns[index]);
                if !update.accepted || self.list[index].misfit.is_worse_than(&self.misfit) {
                    self.remove(index);
                }
                update = found;
            } else if update.accepted && (!found.accepted || of_rival.is_worse_than(&self.misfit)) {
                self.remove(index);
            }
        }
        if self.frames >= FOLLOWED {
            for index in 0..self.list.len() {
                if !self.is_doubtful(index) {
                    self.list[index].map = None;
                }
            }
        }
        map.is_compared = self.list.iter().any(|rival| rival.map.is_some());
        update
    }

    /// Cuts the maps of all rivals anew; those that cannot be are no rivals any more.
    pub(crate) fn recut(&mut self, cut: impl Fn(&OutlineMap) -> Option<OutlineMap>) {
        for index in (0..self.list.len()).rev() {
            if let Some(map) = &mut self.list[index].map {
                match cut(map) {
                    Some(new) => *map = new,
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
    turn.abs() > DIFFERENT_TURN
}
