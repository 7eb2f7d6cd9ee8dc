//! Figs. 4, 6 and 8: estimated parameters against time, and the same experiments by other laws.
use freeform_identify::{AdaptiveLaw, PairChoice};
use freeform_riccati::MotionModel;
use freeform_sim_camera::PaperExperiment;

use super::Run;
use super::document::Section;
use super::method::{Method, random_start};
use super::outcome::{Outcome, outcomes_in_words, rules};
use super::paper_figure::{PaperFigure, SIZE};
use super::sequence::{FPS, POINTS, Sequence};
use super::traces::{ERROR_LIMITS, error_figure, errors_data, estimates_data, parameter_curves, smoothing_in_words};
use super::track::Track;
use crate::ExperimentError;
use crate::figure::{Figure, Panel};
use freeform_drawing::page::{Drawing, Table};

/// Heads of the table of final errors.
pub(super) const FINDINGS: [&str; 8] =
    ["experiment", "method", "omega", "b1", "b2", "omega error %", "b error %", "settled s"];

/// Share of the run after which a motion that has not settled is not identified quickly.
const QUICK_SHARE: f64 = 0.5;

/// Seconds within which the noise of the lines is known from a few frames only.
const FIRST_FRAMES: f64 = 0.5;

/// Runs of one experiment: the first of which only chooses the pair.
pub(super) const RUNS: u64 = 8;

pub(super) fn section(run: &Run, figures: &[PaperFigure]) -> Result<Section, ExperimentError> {
    let heading = figures.first().map_or("", |figure| figure.parameters_heading).to_owned();
    let mut section = Section { heading, ..Section::default() };
    for figure in figures {
        add_experiment(run, figure, &mut section)?;
    }
    Ok(section)
}

fn add_experiment(run: &Run, figure: &PaperFigure, section: &mut Section) -> Result<(), ExperimentError> {
    let PaperFigure { parameters: name, experiment, size, stream, .. } = figure;
    let sequence = Sequence::of_paper(experiment, run.seconds, run.seed)?;
    let start = random_start(run.seed, *stream);
    let law = |law, pairs| Method::law(MotionModel::Rigid, law, pairs, &start).with_size(*size);
    let best = Track::by(&law(AdaptiveLaw::Structured, PairChoice::Best), &sequence)?;
    run.advance();
    let pair = PairChoice::Given(best.pair.unwrap_or(0));
    let methods = [
        ("36 numbers as printed, one pair", law(AdaptiveLaw::Printed, pair)),
        ("structured law, one pair", law(AdaptiveLaw::Structured, pair)),
        ("structured law, all pairs", law(AdaptiveLaw::Structured, PairChoice::All)),
        ("fast law, all pairs", law(AdaptiveLaw::FilteredLeastSquares, PairChoice::All)),
        ("mixing law, all pairs", law(AdaptiveLaw::RegressorMixing, PairChoice::All)),
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
        caption: caption(figure, &start, &shown.1, &sequence),
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

fn caption(figure: &PaperFigure, start: &[f64], shown: &Track, sequence: &Sequence) -> String {
    let outcome = Outcome::of(shown, sequence);
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
         {POINTS} points a frame, noise {}, f/Z0 = {}, RMS radius {} of the object in the identifier: all but the noise is this project's \
         choice.{}{} That the paper's law is \
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
        figure.size,
        size_in_words(figure),
        gaps_in_words(shown),
        figure.reading,
    )
}

/// Why an object has another size in the identifier than the others, if it has.
fn size_in_words(figure: &PaperFigure) -> String {
    if figure.size == SIZE {
        return String::new();
    }
    format!(
        " The size sets the speed: with that of the other objects, {SIZE}, the {} converges several times more slowly (the table of \
         sizes).",
        figure.experiment.title
    )
}

/// Where and why the curves are broken, if they are.
fn gaps_in_words(track: &Track) -> String {
    let since_first = track.moments.iter().skip_while(|moment| moment.motion.is_none());
    let Some(last) = since_first.filter(|moment| moment.motion.is_none()).last() else { return String::new() };
    let lost = track.frames_lost();
    let broken = format!(
        " The curves are broken in {lost} frame(s), the last at {:.2} s, in which no motion is stated",
        last.time
    );
    if last.time > FIRST_FRAMES {
        return broken + ".";
    }
    broken
        + ": the noise of the lines is known from so few frames there that it cannot be told from what the lines say of a turn. \
           The law itself runs on."
}

fn laws_caption(figure: &PaperFigure, tracks: &[(&str, Track)], sequence: &Sequence) -> String {
    format!(
        "Beside Fig. {}, {}: relative errors of the same experiment, from the same outlines and initial values, on a \
         logarithmic axis. The estimator (21) as printed, with all 36 entries of A, B and C; the structured law over one \
         pair and over all; least squares on the filtered equations (fast law); dynamic regressor extension and mixing on the same \
         (mixing law); and the motion filter, which needs no lines and no initial values. Final errors: {}. {}",
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

#[cfg(test)]
mod tests {
    use freeform_motion::PipelineSettings;
    use freeform_riccati::ProjectiveMotion;

    use super::super::paper_figure::{BIRD, PHONE};
    use super::super::track::Moment;
    use super::*;

    #[test]
    fn a_caption_says_where_its_curves_are_broken_and_in_the_first_frames_why() {
        let track = |known: &[bool], fps: f64| Track {
            moments: known
                .iter()
                .enumerate()
                .map(|(k, known)| Moment { time: k as f64 / fps, motion: known.then(ProjectiveMotion::default) })
                .collect(),
            ..Track::default()
        };
        assert_eq!(gaps_in_words(&track(&[false, true, true], 30.0)), "");
        let early = gaps_in_words(&track(&[false, true, false, true], 20.0));
        assert!(early.contains("1 frame(s), the last at 0.10 s") && early.contains("runs on"), "{early}");
        let late = gaps_in_words(&track(&[false, true, false, false], 1.0));
        assert!(late.contains("2 frame(s), the last at 3.00 s") && !late.contains("noise"), "{late}");
    }

    #[test]
    fn an_object_of_another_size_in_the_identifier_than_usual_is_told_so() {
        assert_eq!(PipelineSettings::default().size, SIZE);
        assert_eq!(size_in_words(&BIRD[0]), "");
        assert!(size_in_words(&PHONE[0]).contains("cellular phone"));
    }
}
