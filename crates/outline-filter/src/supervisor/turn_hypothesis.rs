//! One other way in which the object may have turned.
use super::{
    gates::{gate, gate_of_all, largest_innovation},
    settings::FilterSettings,
    tracking::{after_sudden_change, may_be_apart, outcome_nearby},
};
use crate::{
    measurement::{Frame, NegativeLogLikelihood},
    search::displacement_nearby,
    track::{Comparison, Outcome, Track},
    update::{Gate, Rejection},
};

/// One other way in which the object may have turned.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct TurnHypothesis {
    /// While it is followed.
    pub(super) track: Option<Track>,
    pub(super) likelihood: NegativeLogLikelihood,
    /// Without the last frame.
    #[cfg_attr(feature = "serde", serde(skip))]
    likelihood_before: NegativeLogLikelihood,
    pub(super) reason: Reason,
    /// Whether it looks the same as the one taken, and yet points are significantly better for it.
    pub(super) is_shown: bool,
}

/// Why a turn may have been another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) enum Reason {
    /// It explains the frames so far as well, and is followed until a frame decides.
    Likeness,
    /// The outline has a symmetry: no frame will decide, and the path of the object must not.
    Symmetry,
}

impl TurnHypothesis {
    /// One that is followed if it has a track.
    pub(super) fn new(track: Option<Track>, likelihood: NegativeLogLikelihood, reason: Reason) -> Self {
        Self { track, likelihood, likelihood_before: likelihood, reason, is_shown: false }
    }

    /// Measures the loaded frame, of which `outcome` was found with the present track, where it is still followed and can be predicted. Where it was
    /// expected badly it is searched for, turned by no more than would still be this turn.
    pub(super) fn follow(
        &mut self,
        settings: &FilterSettings,
        (present, frame): (&Track, &mut Frame),
        outcome: &Outcome,
        (seconds, farthest_turn): (f64, f64),
    ) -> Option<Outcome> {
        let track = self.track.as_mut()?;
        if !track.predict(seconds) {
            return None;
        }
        track.add_process_noise(&settings.process_noise, seconds);
        track.adopt_noise_of(present);
        let of_motion = gate_of_motion(settings, track);
        let of_motion = if outcome.is_accepted() { of_motion.without_noise() } else { of_motion };
        let mut found = track.update(frame, &of_motion, Comparison::Asked);
        // It has no hypotheses of dynamics of its own, so that what is not constant in its motion is no evidence against its turn. Where the present
        // track has not been found either, both wait for another frame.
        if settings.finds_changes()
            && outcome.is_accepted()
            && matches!(found.verdict, Err(Rejection::InnovationTooLarge { .. }))
            && let Some((changed, outcome)) =
                after_sudden_change(track, frame, &found, &gate(settings, track).without_noise(), Comparison::Asked)
        {
            (*track, found) = (changed, outcome);
        }
        // A fast spin and a straight path make no constant generator, and the rival has no hypotheses of dynamics.
        if settings.finds_changes()
            && outcome.is_accepted()
            && may_be_apart(&found)
            && let Some(apart) = displacement_nearby(track, frame)
        {
            let gate = gate_of_all(settings, track).without_noise();
            let apart = (farthest_turn, (apart, seconds));
            found = outcome_nearby((track, frame), None, apart, (&gate, Comparison::Asked)).unwrap_or(found);
        }
        track.record_spread(&found.measurement);
        self.likelihood_before = self.likelihood;
        self.likelihood.add(&found.likelihood);
        Some(found)
    }

    /// Forgets what the last frame has said.
    pub(super) fn forget_last_frame(&mut self) {
        self.likelihood = self.likelihood_before;
    }

    /// What was found of the loaded frame, which the present track has shown to be one of the object.
    pub(super) fn again_if_vouched_for(
        &mut self,
        settings: &FilterSettings,
        frame: &mut Frame,
        found: Outcome,
    ) -> Outcome {
        self.track.as_mut().map_or(found, |track| again_if_vouched_for(track, settings, frame, found))
    }

    pub(super) fn has_met(&self, present: &Track, different_turn: f64) -> bool {
        self.track.as_ref().is_some_and(|track| present.has_met(track, different_turn))
    }
}

/// What a track has found of the loaded frame, which another has shown to be one of the object: once more where it was rejected for its noise, or
/// for what lies beyond the known ends of the outline.
pub(super) fn again_if_vouched_for(
    track: &mut Track,
    settings: &FilterSettings,
    frame: &mut Frame,
    found: Outcome,
) -> Outcome {
    let gate = found.gate_if_vouched_for(gate_of_motion(settings, track), frame.points.len());
    let again = gate.map(|gate| track.update(frame, &gate, Comparison::NotAsked));
    again.filter(Outcome::is_accepted).unwrap_or(found)
}

/// The gate for a frame of a track whose motion goes on as it was.
pub(super) fn gate_of_motion(settings: &FilterSettings, track: &Track) -> Gate {
    Gate { largest_innovation: Some(largest_innovation(track)), ..gate(settings, track) }
}
