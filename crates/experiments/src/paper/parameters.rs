//! Figs. 4, 6 and 8: estimated parameters against time, and the same experiments by other laws.
use freeform_identify::{AdaptiveLaw, PairChoice};
use freeform_riccati::MotionModel;
use freeform_sim_camera::PaperExperiment;

use super::Run;
use super::document::{Drawing, Section, Table};
use super::method::{Method, random_start};
use super::outcome::{Outcome, outcomes_in_words, rules};
use super::paper_figure::PaperFigure;
use super::sequence::{FPS, POINTS, Sequence};
use super::traces::{ERROR_LIMITS, error_figure, errors_data, estimates_data, parameter_curves, smoothing_in_words};
use super::track::Track;
use crate::ExperimentError;
use crate::figure::{Figure, Panel};

/// Heads of the table of final errors.
pub(super) const FINDINGS: [&str; 8] =
    ["experiment", "method", "omega", "b1", "b2", "omega error %", "b error %", "settled s"];

/// Share of the run after which a motion that has not settled is not identified quickly.
const QUICK_SHARE: f64 = 0.5;

/// Runs of one experiment: the first of which only chooses the pair.
pub(super) const RUNS: u64 = 7;

pub(super) fn section(run: &Run, figures: &[PaperFigure]) -> Result<Section, ExperimentError> {
    let heading = figures.first().map_or("", |figure| figure.parameters_heading).to_owned();
    let mut section = Section { heading, ..Section::default() };
    for figure in figures {
        add_experiment(run, figure, &mut section)?;
    }
    Ok(section)
}

fn add_experiment(run: &Run, figure: &PaperFigure, section: &mut Section) -> Result<(), ExperimentError> {
    let PaperFigure { parameters: name, experiment, stream, .. } = figure;
    let sequence = Sequence::of_paper(experiment, run.seconds, run.seed)?;
    let start = random_start(run.seed, *stream);
    let law = |law, pairs| Method::law(MotionModel::Rigid, law, pairs, &start);
    let best = Track::by(&law(AdaptiveLaw::Structured, PairChoice::Best), &sequence)?;
    run.advance();
    let pair = PairChoice::Given(best.pair.unwrap_or(0));
    let methods = [
        ("36 numbers as printed, one pair", law(AdaptiveLaw::Printed, pair)),
        ("structured law, one pair", law(AdaptiveLaw::Structured, pair)),
        ("structured law, all pairs", law(AdaptiveLaw::Structured, PairChoice::All)),
        ("fast law, all pairs", law(AdaptiveLaw::FilteredLeastSquares, PairChoice::All)),
        ("motion filter", Method::filter(MotionModel::Rigid)),
    ];
    let mut tracks = Vec::new();
    for (method_name, method) in &methods {
        let track = Track::by(method, &sequence)?;
        section.findings.push(finding(experiment, method_name, &track, &sequence));
        tracks.push((*method_name, track));
        run.advance();
    }
    let shown = &tracks[1];
    let panel = Panel {
        title: format!("Estimated parameters: {}", experiment.title),
        x_label: "time (s)".to_owned(),
        y_label: "omega (rad/s), b1, b2 (lengths/s)".to_owned(),
        curves: parameter_curves(MotionModel::Rigid, 0..3, &shown.1, &sequence),
        x_from: Some(0.0),
        x_to: Some(run.seconds),
        ..Panel::default()
    };
    section.drawings.push(Drawing {
        name: (*name).to_owned(),
        caption: caption(figure, &start, &Outcome::of(&shown.1, &sequence), &sequence),
        data: estimates_data(MotionModel::Rigid, [shown], &sequence),
        figure: Figure { panels: vec![panel], columns: 1, panel_size: [720.0, 400.0], ..Figure::default() },
    });
    section.drawings.push(Drawing {
        name: format!("{name}-laws"),
        caption: laws_caption(figure, &tracks, &sequence),
        data: errors_data(&tracks, &sequence),
        figure: error_figure(experiment.title, ["omega error (%)", "b error (%)"], ERROR_LIMITS, &tracks, &sequence),
    });
    Ok(())
}

fn caption(figure: &PaperFigure, start: &[f64], outcome: &Outcome, sequence: &Sequence) -> String {
    let PaperExperiment { title, motion, .. } = figure.experiment;
    let start: Vec<_> = start.iter().map(|value| format!("{value:.2}")).collect();
    let slow = if outcome.settled > QUICK_SHARE * sequence.end() {
        " That is no quick convergence; the next figure shows all pairs and the other methods."
    } else {
        ""
    };
    format!(
        "Fig. {}, {title}. Estimated parameters (solid) against time with their true values (dashed): omega = {:.4} rad/s, \
         b1 = {}, b2 = {} in space. Here: {}. The paper: \u{201c}{}\u{201d}{slow} The law is equation 21 with the structure of \
         its matrices known ({} parameters), over one complex conjugate pair, that with the best signal against its noise \
         (the table of line pairs has the other); Am and Q as in the paper; initial values drawn at random, omega, b1, b2 = {}. {FPS} frames/s, \
         {POINTS} points a frame, noise {}, f/Z0 = {}: all but the noise is this project's choice. That the paper's law is \
         this one is a reading: taken literally it adapts 36 numbers, which take far longer (the next figure).{}",
        figure.number(),
        motion.omega,
        motion.b1,
        motion.b2,
        outcome.in_words("omega", sequence.end()),
        figure.paper_says,
        MotionModel::Rigid.parameter_count(),
        start.join(", "),
        PaperExperiment::NOISE,
        PaperExperiment::SCALE,
        figure.reading,
    )
}

fn laws_caption(figure: &PaperFigure, tracks: &[(&str, Track)], sequence: &Sequence) -> String {
    format!(
        "Beside Fig. {}, {}: relative errors of the same experiment, from the same outlines and initial values, on a \
         logarithmic axis. The estimator (21) as printed, with all 36 entries of A, B and C; the structured law over one \
         pair and over all; least squares on the filtered equations (fast law); and the motion \
         filter, which needs no lines and no initial values. Final errors: {}. {}",
        figure.number(),
        figure.experiment.title,
        outcomes_in_words(tracks, sequence),
        smoothing_in_words(ERROR_LIMITS)
    )
}

/// A row of the table of final errors.
fn finding(experiment: &PaperExperiment, method: &str, track: &Track, sequence: &Sequence) -> Vec<String> {
    let last = track.moments.last().and_then(|moment| moment.motion).map(|motion| [motion.a2, motion.b1, motion.b2]);
    let values = last.map_or_else(
        || [(); 3].map(|()| "-".to_owned()),
        |values| values.map(|value| format!("{:.4}", (1e4 * value).round() / 1e4 + 0.0)),
    );
    let outcome = Outcome::of(track, sequence).cells();
    [experiment.title.to_owned(), method.to_owned()].into_iter().chain(values).chain(outcome).collect()
}

/// What the table of final errors says.
pub(super) fn findings_table(rows: Vec<Vec<String>>) -> Table {
    Table {
        name: "final-errors".to_owned(),
        title: "Final errors".to_owned(),
        caption: format!("The parameters at the end of each run, in space. {}", rules("omega")),
        heads: FINDINGS.map(str::to_owned).into(),
        rows,
    }
}
