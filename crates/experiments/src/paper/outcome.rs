//! How far a method is from the truth, and from when on it is near.
use super::relative_error::{RelativeError, SETTLED_RATES, SETTLED_VELOCITY};
use super::sequence::Sequence;
use super::track::Track;
use freeform_motion::significant;

/// Share of the run, at its end, that final errors are taken over.
const FINAL_SHARE: f64 = 0.1;

/// What a run comes to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Outcome {
    /// Root mean square relative error of the rates over the end of the run; infinite, as unknown, where a frame there
    /// has no estimate.
    pub(super) rates: f64,
    /// As `rates`, for the velocity.
    pub(super) velocity: f64,
    /// Time in seconds from which on every frame has an estimate that is settled; infinite where there is none.
    pub(super) settled: f64,
    /// Share of frames rejected.
    pub(super) rejected: f64,
}

impl Outcome {
    pub(super) fn of(track: &Track, sequence: &Sequence) -> Self {
        let errors = track.errors(&sequence.truth);
        let tail_start = (1.0 - FINAL_SHARE) * sequence.end();
        let timed = || track.moments.iter().map(|moment| moment.time).zip(&errors);
        let tail: Option<Vec<_>> =
            timed().filter(|(time, _)| *time >= tail_start).map(|(_, error)| error.as_ref()).collect();
        let root_mean_square = |value: fn(&RelativeError) -> f64| {
            let tail = tail.as_deref().unwrap_or_default();
            let mean = tail.iter().map(|error| value(error).powi(2)).sum::<f64>() / tail.len() as f64;
            if mean.is_finite() { mean.sqrt() } else { f64::INFINITY }
        };
        let is_settled = |error: &Option<RelativeError>| error.is_some_and(|error| error.is_settled());
        let unsettled = errors.iter().rposition(|error| !is_settled(error));
        let first_settled = track.moments.get(unsettled.map_or(0, |last| last + 1));
        Self {
            rates: root_mean_square(|error| error.rates),
            velocity: root_mean_square(|error| error.velocity),
            settled: first_settled.map_or(f64::INFINITY, |moment| moment.time),
            rejected: track.share_rejected(),
        }
    }

    /// Entry by entry: the quantile of several outcomes, 0.5 for the median and 1 for the worst.
    pub(super) fn quantile(outcomes: &[Self], share: f64) -> Self {
        let entry = |value: fn(&Self) -> f64| {
            let mut values: Vec<f64> = outcomes.iter().map(value).collect();
            values.sort_by(f64::total_cmp);
            let place = share * values.len().saturating_sub(1) as f64;
            let (below, above) = (values.get(place.floor() as usize), values.get(place.ceil() as usize));
            let (Some(below), Some(above)) = (below, above) else { return f64::INFINITY };
            if below == above { *below } else { below + (above - below) * place.fract() }
        };
        Self {
            rates: entry(|o| o.rates),
            velocity: entry(|o| o.velocity),
            settled: entry(|o| o.settled),
            rejected: entry(|o| o.rejected),
        }
    }

    /// As a table shows it: errors in percent and the settling time in seconds.
    pub(super) fn cells(&self) -> [String; 3] {
        let settled = if self.settled.is_finite() { seconds(self.settled) } else { "-".to_owned() };
        [percent(self.rates), percent(self.velocity), settled]
    }

    /// The text for a caption; `rates` is the name of the rates of the motion, `end` the time of the end of the run.
    pub(super) fn in_words(&self, rates: &str, end: f64) -> String {
        let settled = match self.settled {
            never if never.is_infinite() => format!("not settled within {end:.0} s"),
            time => format!("settled after {} s", seconds(time)),
        };
        if self.rates.is_infinite() {
            return format!("no estimate in some of the last frames, {settled}");
        }
        format!("final error {} % of {rates} and {} % of b, {settled}", percent(self.rates), percent(self.velocity))
    }
}

/// The outcomes of several methods as text, for the caption of a figure of errors.
pub(super) fn outcomes_in_words(tracks: &[(&str, Track)], sequence: &Sequence) -> String {
    let outcome = |(name, track): &(&str, Track)| match Outcome::of(track, sequence).cells() {
        [rates, ..] if rates == "-" => format!("{name}: unknown"),
        [rates, velocity, _] => format!("{name}: {rates} and {velocity} %"),
    };
    tracks.iter().map(outcome).collect::<Vec<_>>().join("; ")
}

/// What the errors and the settling time of a table are; `rates` is what the rates of its motion are called.
pub(super) fn rules(rates: &str) -> String {
    let (rates_limit, velocity_limit) = (100.0 * SETTLED_RATES, 100.0 * SETTLED_VELOCITY);
    format!(
        "Errors are relative root mean squares over the last {:.0} % of the run (- where a frame there has no estimate). \
         Settled is the time from which on every frame has an estimate with {rates} within {rates_limit:.0} % and b within \
         {velocity_limit:.0} % of the truth (- where there is none).",
        100.0 * FINAL_SHARE
    )
}

fn seconds(time: f64) -> String {
    if time < 1.0 { format!("{time:.2}") } else { format!("{time:.1}") }
}

/// A share in percent with two digits.
pub(super) fn percent(share: f64) -> String {
    match 100.0 * share {
        value if !value.is_finite() => "-".to_owned(),
        // Beyond a factor of ten the digits say nothing, and nobody needs to know so little.
        value if value >= 1000.0 => "> 1000".to_owned(),
        value if value > 0.0 && value < 0.001 => "< 0.001".to_owned(),
        value => significant(value, 2),
    }
}

#[cfg(test)]
mod tests {
    use freeform_curve_fit::Outline;
    use freeform_riccati::CameraScale;

    use super::super::track::Moment;
    use freeform_riccati::ProjectiveMotion;

    use super::*;

    /// Omega off by some shares of itself, one frame a second; `None` for frames without an estimate.
    fn track(errors: &[Option<f64>]) -> (Track, Sequence) {
        let truth = ProjectiveMotion { a2: 1.0, a3: -1.0, b1: 1.0, ..ProjectiveMotion::default() };
        let off = |error: f64| ProjectiveMotion { a2: 1.0 + error, a3: -1.0 - error, ..truth };
        let moments = errors.iter().enumerate().map(|(k, error)| Moment { time: k as f64, motion: error.map(off) });
        let outline = Outline::closed([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(x, y)| [x, y].into()).into());
        let frame = |k: usize| (k as f64, outline.clone().expect("a triangle"));
        let sequence = Sequence {
            frames: (0..errors.len()).map(frame).collect(),
            truth: truth.into(),
            scale: CameraScale::default(),
        };
        (Track { moments: moments.collect(), ..Track::default() }, sequence)
    }

    fn outcome(errors: &[Option<f64>]) -> Outcome {
        let (found, sequence) = track(errors);
        Outcome::of(&found, &sequence)
    }

    #[test]
    fn a_run_has_settled_where_its_error_stays_small_and_not_where_it_is_so_for_a_moment() {
        let settled = outcome(&[0.5, 0.01, 0.2, 0.01, -0.02].map(Some));
        assert_eq!(settled.settled, 3.0);
        assert!((settled.rates - 0.02).abs() < 1e-12 && settled.velocity == 0.0);
        assert_eq!(outcome(&[0.01, 0.01, 0.2].map(Some)).settled, f64::INFINITY);
        assert_eq!(outcome(&[]).cells(), ["-", "-", "-"]);
    }

    #[test]
    fn a_frame_without_an_estimate_is_not_settled_and_one_at_the_end_leaves_the_error_unknown() {
        let gap = outcome(&[None, Some(0.01), None, Some(0.01), Some(0.02)]);
        assert_eq!(gap.settled, 3.0, "not from the first estimate on");
        assert!((gap.rates - 0.02).abs() < 1e-12, "the gap is not at the end");
        let ends_in_a_gap = outcome(&[None, Some(0.01), Some(0.01), None]);
        assert_eq!(ends_in_a_gap.cells(), ["-", "-", "-"]);
        assert_eq!(ends_in_a_gap.in_words("a", 3.0), "no estimate in some of the last frames, not settled within 3 s");
        // Twenty frames: the last tenth begins with the gap.
        let mut errors = [Some(0.01); 21];
        errors[18] = None;
        let at_the_end = outcome(&errors);
        assert_eq!((at_the_end.rates, at_the_end.velocity, at_the_end.settled), (f64::INFINITY, f64::INFINITY, 19.0));
        let (found, _) = track(&[None, Some(0.01), None, None, Some(0.01)]);
        assert_eq!(found.frames_lost(), 2);
    }

    #[test]
    fn median_and_worst_are_taken_entry_by_entry() {
        let outcome = |rates: f64, settled: f64| Outcome { rates, velocity: 0.0, settled, rejected: 0.0 };
        let outcomes = [outcome(0.3, 1.0), outcome(0.1, f64::INFINITY), outcome(0.2, 5.0)];
        assert_eq!(Outcome::quantile(&outcomes, 0.5), outcome(0.2, 5.0));
        assert_eq!(Outcome::quantile(&outcomes, 1.0), outcome(0.3, f64::INFINITY));
        assert_eq!(Outcome::quantile(&outcomes[..2], 0.5).settled, f64::INFINITY);
    }
}
