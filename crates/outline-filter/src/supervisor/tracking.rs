//! A track moved on to a frame, and the changes of its motion found.
use super::{
    gates::{Gates, Steadiness, Turns, gate_of_all},
    motion_change::{Apart, MotionHistory, PoseVector, Shown},
    settings::FilterSettings,
};
use crate::{
    dynamics::{DynamicsFilter, Purpose},
    measurement::Frame,
    prediction::{PoseMatrix, TimeOfChange},
    search::displacement_nearby,
    track::{Comparison, Outcome, Track},
    tuning::update::PARTLY_THERE,
    update::{Gate, Rejection},
};

/// Predicts a track over so many seconds, measures the loaded frame, which is new, and finds how the motion changes. `None` where the
/// object is lost, since it [cannot be predicted](Track::predict).
pub(super) fn advance(
    settings: &FilterSettings,
    (track, frame): (&mut Track, &mut Frame),
    history: &mut MotionHistory,
    (seconds, is_after_rejected): (f64, bool),
    (turns, comparison): (Turns, Comparison),
) -> Option<Outcome> {
    let steady = match track.is_known_from_one_step() {
        _ if is_after_rejected => Steadiness::Contradicted,
        true => Steadiness::Untold,
        false => Steadiness::Told,
    };
    if !predict(settings, track, history, seconds) {
        return None;
    }
    let gates = Gates::of_new_frame(settings, track, history.widening(track), (steady, turns));
    let (outcome, apart) =
        outcome_with_changes(settings, (track, frame), history, (seconds, &gates), (turns, comparison));
    let since_taken = history.since_taken + seconds;
    let (outcome, apart) = match apart {
        Some(apart) => found_elsewhere(outcome, settings, (track, frame), (apart, since_taken)),
        None => (outcome, None),
    };
    let apart = apart.or_else(|| apart_by(settings, (track, frame), &outcome, since_taken));
    history.record(&outcome, seconds, apart);
    if outcome.is_accepted()
        && let Some(dynamics) = history.dynamics.as_mut().filter(|dynamics| dynamics.leads())
    {
        track.renew_common_error(dynamics);
    }
    Some(outcome)
}

/// As [`advance`], with a frame that was accepted once, and is measured against a map that was cut anew.
pub(super) fn advance_again(
    settings: &FilterSettings,
    (track, frame): (&mut Track, &mut Frame),
    history: &mut MotionHistory,
    seconds: f64,
    turns: Turns,
) -> Option<Outcome> {
    if !predict(settings, track, history, seconds) {
        return None;
    }
    let gates = Gates::of_accepted_frame(settings, track, history.widening(track));
    let known = (turns, Comparison::NotAsked);
    let (outcome, _) = outcome_with_changes(settings, (track, frame), history, (seconds, &gates), known);
    let apart = apart_by(settings, (track, frame), &outcome, history.since_taken + seconds);
    history.record(&outcome, seconds, apart);
    Some(outcome)
}

/// What becomes of a frame, after the changes of the motion that it shows; where it is not taken, and the outline is not where it was expected, how far
/// from there a search has found it.
fn outcome_with_changes(
    settings: &FilterSettings,
    (track, frame): (&mut Track, &mut Frame),
    history: &mut MotionHistory,
    (seconds, gates): (f64, &Gates),
    (turns, comparison): (Turns, Comparison),
) -> (Outcome, Option<PoseVector>) {
    let mut outcome = track.update(frame, &gates.as_before, comparison);
    let MotionHistory { change, dynamics, since_taken, .. } = history;
    let since_taken = *since_taken + seconds;
    if !settings.finds_changes() {
        let apart = may_be_apart(&outcome).then(|| displacement_nearby(track, frame)).flatten();
        return (outcome, apart);
    }
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
    let nearby = gates.nearby.zip(turns.farthest_expected()).filter(|_| !outcome.is_accepted());
    let apart = (nearby.is_some() || may_be_apart(&outcome)).then(|| displacement_nearby(track, frame)).flatten();
    if let Some(((gate, farthest_turn), apart)) = nearby.zip(apart) {
        let dynamics = dynamics.as_mut();
        let found = (farthest_turn, (apart, since_taken));
        if let Some(found) = outcome_nearby((track, frame), dynamics, found, (&gate, comparison)) {
            change.was_sudden = true;
            outcome = found;
        }
    }
    if outcome.is_accepted() {
        change.update(&innovation, track.model().parameter_count());
    }
    let apart = apart.filter(|_| may_be_apart(&outcome));
    (outcome, apart)
}

/// The outcome of a frame that was not taken, and how far from where it was expected the outline lies, if it is not there. Where all of the object is
/// shown in a pose that a search has found, that is what speaks against the frame, and not that it would show something else.
fn found_elsewhere(
    outcome: Outcome,
    settings: &FilterSettings,
    (track, frame): (&Track, &mut Frame),
    (error, since_taken): (PoseVector, f64),
) -> (Outcome, Option<Apart>) {
    let is_noisy = matches!(outcome.verdict, Err(Rejection::NoiseTooLarge { .. }));
    let whole = gate_of_all(settings, track);
    // Points of an object that has been at rest scatter more once it moves. Where that is all that speaks against a frame, they must scatter less there.
    let whole = if is_noisy { whole } else { whole.without_noise() };
    let is_apart = whole.verdict(&outcome.measurement).is_err();
    let found = is_apart.then(|| whole_at((track, frame), (&error, since_taken), &whole)).flatten();
    let Some((apart, distance)) = found else {
        let in_part = Apart { error, covariance: PoseMatrix::zeros(), shown: Shown::InPart };
        return (outcome, (!is_noisy).then_some(in_part));
    };
    let outcome = Outcome { verdict: Err(Rejection::Elsewhere { distance }), ..outcome };
    (outcome, Some(apart))
}

/// How far from where it was expected a frame shows all of the outline, if it does where it is off by an error, as the frame by itself tells it, whatever
/// was expected; and the distance, root mean square over the outline, image lengths.
fn whole_at(
    (track, frame): (&Track, &mut Frame),
    (error, since_taken): (&PoseVector, f64),
    whole: &Gate,
) -> Option<(Apart, f64)> {
    let mut displaced = track.clone();
    if !displaced.displace(error, since_taken) {
        return None;
    }
    let begun = *displaced.body_pose();
    let found = displaced.update(frame, whole, Comparison::NotAsked);
    if !found.is_accepted() {
        return None;
    }
    let measured = found.pose.as_ref().and_then(|pose| Apart::measured(pose, Shown::Whole, &track.null_directions()));
    let from_expected = measured.and_then(|apart| {
        let error = track.error_to(&track.pose_off_by(&apart.error, &begun))?;
        Some(Apart { error, ..apart })
    });
    let as_displaced = Apart { error: *error, covariance: PoseMatrix::zeros(), shown: Shown::Whole };
    let distance = track.in_image_lengths(displaced.displacement_from(track.body_pose()));
    Some((from_expected.unwrap_or(as_displaced), distance))
}

/// How far the outline lies from where it was expected, as a frame tells it that shows it and was not taken. Held to where it was expected, it may agree
/// in part though all of it is shown.
fn apart_by(
    settings: &FilterSettings,
    (track, frame): (&Track, &mut Frame),
    outcome: &Outcome,
    since_taken: f64,
) -> Option<Apart> {
    let pose = outcome.pose.as_ref().filter(|_| !outcome.is_accepted())?;
    let whole = gate_of_all(settings, track);
    let is_whole = outcome.measurement.agreement >= whole.smallest_agreement;
    let shown = if is_whole { Shown::Whole } else { Shown::InPart };
    let apart = Apart::measured(pose, shown, &track.null_directions())?;
    let elsewhere = if is_whole { None } else { whole_at((track, frame), (&apart.error, since_taken), &whole) };
    Some(elsewhere.map_or(apart, |(elsewhere, _)| elsewhere))
}

/// Whether a frame may show the outline elsewhere than it was expected: the sides of a bar that has moved along itself may still lie on it, and its
/// ends look like noise.
pub(super) fn may_be_apart(outcome: &Outcome) -> bool {
    use Rejection::{AgreementTooSmall, NoiseTooLarge, NotFound};
    matches!(outcome.verdict, Err(AgreementTooSmall { .. } | NoiseTooLarge { .. } | NotFound))
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
    let variances = [0, 1].map(|kind| (innovation.gradient[kind] / innovation.fisher[kind]).max(0.0));
    changed.add_change(variances, TimeOfChange::Any);
    let found = changed.update(frame, gate, comparison);
    found.is_accepted().then_some((changed, found))
}

/// What becomes of a frame that shows the object so far from where it was expected that linearisations do not lead there, but where a search from
/// there has found it, turned by no more than so much, which the motion has made of it in so many seconds; `None`, with nothing changed, where it is not
/// accepted there either.
pub(super) fn outcome_nearby(
    (track, frame): (&mut Track, &mut Frame),
    dynamics: Option<&mut DynamicsFilter>,
    (farthest_turn, (apart, seconds)): (f64, (PoseVector, f64)),
    (gate, comparison): (&Gate, Comparison),
) -> Option<Outcome> {
    let mut displaced = track.clone();
    let is_shown = displaced.displace(&apart, seconds);
    let pose = *displaced.body_pose();
    if !is_shown || track.turn_to(&pose).abs() >= farthest_turn {
        return None;
    }
    let outcome = displaced.update(frame, gate, comparison);
    if !outcome.is_accepted() || dynamics.is_some_and(|dynamics| !dynamics.set_reference(&pose)) {
        return None;
    }
    *track = displaced;
    Some(outcome.after_rejected())
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
        track.add_change(variances, TimeOfChange::Beginning);
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
