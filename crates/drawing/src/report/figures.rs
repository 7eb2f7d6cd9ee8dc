use freeform_motion::curve_fit::{Outline, Rectangle, stray_parts};
use freeform_motion::estimate::ParameterEstimate;
use freeform_motion::tracker::MotionFamily;
use freeform_motion::{FittedOutline, Truth, short, significant};
use nalgebra::Point2;

use super::meaning_of_b::MeaningOfB;
use crate::figure::{Curve, Look, Panel};
use crate::history::{Histories, History};
use crate::plot::stacked_svg;

/// Share of the values and band edges at each end of their range that need not be within a figure of a parameter: the first frames tell little, and
/// their bands would make a flat line of all that comes after them.
const BEYOND: f64 = 0.04;

/// A range of all values is kept if it is no wider than so many ranges of most of them.
const RANGES_OF_MOST: f64 = 8.0;

/// Room above and below the range of most values, as a share of it.
const ROOM_AROUND_MOST: f64 = 0.5;

/// Shortest time at which nothing is stated that is marked in a figure, in usual steps of its line: within a recording a single frame leaves two. At
/// its beginning, where the first frame tells no motion, and at its end it leaves one, which may be that of a line of which points are left out.
const SHORTEST_SPAN: f64 = 1.5;

/// What is seen around the points, as a share of their extent.
const SURROUNDINGS: f64 = 0.15;

/// Standard deviations on each side of a band that 95 of 100 true values lie in.
pub(super) const BAND: f64 = 1.96;

/// Outlines of one frame with their fitted curves and related points, as an SVG file.
///
/// ```
/// use freeform_drawing::fit_figure;
/// use freeform_motion::FittedOutline;
/// use freeform_motion::curve_fit::{FitSettings, Fitter};
/// use freeform_motion::outline_io::{DEFAULT_OBJECT, OutlineFrame};
/// use freeform_motion::sim_camera::{PaperExperiment, SequenceLength, Settings, Simulator};
///
/// let settings = Settings { length: SequenceLength::Frames(1), ..Settings::default() };
/// let simulator = Simulator::new(PaperExperiment::FLIGHT_BIRD.scene(0.1)?, settings)?;
/// let outline = simulator.frames().next().expect("a frame").outline;
/// let frame = OutlineFrame { frame: 0, time: 0.0, object: DEFAULT_OBJECT.to_owned(), outline };
/// let fit = Fitter::new(FitSettings::default())?.fit(&frame.outline)?;
/// let svg = fit_figure(&[(FittedOutline::new(&frame, fit), frame.outline)]);
/// assert!(svg.contains("fitted curve") && svg.contains("residual 0.0"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn fit_figure(drawn: &[(FittedOutline, Outline)]) -> String {
    let title = drawn.first().map_or_else(String::new, |(fitted, _)| {
        let (time, degree) = (short(fitted.time), fitted.fit.working().degree());
        let residuals = drawn.iter().map(|(fitted, _)| fitted.fit.diagnostics().geometric_residual);
        let largest = significant(residuals.fold(0.0, f64::max), 3);
        let up_to = if drawn.len() > 1 { "up to " } else { "" };
        format!("Frame {} at {time} s, degree {degree}, residual {up_to}{largest}", fitted.frame)
    });
    stacked_svg(&[fit_panel(title, drawn, "image length")], 640.0, 640.0)
}

/// Outlines with their fitted curves and related points, in one pair of axes, in a unit of length.
pub(crate) fn fit_panel(title: String, drawn: &[(FittedOutline, Outline)], unit: &str) -> Panel {
    let xy = |p: &Point2<f64>| [p.x, p.y];
    let (mut points, mut curves, mut beside, mut related) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let mut outside = 0;
    let whole = Rectangle::around(drawn.iter().flat_map(|(_, outline)| outline.points()));
    let view = whole.map(|area| area.widened(SURROUNDINGS).square());
    for (fitted, outline) in drawn {
        points.extend(outline.pieces().map(|piece| piece.points.iter().map(xy).collect::<Vec<_>>()));
        let Some(area) = view else { continue };
        // Beyond what is seen, so that a curve that leaves it goes on to the frame.
        let traced = fitted.fit.curve_within(&area.widened(SURROUNDINGS));
        for (run, stray) in traced.iter().zip(stray_parts(&traced, outline)) {
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
        x_label: format!("x ({unit})"),
        y_label: format!("y ({unit})"),
        curves,
        view: view.map(|area| [xy(&area.low), xy(&area.high)]),
        ..Panel::default()
    }
}

/// The parameters of all objects against time with 95 % bands, as an SVG file; beside them the truth, where it is known and constant. `b` says the
/// unit of velocities.
#[must_use]
pub fn parameter_figure(histories: &Histories, family: MotionFamily, truth: Option<&Truth>, b: &MeaningOfB) -> String {
    let several = histories.list.len() > 1;
    let panels = histories.list.iter().flat_map(|history| {
        let prefix = if several { format!("Object {}: ", history.object) } else { String::new() };
        parameter_panels(history, &prefix, family, truth, b)
    });
    stacked_svg(&panels.collect::<Vec<_>>(), 720.0, 270.0)
}

/// The parameters of one object against time, one panel each.
pub(crate) fn parameter_panels(
    history: &History,
    prefix: &str,
    family: MotionFamily,
    truth: Option<&Truth>,
    b: &MeaningOfB,
) -> Vec<Panel> {
    // A level line would be wrong of a motion that changes.
    let truth = truth.and_then(|truth| truth.constant_parameters_in(family));
    let names = family.parameter_names().iter().zip(family.units()).zip(family.parameter_kinds()).enumerate();
    names
        .map(|(index, ((name, unit), kind))| {
            let unit = b.unit_of(*kind, unit);
            let mut curves = history.curves(index);
            let limits = limits_of_most(&curves, truth.as_ref().map(|truth| truth[index]));
            let beyond = limits.map_or(0, |limits| values_beyond(&curves, limits));
            let note = if beyond > 0 { format!(", {beyond} values beyond") } else { String::new() };
            if let (Some(truth), Some((first, last))) = (&truth, history.time_range()) {
                let runs = vec![vec![[first, truth[index]], [last, truth[index]]]];
                curves.push(Curve { name: "true value".to_owned(), look: Look::Truth, runs });
            }
            let line = curves.iter().find(|curve| curve.look == Look::Line);
            let spans = line.and_then(|line| history.spans_without(&line.runs));
            curves.extend(spans);
            Panel {
                title: format!("{prefix}{}{note}", meaning(name)),
                x_label: "time (s)".to_owned(),
                y_label: format!("{name} ({unit})"),
                curves,
                y_limits: limits,
                x_from: history.start,
                x_to: history.end,
                ..Panel::default()
            }
        })
        .collect()
}

/// How well the frames of one object fit, one panel for each measure that its method gives. Rejected frames, which have no
/// value that others could be held against, are marked at their times.
pub(crate) fn residual_panels(history: &History, b: &MeaningOfB) -> Vec<Panel> {
    let rms = format!("rms ({})", b.length_unit());
    let measures = [
        ("Residual of the points", rms.as_str(), &history.residuals),
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
            x_to: history.end,
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
        "wx" | "wy" | "wz" => format!("Angular velocity {name} in space"),
        "vx" | "vy" | "vz" => format!("Velocity {name} in space"),
        _ => format!("Parameter {name}"),
    }
}

impl History {
    fn time_range(&self) -> Option<(f64, f64)> {
        let mut known = self.estimates.iter().filter(|(_, estimate)| estimate.is_some()).map(|(time, _)| *time);
        let first = known.next()?;
        Some((first, known.next_back().unwrap_or(first)))
    }

    /// The times of the recording, from the first frame of the object on, at which a line does not run, as pale areas: all but a single frame at
    /// either end.
    pub(super) fn spans_without(&self, line: &[Vec<[f64; 2]>]) -> Option<Curve> {
        let (first, last) = self.start.zip(self.end)?;
        let ends = line.iter().filter_map(|run| Some((run.first()?[0], run.last()?[0])));
        let (mut from, mut runs) = (first, Vec::new());
        let shortest = SHORTEST_SPAN * usual_step(line);
        for (begins, ends) in ends.chain([(last, last)]) {
            if begins - from > shortest {
                runs.push(vec![[from, 0.0], [begins, 0.0]]);
            }
            from = from.max(ends);
        }
        (!runs.is_empty()).then(|| Curve { name: "not stated".to_owned(), look: Look::Spans, runs })
    }

    /// What was identified of a parameter, with a band where its standard deviation is known; both with gaps where it was not.
    fn curves(&self, parameter: usize) -> Vec<Curve> {
        let found = |list: &Vec<ParameterEstimate>| list.get(parameter).copied().filter(|p| p.value.is_some());
        let estimates = self.estimates.iter().map(|(time, estimate)| (*time, estimate.as_ref().and_then(found)));
        let estimates: Vec<_> = estimates.collect();
        let (mut runs, mut band) = (Vec::new(), Vec::new());
        for run in estimates.chunk_by(|a, b| a.1.is_some() == b.1.is_some()) {
            let known = || run.iter().filter_map(|(time, found)| found.map(|p| (*time, p)));
            let edge = |side: f64| {
                let offset = move |p: ParameterEstimate| Some(p.value? + side * BAND * p.standard_deviation?);
                known().filter_map(move |(time, p)| Some([time, offset(p)?]))
            };
            let outer: Vec<_> = edge(1.0).collect();
            runs.push(known().filter_map(|(time, p)| Some([time, p.value?])).collect());
            band.push(edge(-1.0).chain(outer.into_iter().rev()).collect());
        }
        let is_drawn = |run: &Vec<[f64; 2]>| !run.is_empty();
        runs.retain(is_drawn);
        band.retain(is_drawn);
        vec![
            Curve { name: "95 % band".to_owned(), look: Look::Band, runs: band },
            Curve { name: "identified".to_owned(), look: Look::Line, runs },
        ]
    }
}

/// The median time from point to point of a line; 0 where it has single points alone.
fn usual_step(line: &[Vec<[f64; 2]>]) -> f64 {
    let mut steps: Vec<f64> = line.iter().flat_map(|run| run.windows(2).map(|pair| pair[1][0] - pair[0][0])).collect();
    let middle = steps.len() / 2;
    if steps.is_empty() { 0.0 } else { *steps.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

/// The y axis of a parameter where few of its values and band edges would hide how the others go: the range of most of them, and a true value.
fn limits_of_most(curves: &[Curve], truth: Option<f64>) -> Option<[f64; 2]> {
    let points = curves.iter().flat_map(|curve| curve.runs.iter().flatten()).map(|point| point[1]);
    let mut values: Vec<f64> = points.filter(|value| value.is_finite()).collect();
    values.sort_unstable_by(f64::total_cmp);
    let (first, last) = (*values.first()?, *values.last()?);
    let left_out = (BEYOND * values.len() as f64) as usize;
    let (low, high) = (values[left_out], values[values.len() - 1 - left_out]);
    let (low, high) = truth.map_or((low, high), |truth| (low.min(truth), high.max(truth)));
    let range = high - low;
    let is_hidden = range > 0.0 && last.max(high) - first.min(low) > RANGES_OF_MOST * range;
    is_hidden.then_some([low - ROOM_AROUND_MOST * range, high + ROOM_AROUND_MOST * range])
}

/// Values of the line that are beyond the limits of its axis.
fn values_beyond(curves: &[Curve], [low, high]: [f64; 2]) -> usize {
    let lines = curves.iter().filter(|curve| curve.look == Look::Line);
    let values = lines.flat_map(|curve| curve.runs.iter().flatten()).map(|point| point[1]);
    values.filter(|value| !(low..=high).contains(value)).count()
}

#[cfg(test)]
mod tests {
    use freeform_motion::estimate::MotionEstimate;
    use freeform_motion::riccati::MotionModel;

    use super::*;

    #[test]
    fn neither_line_nor_band_bridges_a_time_at_which_nothing_was_known() {
        let estimate = MotionEstimate::new(MotionModel::Rigid, &[1.0, 2.0, 3.0], Some(&[0.1, 0.1, 0.1]));
        let estimates = (0..9).map(|frame| {
            let found = if frame == 2 { estimate.with_unobservable(0) } else { estimate };
            // Nothing at all in the first frame of all, and while the object is lost.
            let is_lost = frame == 0 || frame == 5;
            (f64::from(frame), (!is_lost).then(|| found.parameters().collect()))
        });
        let mut history = History::of("0".to_owned());
        history.estimates = estimates.collect();
        let curves = history.curves(0);
        assert_eq!(curves[0].runs[1], [[3.0, 0.804], [4.0, 0.804], [4.0, 1.196], [3.0, 1.196]]);
        let lengths = |curve: &Curve| curve.runs.iter().map(Vec::len).collect::<Vec<_>>();
        assert_eq!((lengths(&curves[0]), lengths(&curves[1])), (vec![2, 4, 6], vec![1, 2, 3]));
        assert_eq!(lengths(&history.curves(1)[1]), [4, 3]);
        assert_eq!(history.time_range(), Some((1.0, 8.0)));
    }

    #[test]
    fn the_time_goes_on_to_the_end_of_the_recording_and_what_is_not_stated_is_marked() {
        let estimate = MotionEstimate::new(MotionModel::Rigid, &[1.0, 2.0, 3.0], Some(&[0.1, 0.1, 0.1]));
        let estimates = (0..=50).map(|frame| {
            // Not in the first frame, in one, in some in the middle, and since the object was lost.
            let is_known = (1..20).contains(&frame) && frame != 9 || (30..40).contains(&frame);
            (f64::from(frame), is_known.then(|| estimate.parameters().collect()))
        });
        let history = History {
            estimates: estimates.collect(),
            start: Some(0.0),
            end: Some(80.0),
            ..History::of("a".to_owned())
        };
        let panel =
            parameter_panels(&history, "", MotionModel::Rigid.into(), None, &MeaningOfB::default()).swap_remove(0);
        assert_eq!((panel.x_from, panel.x_to), (Some(0.0), Some(80.0)));
        let spans = panel.curves.iter().find(|curve| curve.look == Look::Spans).expect("what is not stated");
        assert_eq!(spans.runs, [[[8.0, 0.0], [10.0, 0.0]], [[19.0, 0.0], [30.0, 0.0]], [[39.0, 0.0], [80.0, 0.0]]]);
        let line = |from: u32| vec![(from..=80).map(|time| [f64::from(time), 3.0]).collect()];
        assert_eq!(history.spans_without(&line(1)), None);
        assert_eq!(history.spans_without(&line(2)).expect("two frames").runs, [[[0.0, 0.0], [2.0, 0.0]]]);
        let of_pixels = MeaningOfB::in_pictures(false, 1.0, 1.0, None);
        let history = History { residuals: vec![[0.0, 0.1]], ..history };
        let residuals = residual_panels(&history, &of_pixels).swap_remove(0);
        assert_eq!((residuals.y_label.as_str(), residuals.x_to), ("rms (pixels)", Some(80.0)));
    }

    #[test]
    fn a_few_wide_bands_do_not_make_a_flat_line_of_the_others_and_values_beyond_are_counted() {
        let panel = |early: [f64; 2], frames: u32| {
            let estimates = (0..frames).map(|frame| {
                let later = [1.5 + 0.01 * f64::from(frame % 2), 0.02];
                let [value, deviation] = if frame < 3 { early } else { later };
                let estimate =
                    MotionEstimate::new(MotionModel::Rigid, &[value, 0.0, 0.0], Some(&[deviation, 0.1, 0.1]));
                (f64::from(frame), Some(estimate.parameters().collect()))
            });
            let history = History { estimates: estimates.collect(), ..History::of("a".to_owned()) };
            parameter_panels(&history, "", MotionModel::Rigid.into(), None, &MeaningOfB::default()).swap_remove(0)
        };
        let most = panel([40.0, 40.0], 300);
        let [low, high] = most.y_limits.expect("a range of most values");
        assert!(low > 1.3 && low < 1.46 && high > 1.55 && high < 1.7, "{low} {high}");
        assert!(most.title.ends_with(", 3 values beyond"), "{}", most.title);
        // Where the others are seen all the same, all are, and so they are where they are many.
        for all in [panel([1.6, 0.1], 300), panel([40.0, 40.0], 20)] {
            assert!(all.y_limits.is_none() && !all.title.contains("beyond"), "{}", all.title);
        }
    }
}
