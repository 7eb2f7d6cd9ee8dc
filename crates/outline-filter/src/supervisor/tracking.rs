//! A track moved on to a frame, and the changes of its motion found.
use super::{motion_change::MotionHistory, settings::FilterSettings};
use crate::{
    dynamics::{DynamicsFilter, Purpose},
    measurement::Frame,
    track::{Comparison, Outcome, Track},
    tuning::update::{PARTLY_THERE, SUDDEN},
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
    history: &mut MotionHistory,
    seconds: f64,
    known: Known,
    comparison: Comparison,
) -> Outcome {
    predict(settings, track, history, seconds);
    let outcome = measured(settings, (track, frame), history, known, comparison);
    history.take(&outcome, seconds);
    outcome
}

/// Measures a frame, and finds changes of the motion that are sudden.
fn measured(
    settings: &FilterSettings,
    (track, frame): (&mut Track, &mut Frame),
    history: &mut MotionHistory,
    known: Known,
    comparison: Comparison,
) -> Outcome {
    let MotionHistory { change, dynamics, .. } = history;
    // Errors that are larger than the model's, such as those of a camera that shakes, are no change of the motion.
    let widening = dynamics.as_ref().map_or(1.0, DynamicsFilter::widening);
    let parameters = track.model().parameter_count();
    let anywhere = match known {
        Known::ShowsObject => gate(settings, track).without_noise(),
        _ => gate(settings, track),
    };
    if !settings.finds_changes() && known == Known::ShowsObject {
        return track.update(frame, &anywhere, comparison);
    }
    let as_before = Gate { largest_innovation: Some(widening * largest_innovation(track)), ..anywhere };
    let mut outcome = track.update(frame, &as_before, comparison);
    if !settings.finds_changes() {
        return outcome;
    }
    let is_there = outcome.measurement.agreement >= settings.smallest_agreement;
    // Not where a constant generator takes the object, but where other dynamics do that are not ruled out.
    let others = dynamics.as_mut().filter(|dynamics| is_there && !outcome.is_accepted() && dynamics.has_others());
    if let Some(dynamics) = others {
        let (mut followed, mut their) = (track.clone(), dynamics.clone());
        if lead(&mut followed, &mut their) {
            let found = followed.update(frame, &as_before, comparison);
            if found.is_accepted() {
                (*track, *dynamics) = (followed, their);
                outcome = found;
            }
        }
    }
    let innovation = outcome.innovation;
    let is_partly_there = outcome.measurement.agreement >= PARTLY_THERE * settings.smallest_agreement;
    if !outcome.is_accepted() && known != Known::Nothing && is_partly_there && innovation.fisher[0] > 0.0 {
        // If the outline is there, but for the second time (or beyond doubt) not where it was going, the motion has changed. Held to where it was
        // going, it agrees in part: in the end it must agree like any other.
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

/// Moves a track on to where its motion has led it, by what is known of its dynamics.
pub(super) fn predict(settings: &FilterSettings, track: &mut Track, history: &mut MotionHistory, seconds: f64) {
    if history.dynamics.is_none()
        && let Some(setting) = settings.followed_dynamics()
    {
        history.dynamics = track.begun_dynamics(setting);
    }
    track.predict(seconds);
    track.add_process_noise(&settings.process_noise, seconds);
    let (expected, null) = (track.centred_pose(), track.null_directions());
    let moved = history.dynamics.as_mut().is_some_and(|dynamics| dynamics.predict(&expected, seconds, &null));
    if !moved {
        history.dynamics = None;
    }
    let is_led = history.dynamics.as_mut().is_some_and(|dynamics| dynamics.leads() && lead(track, dynamics));
    if !is_led && let Some(variances) = history.change.variances() {
        track.add_change(variances);
    }
}

/// Puts a track where all hypotheses of dynamics together expect it; whether they do.
fn lead(track: &mut Track, dynamics: &mut DynamicsFilter) -> bool {
    let Some(mut expected) = dynamics.combined(None, Purpose::Prediction) else { return false };
    expected.pose = dynamics.of_outline_now(&expected.pose);
    let is_taken = dynamics.take_reference(&expected.pose);
    if is_taken {
        track.expect(&expected);
    }
    is_taken
}
