//! What was found over time, as curves of a panel and as rows of a table.
use std::ops::Range;

use freeform_motion::riccati::{AffineMotion, MotionModel};

use super::curves::curve;
use super::document::Table;
use super::experiment::{RelativeError, Sequence, Track};
use crate::plot::{Curve, Figure, Look, Panel};
use crate::truth::parameters_in;

/// Ends of the axis of relative errors, in percent.
const ERROR_LIMITS: [f64; 2] = [1e-4, 1e3];

/// Half the time in seconds that an error is averaged over for drawing.
const HALF_WINDOW: f64 = 0.25;

/// Some parameters of a track, each in a colour of its own, with their true values dashed.
pub(crate) fn parameter_curves(
    model: MotionModel,
    parameters: Range<usize>,
    track: &Track,
    sequence: &Sequence,
) -> Vec<Curve> {
    let first = parameters.start;
    let found = parameters.clone().map(|k| {
        let points = track.points.iter().filter_map(|(time, motion)| Some([*time, parameter(model, motion, k)?]));
        curve(model.parameter_names()[k], Look::Series(k - first), vec![points.collect()])
    });
    let truth = parameters.map(|k| {
        let name = if k == first { "true values" } else { "" };
        curve(name, Look::Dashed(k - first), vec![true_values(model, sequence, k)])
    });
    found.chain(truth).collect()
}

/// The true value of a parameter over the whole run.
pub(crate) fn true_values(model: MotionModel, sequence: &Sequence, index: usize) -> Vec<[f64; 2]> {
    let times = sequence.frames.iter().map(|(time, _)| *time);
    times.filter_map(|time| Some([time, parameter(model, &sequence.truth.at(time), index)?])).collect()
}

/// One parameter of a motion; `None` where the model does not hold it.
pub(crate) fn parameter(model: MotionModel, motion: &AffineMotion, index: usize) -> Option<f64> {
    parameters_in(model, motion).map(|values| values[index])
}

/// Relative errors of rates and velocity against time, on logarithmic axes.
pub(crate) fn error_figure(what: &str, labels: [&str; 2], tracks: &[(&str, Track)], sequence: &Sequence) -> Figure {
    let panel = |label: &str, value: fn(&RelativeError) -> f64| Panel {
        title: format!("Relative {}: {what}", label.split(" (").next().unwrap_or(label)),
        x_label: "time (s)".to_owned(),
        y_label: label.to_owned(),
        curves: tracks
            .iter()
            .map(|(name, track)| {
                let errors: Vec<_> = track.errors(&sequence.truth);
                let points: Vec<_> = errors.iter().map(|error| [error.time, 100.0 * value(error)]).collect();
                curve(name, Look::Series(colour_of(name)), vec![smoothed(&points)])
            })
            .collect(),
        x_from: Some(0.0),
        x_to: sequence.frames.last().map(|(time, _)| time.ceil()),
        y_logarithmic: true,
        y_limits: Some(ERROR_LIMITS),
        ..Panel::default()
    };
    let panels = vec![panel(labels[0], |error| error.rates), panel(labels[1], |error| error.velocity)];
    Figure { panels, columns: 1, panel_size: [720.0, 330.0], ..Figure::default() }
}

/// The colour of a method, the same in all figures.
pub(crate) fn colour_of(method: &str) -> usize {
    let beginnings = ["36 numbers", "structured law, one pair", "structured law", "fast law", "motion filter"];
    beginnings.iter().position(|beginning| method.starts_with(beginning)).unwrap_or(beginnings.len())
}

/// Root mean squares over [`HALF_WINDOW`] before and after each point, less where the points end.
fn smoothed(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return Vec::new() };
    let mean = |[time, _]: &[f64; 2]| {
        // As far to one side as to the other.
        let reach = HALF_WINDOW.min(time - first[0]).min(last[0] - time) + 1e-9;
        let from = points.partition_point(|point| point[0] < time - reach);
        let to = points.partition_point(|point| point[0] <= time + reach);
        let squares = points[from..to].iter().map(|point| point[1] * point[1]).sum::<f64>();
        [*time, (squares / (to - from) as f64).sqrt()]
    };
    points.iter().map(mean).collect()
}

/// Every estimate with its errors.
pub(crate) fn track_data(model: MotionModel, tracks: &[(&str, Track)], sequence: &Sequence) -> Table {
    let mut heads = vec!["method", "time"];
    heads.extend(model.parameter_names());
    heads.extend(["rates_error", "velocity_error"]);
    let mut data = Table::of_data(&heads);
    for (name, track) in tracks {
        for ((time, motion), error) in track.points.iter().zip(track.errors(&sequence.truth)) {
            let mut numbers = vec![*time];
            numbers.extend(parameters_in(model, motion).unwrap_or_default());
            numbers.extend([error.rates, error.velocity]);
            data.push(&[name], &numbers);
        }
    }
    data
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smoothing_keeps_the_ends_and_what_is_constant_and_fills_a_dip() {
        let at = |k: usize, value: f64| [0.1 * k as f64, value];
        let constant: Vec<_> = (0..20).map(|k| at(k, 3.0)).collect();
        assert!(smoothed(&constant).iter().all(|point| (point[1] - 3.0).abs() < 1e-12));
        let dip: Vec<_> = (0..20).map(|k| at(k, if k == 10 { 0.0 } else { 1.0 })).collect();
        let smooth = smoothed(&dip);
        assert_eq!((smooth[0], smooth[19]), (dip[0], dip[19]));
        assert!((smooth[10][1] - 0.8_f64.sqrt()).abs() < 1e-12, "four of five: {}", smooth[10][1]);
        assert!(smoothed(&[]).is_empty());
    }

    #[test]
    fn a_method_has_the_colour_of_its_law() {
        let names = ["36 numbers as printed", "structured law, one pair", "structured law, all pairs", "fast law"];
        assert_eq!(names.map(colour_of), [0, 1, 2, 3]);
        assert_eq!(colour_of("motion filter with process noise"), 4);
    }
}
