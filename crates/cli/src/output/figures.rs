use freeform_motion::curve_fit::Outline;
use freeform_motion::riccati::{AffineMotion, MotionModel};
use nalgebra::Point2;

use super::number::short;
use crate::commands::FittedOutline;
use crate::history::History;
use crate::level_set::{Area, curve_of, stray};
use crate::plot::{Curve, Look, Panel, stacked_svg};
use crate::truth::parameters_in;

/// What is seen around the points, as a share of their extent.
const SURROUNDINGS: f64 = 0.15;

/// Standard deviations on each side that a band shows.
const BAND: f64 = 2.0;

/// Outlines with their fitted curves and related points, as a file.
pub(crate) fn fit_figure(drawn: &[(FittedOutline, Outline)]) -> String {
    let title = drawn.first().map_or_else(String::new, |(fitted, _)| {
        format!("Frame {} at {} s, degree {}", fitted.frame, short(fitted.time), fitted.fit.working().degree())
    });
    stacked_svg(&[fit_panel(title, drawn)], 640.0, 640.0)
}

/// Outlines with their fitted curves and related points, in one pair of axes.
pub(crate) fn fit_panel(title: String, drawn: &[(FittedOutline, Outline)]) -> Panel {
    let xy = |p: &Point2<f64>| [p.x, p.y];
    let (mut points, mut curves, mut beside, mut related) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let mut outside = 0;
    let whole = Area::around(drawn.iter().flat_map(|(_, outline)| outline.points()));
    let view = whole.map(|area| area.widened(SURROUNDINGS).square());
    for (fitted, outline) in drawn {
        points.push(outline.points().map(xy).collect());
        let Some(area) = view else { continue };
        // Beyond what is seen, so that a curve that leaves it goes on to the frame.
        let traced = curve_of(&fitted.fit, &area.widened(SURROUNDINGS));
        for (run, stray) in traced.iter().zip(stray(&traced, outline)) {
            let runs = if stray { &mut beside } else { &mut curves };
            runs.push(run.iter().map(xy).collect());
        }
        let all = fitted.parts.iter().flat_map(|parts| parts.related_points.as_slice());
        let (inside, far): (Vec<_>, Vec<_>) = all.map(|d| d.point).partition(|point| area.contains(point));
        related.push(inside.iter().map(xy).collect());
        outside += far.len();
    }
    let related_name = match outside {
        0 => "related points".to_owned(),
        count => format!("related points ({count} outside)"),
    };
    let mut curves = vec![
        Curve { name: "outline".to_owned(), look: Look::Dots, runs: points },
        Curve { name: "fitted curve".to_owned(), look: Look::Line, runs: curves },
        Curve { name: related_name, look: Look::Crosses, runs: related },
    ];
    if !beside.is_empty() {
        curves.push(Curve { name: "stray part".to_owned(), look: Look::Dashed(0), runs: beside });
    }
    Panel {
        title,
        x_label: "x (image length)".to_owned(),
        y_label: "y (image length)".to_owned(),
        curves,
        view: view.map(|area| [xy(&area.low), xy(&area.high)]),
        ..Panel::default()
    }
}

/// The parameters of all objects against time, as a file.
pub(crate) fn parameter_figure(histories: &[History], model: MotionModel, truth: Option<&AffineMotion>) -> String {
    let several = histories.len() > 1;
    let panels = histories.iter().flat_map(|history| {
        let prefix = if several { format!("Object {}: ", history.object) } else { String::new() };
        parameter_panels(history, &prefix, model, truth)
    });
    stacked_svg(&panels.collect::<Vec<_>>(), 720.0, 270.0)
}

/// The parameters of one object against time, one panel each.
pub(crate) fn parameter_panels(
    history: &History,
    prefix: &str,
    model: MotionModel,
    truth: Option<&AffineMotion>,
) -> Vec<Panel> {
    let truth = truth.and_then(|motion| parameters_in(model, motion));
    let names = model.parameter_names().iter().zip(model.units()).enumerate();
    names
        .map(|(index, (name, unit))| {
            let mut curves = history.curves(index);
            if let (Some(truth), Some((first, last))) = (&truth, history.time_range()) {
                let runs = vec![vec![[first, truth[index]], [last, truth[index]]]];
                curves.push(Curve { name: "true value".to_owned(), look: Look::Truth, runs });
            }
            Panel {
                title: format!("{prefix}{}", meaning(name)),
                x_label: "time (s)".to_owned(),
                y_label: format!("{name} ({unit})"),
                curves,
                x_from: history.start,
                ..Panel::default()
            }
        })
        .collect()
}

/// How well the frames of one object fit, one panel for each measure that its method gives. Rejected frames, which have no
/// value that others could be held against, are marked at their times.
pub(crate) fn residual_panels(history: &History) -> Vec<Panel> {
    let measures = [
        ("Residual of the points", "rms (image length)", &history.residuals),
        ("Innovation of the motion", "squared, in units of its variance", &history.innovations),
    ];
    let times = history.rejected.iter().filter_map(|(_, time)| *time);
    let rejected: Vec<[f64; 2]> = times.map(|time| [time, 0.0]).collect();
    let drawn = measures.into_iter().filter(|(_, _, values)| !values.is_empty());
    drawn
        .map(|(title, y_label, values)| Panel {
            title: title.to_owned(),
            x_label: "time (s)".to_owned(),
            y_label: y_label.to_owned(),
            curves: vec![
                Curve { name: "frames used".to_owned(), look: Look::Dots, runs: vec![values.clone()] },
                Curve { name: "rejected frames".to_owned(), look: Look::Marks, runs: vec![rejected.clone()] },
            ],
            x_from: history.start,
            ..Panel::default()
        })
        .collect()
}

/// What a parameter is, in words.
fn meaning(name: &str) -> String {
    match name {
        "omega" => "Angular velocity omega".to_owned(),
        "sigma" => "Rate of growth sigma".to_owned(),
        "b1" | "b2" => format!("Velocity {name} at the origin"),
        _ => format!("Parameter {name}"),
    }
}

impl History {
    fn time_range(&self) -> Option<(f64, f64)> {
        Some((self.estimates.first()?.0, self.estimates.last()?.0))
    }

    /// What was identified of a parameter, with a band where its standard deviation is known.
    fn curves(&self, parameter: usize) -> Vec<Curve> {
        let (mut line, mut low, mut high) = (Vec::new(), Vec::new(), Vec::new());
        let mut runs = Vec::new();
        for (time, estimate) in &self.estimates {
            let found = estimate.parameters().nth(parameter);
            let Some(value) = found.and_then(|p| p.value) else {
                runs.push(std::mem::take(&mut line));
                continue;
            };
            line.push([*time, value]);
            if let Some(deviation) = found.and_then(|p| p.standard_deviation) {
                low.push([*time, value - BAND * deviation]);
                high.push([*time, value + BAND * deviation]);
            }
        }
        runs.push(line);
        runs.retain(|run| !run.is_empty());
        high.reverse();
        low.append(&mut high);
        let band = if low.is_empty() { Vec::new() } else { vec![low] };
        vec![
            Curve { name: "2 std".to_owned(), look: Look::Band, runs: band },
            Curve { name: "identified".to_owned(), look: Look::Line, runs },
        ]
    }
}
