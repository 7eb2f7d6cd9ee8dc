//! Figures of where an object was and how well its motion is known.
use freeform_motion::riccati::{CameraScale, MotionModel};
use freeform_motion::tracker::{MotionFamily, Trajectory};

use super::bound_found::BoundAt;
use super::figures::BAND;
use super::meaning_of_b::MeaningOfB;
use crate::figure::{Curve, Look, Panel};
use crate::history::{History, PoseHistory};

/// Room for bands above and below all values, in half a usual band.
const ROOM_FOR_BANDS: f64 = 3.0;

/// The same as a share of the range of all values.
const ROOM_AROUND_VALUES: f64 = 0.25;

/// The pose of an object against time, one panel for each of its parameters, with bands; lines and bands end where nothing is stated, and are empty
/// where nothing ever is.
/// Positions are divided by a camera scale, as those of a trajectory are.
pub(crate) fn pose_panels(history: &History, poses: &PoseHistory, model: MotionModel, b: &MeaningOfB) -> Vec<Panel> {
    let names = Trajectory::pose_names(model).iter().enumerate();
    let panels = names.map(|(index, name)| {
        let (title, y_label, factor) = axis(name, b);
        let (mut line, mut band) = (Vec::new(), Vec::new());
        let (mut run, mut lower, mut upper) = (Vec::new(), Vec::new(), Vec::new());
        let mut all = Vec::new();
        let mut end_run = |run: &mut Vec<_>, lower: &mut Vec<_>, upper: &mut Vec<_>| {
            if !run.is_empty() {
                line.push(std::mem::take(run));
                band.push(lower.drain(..).chain(upper.drain(..).rev()).collect());
            }
        };
        for kept in poses.samples() {
            let stated = kept.value.parameters.get(index).copied().flatten();
            if !kept.follows || stated.is_none() {
                end_run(&mut run, &mut lower, &mut upper);
            }
            if let Some([value, deviation]) = stated {
                let (time, value, half) = (kept.value.time, factor * value, factor * BAND * deviation);
                all.push([value, half]);
                run.push([time, value]);
                lower.push([time, value - half]);
                upper.push([time, value + half]);
            }
        }
        end_run(&mut run, &mut lower, &mut upper);
        let spans = history.spans_without(&line);
        let mut curves = vec![
            Curve { name: "95 % band".to_owned(), look: Look::Band, runs: band },
            Curve { name: "identified".to_owned(), look: Look::Line, runs: line },
        ];
        curves.extend(spans);
        Panel {
            title,
            x_label: "time (s)".to_owned(),
            y_label,
            curves,
            x_from: history.start,
            x_to: history.end,
            y_limits: limits_of_values(&all),
            ..Panel::default()
        }
    });
    // A method without poses has no figures of them.
    if poses.samples().is_empty() { Vec::new() } else { panels.collect() }
}

/// The y axis of values with half the widths of their bands, where some of these are so wide that they would hide how the values go, as while
/// nothing is seen of an object: the range of the values, with room for a usual band.
fn limits_of_values(values: &[[f64; 2]]) -> Option<[f64; 2]> {
    let mut halves: Vec<f64> = values.iter().map(|[_, half]| *half).collect();
    halves.sort_unstable_by(f64::total_cmp);
    let usual = *halves.get(halves.len() / 2)?;
    let around = |room: f64| {
        let edges = values.iter().map(|[value, half]| (value - half.min(room), value + half.min(room)));
        edges.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], (l, h)| [low.min(l), high.max(h)])
    };
    let ([lowest, highest], [low, high]) = (around(f64::INFINITY), around(0.0));
    let room = f64::max(ROOM_FOR_BANDS * usual, ROOM_AROUND_VALUES * (high - low));
    let is_hidden = highest - lowest > high - low + 2.0 * room;
    is_hidden.then_some([low - room, high + room])
}

/// Title and label of a parameter of a pose, and what its numbers are multiplied by.
fn axis(name: &str, b: &MeaningOfB) -> (String, String, f64) {
    let scale = b.scale.map_or(1.0, CameraScale::value);
    match name {
        "angle" => ("Angle since the first frame".to_owned(), "angle (degrees)".to_owned(), 1_f64.to_degrees()),
        "x" | "y" => (format!("Position {name} of the middle"), format!("{name} ({})", b.of_length()), 1.0 / scale),
        "scale" => ("Size over that in the first frame".to_owned(), "scale".to_owned(), 1.0),
        "m31" | "m32" => (format!("Pose, entry {name}"), format!("{name} (1/length)"), scale),
        _ => (format!("Pose, entry {name}"), name.to_owned(), 1.0),
    }
}

/// The standard deviations of the parameters of an object against time on logarithmic axes, one panel each, beside the bound where
/// there is one.
pub(crate) fn deviation_panels(
    history: &History,
    family: MotionFamily,
    bound: &[BoundAt],
    b: &MeaningOfB,
) -> Vec<Panel> {
    let names = family.parameter_names().iter().zip(family.units()).zip(family.parameter_kinds()).enumerate();
    let panels = names.map(|(index, ((name, unit), kind))| {
        let unit = b.unit_of(*kind, unit);
        let of_bound = bound.iter().map(|(time, list)| (*time, list.get(index).copied().flatten()));
        let of = |random: bool| {
            let estimates = history.estimates.iter().map(move |(time, estimate)| {
                let parameter = estimate.as_ref().and_then(|parameters| parameters.get(index));
                let parameter = parameter.filter(|p| p.value.is_some());
                (*time, parameter.and_then(|p| if random { p.random_deviation } else { p.standard_deviation }))
            });
            runs(estimates)
        };
        let (all, random) = (of(false), of(true));
        let spans = history.spans_without(&all);
        let mut curves = vec![Curve { name: "standard deviation".to_owned(), look: Look::Line, runs: all }];
        // Told apart by its own line only where it is another.
        if differs(&curves[0].runs, &random) {
            curves.push(Curve { name: "random part of it".to_owned(), look: Look::Dashed(0), runs: random });
        }
        if !bound.is_empty() {
            curves.push(Curve { name: "least possible (bound)".to_owned(), look: Look::Truth, runs: runs(of_bound) });
        }
        curves.extend(spans);
        Panel {
            title: format!("Standard deviation of {name}"),
            x_label: "time (s)".to_owned(),
            y_label: format!("{name}, std ({unit})"),
            curves,
            x_from: history.start,
            x_to: history.end,
            y_logarithmic: true,
            ..Panel::default()
        }
    });
    panels.filter(|panel| !panel.curves[0].runs.is_empty()).collect()
}

/// The known values of a series as lines with gaps where none is known.
fn runs(series: impl Iterator<Item = (f64, Option<f64>)>) -> Vec<Vec<[f64; 2]>> {
    let (mut list, mut run) = (Vec::new(), Vec::new());
    for (time, value) in series {
        match value.filter(|value| *value > 0.0) {
            Some(value) => run.push([time, value]),
            None if run.is_empty() => {}
            None => list.push(std::mem::take(&mut run)),
        }
    }
    list.extend(Some(run).filter(|run| !run.is_empty()));
    list
}

/// Whether two lines can be told apart anywhere.
fn differs(a: &[Vec<[f64; 2]>], b: &[Vec<[f64; 2]>]) -> bool {
    a.iter().flatten().zip(b.iter().flatten()).any(|(a, b)| a[1] > 1.01 * b[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_that_are_far_wider_than_most_do_not_make_a_flat_line_of_the_values() {
        let values = |lost: f64| -> Vec<[f64; 2]> {
            let half = |i: u32| if (20..30).contains(&i) { lost } else { 0.01 };
            (0..60).map(|i| [0.01 * f64::from(i), half(i)]).collect()
        };
        let [low, high] = limits_of_values(&values(50.0)).expect("limits");
        assert!(low > -0.2 && low < -0.01 && high > 0.6 && high < 0.8, "{low} {high}");
        assert_eq!(limits_of_values(&values(0.02)), None);
        assert_eq!(limits_of_values(&[]), None);
        // Of an object at rest all bands are seen whole.
        assert_eq!(limits_of_values(&[[1.0, 0.1]; 9]), None);
    }

    #[test]
    fn a_series_has_gaps_where_nothing_is_known() {
        let values = [None, Some(1.0), Some(2.0), None, None, Some(3.0), Some(0.0), Some(4.0)];
        let series = values.into_iter().enumerate().map(|(time, value)| (time as f64, value));
        assert_eq!(runs(series), [vec![[1.0, 1.0], [2.0, 2.0]], vec![[5.0, 3.0]], vec![[7.0, 4.0]]]);
    }
}
