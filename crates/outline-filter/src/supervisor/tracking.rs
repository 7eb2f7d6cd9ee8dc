//! A track moved on to a frame, and the changes of its motion found.
use super::{motion_change::MotionHistory, settings::FilterSettings};
use crate::{
    dynamics::{DynamicsFilter, Purpose},
    measurement::Frame,
    search::displacement_nearby,
    track::{Comparison, Outcome, Track},
    tuning::update::{PARTLY_THERE, SUDDEN},
    update::{Gate, Rejection},
};

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

/// What a frame is judged by.
struct Gates {
    /// Where the motion has gone on as it was.
    as_before: Gate,
    /// Where it may have changed at once.
    after_sudden_change: Option<Gate>,
}

impl Gates {
    /// Of a frame that is new. Only where the one before it was rejected the motion may have changed at once.
    fn of_new_frame(settings: &FilterSettings, track: &Track, widening: f64, is_after_rejected: bool) -> Self {
        let anywhere = gate(settings, track);
        Self {
            as_before: Gate { largest_innovation: Some(widening * largest_innovation(track)), ..anywhere },
            after_sudden_change: (settings.finds_changes() && is_after_rejected).then_some(anywhere),
        }
    }

    /// Of a frame that was accepted once. The noise of its few points on cells seen before tells less.
    fn of_accepted_frame(settings: &FilterSettings, track: &Track, widening: f64) -> Self {
        let anywhere = gate(settings, track).without_noise();
        if !settings.finds_changes() {
            return Self { as_before: anywhere, after_sudden_change: None };
        }
        Self {
            as_before: Gate { largest_innovation: Some(widening * largest_innovation(track)), ..anywhere },
            after_sudden_change: Some(anywhere),
        }
    }
}

/// Predicts a track over so many seconds, measures the loaded frame, which is new, and finds how the motion changes. `None` where the
/// object is lost, since it [cannot be predicted](Track::predict).
pub(super) fn advance(
    settings: &FilterSettings,
    (track, frame): (&mut Track, &mut Frame),
    history: &mut MotionHistory,
    seconds: f64,
    is_after_rejected: bool,
    comparison: Comparison,
) -> Option<Outcome> {
    if !predict(settings, track, history, seconds) {
        return None;
    }
    let gates = Gates::of_new_frame(settings, track, history.widening(), is_after_rejected);
    let outcome = outcome_with_changes(settings, (track, frame), history, &gates, comparison);
    history.record(&outcome, seconds);
    if matches!(outcome.verdict, Err(Rejection::AgreementTooSmall { .. }))
        && let Some(elsewhere) = displacement_nearby(track, frame)
    {
        history.record_apart(&elsewhere);
    }
    Some(outcome)
}

/// As [`advance`], with a frame that was accepted once, and is measured against a map that was cut anew.
pub(super) fn advance_again(
    settings: &FilterSettings,
    (track, frame): (&mut Track, &mut Frame),
    history: &mut MotionHistory,
    seconds: f64,
) -> Option<Outcome> {
    if !predict(settings, track, history, seconds) {
        return None;
    }
    let gates = Gates::of_accepted_frame(settings, track, history.widening());
    let outcome = outcome_with_changes(settings, (track, frame), history, &gates, Comparison::NotAsked);
    history.record(&outcome, seconds);
    Some(outcome)
}

/// What becomes of a frame, after the changes of the motion that it shows.
fn outcome_with_changes(
    settings: &FilterSettings,
    (track, frame): (&mut Track, &mut Frame),
    history: &mut MotionHistory,
    gates: &Gates,
    comparison: Comparison,
) -> Outcome {
    let mut outcome = track.update(frame, &gates.as_before, comparison);
    if !settings.finds_changes() {
        return outcome;
    }
    let MotionHistory { change, dynamics, .. } = history;
    if !outcome.is_accepted()
        && let Some(dynamics) = dynamics
        && let Some(found) = outcome_by_others((track, frame), dynamics, (&outcome, &gates.as_before), comparison)
    {
        outcome = found;
    }
    let innovation = outcome.innovation;
    // If the outline is there, but for the second time (or beyond doubt) not where it was going, the motion has changed. Held to where it was
    // going, it agrees in part: in the end it must agree like any other.
    let is_partly_there = outcome.measurement.agreement >= PARTLY_THERE * settings.smallest_agreement;
    if !outcome.is_accepted()
        && let Some(gate) = gates.after_sudden_change
        && is_partly_there
        && let Some((changed, found)) = after_sudden_change(track, frame, &outcome, &gate, comparison)
    {
        *track = changed;
        change.was_sudden = true;
        outcome = found;
    }
    if outcome.is_accepted() {
        change.update(&innovation, track.model().parameter_count());
    }
    outcome
}

/// A track whose motion has changed by as much as the innovation of a frame says, which was not taken, with what becomes of the frame then; `None`
/// where it is not accepted either.
pub(super) fn after_sudden_change(
    track: &Track,
    frame: &mut Frame,
    outcome: &Outcome,
    gate: &Gate,
    comparison: Comparison,
) -> Option<(Track, Outcome)> {
    let innovation = outcome.innovation;
    if innovation.fisher[0] <= 0.0 {
        return None;
    }
    let mut changed = track.clone();
    changed.add_change([0, 1].map(|kind| (innovation.gradient[kind] / innovation.fisher[kind]).max(0.0)));
    let found = changed.update(frame, gate, comparison);
    found.is_accepted().then_some((changed, found))
}

/// What becomes of a frame not where a constant generator takes the object, but where other dynamics do that are not ruled out; `None`, with
/// nothing changed, where it is not accepted there either.
fn outcome_by_others(
    (track, frame): (&mut Track, &mut Frame),
    dynamics: &mut DynamicsFilter,
    (outcome, gate): (&Outcome, &Gate),
    comparison: Comparison,
) -> Option<Outcome> {
    if !dynamics.has_others() {
        return None;
    }
    // Where the outline lies apart from what the generator says, so does what all of them say together.
    let is_there = outcome.measurement.agreement >= gate.smallest_agreement;
    let together = is_there.then_some(Purpose::Prediction);
    together.into_iter().chain([Purpose::PredictionByOthers]).find_map(|purpose| {
        let (mut followed, mut their) = (track.clone(), dynamics.clone());
        if !lead(&mut followed, &mut their, purpose) {
            return None;
        }
        let found = followed.update(frame, gate, comparison);
        if found.is_accepted() {
            (*track, *dynamics) = (followed, their);
        }
        found.is_accepted().then_some(found)
    })
}

/// Moves a track on to where its motion has led it. Process noise that is given is added; else the hypotheses of dynamics say where it is expected,
/// once they lead, and until then the variances that innovations have told. False where the object [cannot be predicted](Track::predict).
pub(super) fn predict(settings: &FilterSettings, track: &mut Track, history: &mut MotionHistory, seconds: f64) -> bool {
    if history.dynamics.is_none()
        && let Some(setting) = settings.followed_dynamics()
    {
        history.dynamics = track.begun_dynamics(setting);
    }
    if !track.predict(seconds) {
        return false;
    }
    track.add_process_noise(&settings.process_noise, seconds);
    let (expected, null) = (track.centred_pose(), track.null_directions());
    let moved = history.dynamics.as_mut().is_some_and(|dynamics| dynamics.predict(&expected, seconds, &null));
    if !moved {
        history.dynamics = None;
    }
    let is_led = history
        .dynamics
        .as_mut()
        .is_some_and(|dynamics| dynamics.leads() && lead(track, dynamics, Purpose::Prediction));
    if !is_led && let Some(variances) = history.change.variances() {
        track.add_change(variances);
    }
    true
}

/// Puts a track where hypotheses of dynamics together expect it; whether they do.
fn lead(track: &mut Track, dynamics: &mut DynamicsFilter, purpose: Purpose) -> bool {
    let Some(mut expected) = dynamics.combined(None, purpose) else { return false };
    expected.pose = dynamics.of_outline_now(&expected.pose);
    let is_taken = track.map().is_shown_in(&expected.pose) && dynamics.set_reference(&expected.pose);
    if is_taken {
        track.expect(&expected);
    }
    is_taken
}
