//! What was found over time, as curves of a panel and as rows of a table.
use std::ops::Range;

use freeform_riccati::{MotionModel, ProjectiveMotion};

use super::curves::curve;
use super::relative_error::RelativeError;
use super::sequence::Sequence;
use super::track::Track;
use crate::figure::{Curve, Figure, Look, Panel};
use freeform_drawing::page::Table;

/// Ends of the axis of relative errors, in percent, where the motion is constant.
pub(super) const ERROR_LIMITS: [f64; 2] = [1e-4, 1e3];

/// Half the time in seconds that an error is averaged over for drawing.
const HALF_WINDOW: f64 = 0.25;

/// Some parameters of a track, each in a colour of its own, with their true values dashed.
pub(super) fn parameter_curves(
    model: MotionModel,
    parameters: Range<usize>,
    track: &Track,
    sequence: &Sequence,
) -> Vec<Curve> {
    let found = parameters.clone().map(|k| {
        curve(model.parameter_names()[k], Look::Series(k), stretches(&times(track), &values(model, track, k)))
    });
    let truth = parameters.map(|k| true_values(model, sequence, k)).collect();
    found.chain([curve("true values", Look::Reference, truth)]).collect()
}

/// The true value of a parameter over the whole run.
pub(super) fn true_values(model: MotionModel, sequence: &Sequence, index: usize) -> Vec<[f64; 2]> {
    let times = sequence.frames.iter().map(|(time, _)| *time);
    times.filter_map(|time| Some([time, parameter(model, &sequence.truth.at(time), index)?])).collect()
}

/// One parameter of a track at each of its moments; `None` where there is no estimate.
pub(super) fn values(model: MotionModel, track: &Track, index: usize) -> Vec<Option<f64>> {
    track.moments.iter().map(|moment| parameter(model, &moment.motion?, index)).collect()
}

/// The times of all moments.
pub(super) fn times(track: &Track) -> Vec<f64> {
    track.moments.iter().map(|moment| moment.time).collect()
}

/// One parameter of a motion; `None` where the model does not hold it.
fn parameter(model: MotionModel, motion: &ProjectiveMotion, index: usize) -> Option<f64> {
    model.parameters_of_motion(motion).map(|values| values[index])
}

/// The values that there are, in runs that are broken where there is none.
pub(super) fn stretches(times: &[f64], values: &[Option<f64>]) -> Vec<Vec<[f64; 2]>> {
    let points: Vec<_> = times.iter().zip(values).map(|(time, value)| value.map(|value| [*time, value])).collect();
    let runs = points.split(Option::is_none).filter(|run| !run.is_empty());
    runs.map(|run| run.iter().copied().flatten().collect()).collect()
}

/// Relative errors in percent of rates and velocity at each moment of a track, as they are and as they are drawn.
struct Errors {
    exact: [Vec<Option<f64>>; 2],
    drawn: [Vec<Option<f64>>; 2],
}

impl Errors {
    fn of(track: &Track, sequence: &Sequence) -> Self {
        let errors = track.errors(&sequence.truth);
        let values: [fn(&RelativeError) -> f64; 2] = [|error| error.rates, |error| error.velocity];
        let exact = values.map(|value| {
            errors.iter().map(|error| error.as_ref().map(|error| 100.0 * value(error))).collect::<Vec<_>>()
        });
        let times = times(track);
        let drawn = [0, 1].map(|k: usize| smoothed(&times, &exact[k]));
        Self { exact, drawn }
    }
}

/// Relative errors of rates and velocity against time, on logarithmic axes.
pub(super) fn error_figure(
    what: &str,
    labels: [&str; 2],
    limits: [f64; 2],
    tracks: &[(&str, Track)],
    sequence: &Sequence,
) -> Figure {
    let panel = |index: usize| Panel {
        x_label: "time (s)".to_owned(),
        y_label: labels[index].to_owned(),
        curves: tracks
            .iter()
            .map(|(name, track)| {
                let drawn = &Errors::of(track, sequence).drawn[index];
                curve(name, look_of(name), stretches(&times(track), drawn))
            })
            .collect(),
        x_from: Some(0.0),
        x_to: Some(sequence.end().ceil()),
        y_logarithmic: true,
        y_limits: Some(limits),
        ..Panel::default()
    };
    Figure {
        title: format!("Relative errors of every method: {what}"),
        shares_legend: true,
        panels: vec![panel(0), panel(1)],
        columns: 1,
        panel_size: [720.0, 290.0],
    }
}

/// What the captions of errors say of how they are drawn.
pub(super) fn smoothing_in_words([low, high]: [f64; 2]) -> String {
    format!(
        "Each point is the root mean square over {} s about it, so that an error that passes through zero shows no dip; \
         a curve is broken where the method gives no estimate, and cut off beyond {high} % and below {low} %.",
        2.0 * HALF_WINDOW
    )
}

/// What a method looks like, the same in all figures.
pub(super) fn look_of(method: &str) -> Look {
    let looks = [
        ("36 numbers", Look::Series(0)),
        ("structured law, one pair", Look::Series(1)),
        ("structured law", Look::Series(2)),
        ("fast law", Look::Series(3)),
        ("mixing law", Look::Series(5)),
        ("motion filter, held constant", Look::Dashed(4)),
        ("motion filter, changes told", Look::Dashed(5)),
        ("motion filter", Look::Series(4)),
    ];
    looks.iter().find(|(beginning, _)| method.starts_with(beginning)).map_or(Look::Line, |(_, look)| *look)
}

/// Root mean squares over [`HALF_WINDOW`] before and after each value, less where a stretch of values ends.
fn smoothed(times: &[f64], values: &[Option<f64>]) -> Vec<Option<f64>> {
    let mut smooth = vec![None; values.len()];
    let mut start = 0;
    for stretch in values.chunk_by(|a, b| a.is_some() == b.is_some()) {
        let times = &times[start..start + stretch.len()];
        for (k, slot) in smooth[start..].iter_mut().enumerate().take(stretch.len()) {
            // As far to one side as to the other.
            let reach = HALF_WINDOW.min(times[k] - times[0]).min(times[times.len() - 1] - times[k]) + 1e-9;
            let from = times.partition_point(|time| *time < times[k] - reach);
            let to = times.partition_point(|time| *time <= times[k] + reach);
            let squares: Option<f64> = stretch[from..to].iter().map(|value| value.map(|value| value * value)).sum();
            *slot = squares.map(|squares| (squares / (to - from) as f64).sqrt());
        }
        start += stretch.len();
    }
    smooth
}

/// Every estimate, as it is drawn; empty where there is none.
pub(super) fn estimates_data<'a>(
    model: MotionModel,
    tracks: impl IntoIterator<Item = &'a (&'a str, Track)>,
    sequence: &Sequence,
) -> Table {
    let names = model.parameter_names();
    let truths = names.iter().map(|name| format!("true_{name}"));
    let heads: Vec<String> =
        ["method", "time"].into_iter().chain(names.iter().copied()).map(str::to_owned).chain(truths).collect();
    let mut data = Table { heads, ..Table::default() };
    for (name, track) in tracks {
        for moment in &track.moments {
            let found = moment.motion.and_then(|motion| model.parameters_of_motion(&motion));
            let found = found.map_or_else(|| vec![None; names.len()], |values| values.into_iter().map(Some).collect());
            let truth = model.parameters_of_motion(&sequence.truth.at(moment.time)).unwrap_or_default();
            let numbers: Vec<_> =
                std::iter::once(Some(moment.time)).chain(found).chain(truth.into_iter().map(Some)).collect();
            data.push_known(&[name], &numbers);
        }
    }
    data
}

/// Every error, as it is and as it is drawn; empty where there is no estimate.
pub(super) fn errors_data(tracks: &[(&str, Track)], sequence: &Sequence) -> Table {
    let mut data = Table::of_data(&[
        "method",
        "time",
        "rates_error_percent",
        "velocity_error_percent",
        "rates_error_percent_drawn",
        "velocity_error_percent_drawn",
    ]);
    for (name, track) in tracks {
        let Errors { exact, drawn } = Errors::of(track, sequence);
        for (k, time) in times(track).into_iter().enumerate() {
            data.push_known(&[name], &[Some(time), exact[0][k], exact[1][k], drawn[0][k], drawn[1][k]]);
        }
    }
    data
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smoothing_keeps_the_ends_and_what_is_constant_and_fills_a_dip() {
        let times: Vec<f64> = (0..20).map(|k| 0.1 * f64::from(k)).collect();
        let constant = vec![Some(3.0); 20];
        assert!(smoothed(&times, &constant).iter().all(|value| value.is_some_and(|value| (value - 3.0).abs() < 1e-12)));
        let dip: Vec<_> = (0..20).map(|k| Some(if k == 10 { 0.0 } else { 1.0 })).collect();
        let smooth = smoothed(&times, &dip);
        assert_eq!((smooth[0], smooth[19]), (dip[0], dip[19]));
        let bottom = smooth[10].expect("a value");
        assert!((bottom - 0.8_f64.sqrt()).abs() < 1e-12, "four of five: {bottom}");
        assert!(smoothed(&[], &[]).is_empty());
    }

    #[test]
    fn a_gap_breaks_the_curve_and_nothing_is_smoothed_across_it() {
        let times = [0.0, 0.1, 0.2, 0.3, 0.4];
        let values = [None, Some(1.0), None, Some(5.0), Some(5.0)];
        assert_eq!(smoothed(&times, &values), values);
        assert_eq!(stretches(&times, &values), [vec![[0.1, 1.0]], vec![[0.3, 5.0], [0.4, 5.0]]]);
    }

    #[test]
    fn every_method_of_a_figure_has_a_look_of_its_own() {
        let beside_the_paper =
            ["36 numbers as printed, one pair", "structured law, one pair", "structured law, all pairs"];
        let others =
            ["fast law", "mixing law", "motion filter, changes told", "motion filter", "motion filter, held constant"];
        let looks: Vec<_> = beside_the_paper.iter().chain(&others).map(|method| look_of(method)).collect();
        assert!((0..looks.len()).all(|k| !looks[k + 1..].contains(&looks[k])), "{looks:?}");
        assert_eq!(look_of("structured law"), look_of("structured law, all pairs"));
        assert_eq!(look_of("fast law, all pairs"), look_of("fast law"));
    }
}
