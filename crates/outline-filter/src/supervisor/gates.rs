//! What frames of a track are judged by.
use std::f64::consts::TAU;

use super::settings::FilterSettings;
use crate::{
    track::Track,
    tuning::{noise::LARGEST_RATIO, symmetry::NEARBY, update::SUDDEN},
    update::Gate,
};

/// Largest squared innovation of a motion that goes on as it was.
pub(super) fn largest_innovation(track: &Track) -> f64 {
    SUDDEN * track.model().parameter_count() as f64
}

/// The gate for a frame of a track wherever its motion has led, noise included. Edges that may lie off do so elsewhere in every frame.
pub(super) fn gate(settings: &FilterSettings, track: &Track) -> Gate {
    let largest_noise = track.largest_noise().hypot(LARGEST_RATIO * settings.edge_uncertainty);
    Gate {
        smallest_agreement: settings.smallest_agreement,
        largest_innovation: None,
        largest_noise: Some(largest_noise),
    }
}

/// The same for a frame that is to show all of the object that frames usually show.
pub(super) fn gate_of_all(settings: &FilterSettings, track: &Track) -> Gate {
    track.gate_of_all(gate(settings, track))
}

/// Whether anything says that a motion goes on as it was.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Steadiness {
    /// Several frames have.
    Told,
    /// It is known from one step alone, so that nothing does: an object that shows all of its outline elsewhere is there, unless that is another turn.
    Untold,
    /// The frame before was not taken: a second one is not wrong by chance.
    Contradicted,
}

/// Whether an outline explains a frame in one turn alone. A search from where the object was expected may lead to others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Turns {
    One,
    /// It looks the same after so many parts of a whole turn.
    Symmetric {
        order: usize,
    },
    /// It looks nearly the same after some, or the same, and nothing says which it was.
    Several,
}

impl Turns {
    /// As far as a search may turn an object that is then still the one that was expected, rad; none where no search tells it.
    pub(super) fn farthest_expected(self) -> Option<f64> {
        match self {
            Self::One => Some(f64::INFINITY),
            Self::Symmetric { order } => Some(NEARBY * TAU / order as f64),
            Self::Several => None,
        }
    }
}

/// What a frame is judged by.
pub(super) struct Gates {
    /// Where the motion has gone on as it was.
    pub(super) as_before: Gate,
    /// Where it may have changed at once, by as much as linearisations show.
    pub(super) after_sudden_change: Option<Gate>,
    /// Where it may have changed at once, by as much as a search shows that begins where the object was expected.
    pub(super) nearby: Option<Gate>,
}

impl Gates {
    /// Of a frame that is new, of a motion that is so `steady`.
    pub(super) fn of_new_frame(
        settings: &FilterSettings,
        track: &Track,
        widening: f64,
        (steady, turns): (Steadiness, Turns),
    ) -> Self {
        let anywhere = gate(settings, track);
        let as_before = Gate { largest_innovation: Some(widening * largest_innovation(track)), ..anywhere };
        let nearby = Some(track.gate_of_all(anywhere));
        let (after_sudden_change, nearby) = match steady {
            Steadiness::Told => (None, None),
            Steadiness::Untold => (nearby.filter(|_| turns == Turns::One), nearby),
            Steadiness::Contradicted => (Some(anywhere), nearby),
        };
        let or_none = |gate: Option<Gate>| gate.filter(|_| settings.finds_changes());
        Self { as_before, after_sudden_change: or_none(after_sudden_change), nearby: or_none(nearby) }
    }

    /// Of a frame that was accepted once. The noise of its few points on cells seen before tells less.
    pub(super) fn of_accepted_frame(settings: &FilterSettings, track: &Track, widening: f64) -> Self {
        let anywhere = gate(settings, track).without_noise();
        if !settings.finds_changes() {
            return Self { as_before: anywhere, after_sudden_change: None, nearby: None };
        }
        Self {
            as_before: Gate { largest_innovation: Some(widening * largest_innovation(track)), ..anywhere },
            after_sudden_change: Some(anywhere),
            nearby: Some(track.gate_of_all(anywhere)),
        }
    }
}
