//! A track moved on to a frame, and the changes of its motion found.
use super::{motion_change::MotionChange, settings::FilterSettings};
use crate::{
    measurement::Frame,
    track::{Comparison, Outcome, Track},
    tuning::update::SUDDEN,
    update::Gate,
};

/// What is known of a frame before it is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Known {
    Nothing,
    /// The one before it has been rejected: the motion may have changed.
    OthersRejected,
    /// It has been taken once: the noise of its few points on cells seen before tells less.
    ShowsObject,
}

/// Largest squared innovation of a motion that goes on as it was.
pub(super) fn largest_innovation(track: &Track) -> f64 {
    SUDDEN * track.model().parameter_count() as f64
}

/// The gate for a frame of a track wherever its motion has led, noise included.
pub(super) fn gate(settings: &FilterSettings, track: &Track) -> Gate {
    Gate {
        smallest_agreement: settings.smallest_agreement,
        largest_innovation: None,
        largest_noise: Some(track.largest_noise()),
    }
}

/// Predicts a track over so many seconds, measures the loaded frame, and finds how the motion changes.
pub(super) fn advance(
    settings: &FilterSettings,
    (track, frame): (&mut Track, &mut Frame),
    change: &mut MotionChange,
    seconds: f64,
    known: Known,
    comparison: Comparison,
) -> Outcome {
    track.predict(seconds);
    track.add_process_noise(&settings.process_noise, seconds);
    if let Some(variances) = change.variances() {
        track.add_change(variances);
    }
    let parameters = track.model().parameter_count();
    let anywhere = match known {
        Known::ShowsObject => Gate { largest_noise: None, ..gate(settings, track) },
        _ => gate(settings, track),
    };
    if !settings.finds_changes() && known == Known::ShowsObject {
        return track.update(frame, &anywhere, comparison);
    }
    let as_before = Gate { largest_innovation: Some(largest_innovation(track)), ..anywhere };
    let mut outcome = track.update(frame, &as_before, comparison);
    if !settings.finds_changes() {
        return outcome;
    }
    let innovation = outcome.innovation;
    let is_there = outcome.measurement.agreement >= settings.smallest_agreement;
    if !outcome.is_accepted() && known != Known::Nothing && is_there && innovation.fisher[0] > 0.0 {
        // If the outline is there, but for the second time (or beyond doubt) not where it was going, the motion has changed.
        let mut changed = track.clone();
        changed.add_change([0, 1].map(|kind| (innovation.gradient[kind] / innovation.fisher[kind]).max(0.0)));
        let found = changed.update(frame, &anywhere, comparison);
        if found.is_accepted() {
            *track = changed;
            change.was_sudden = true;
            outcome = found;
        }
    }
    if outcome.is_accepted() {
        change.take(&innovation, parameters);
    }
    outcome
}
