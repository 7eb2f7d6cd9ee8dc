//! Beside the figures of the paper: e(t), the Lyapunov function and the 36 numbers, over lines that move exactly.
use std::{f64::consts::TAU, ops::Range};

use freeform_identify::AdaptiveLaw;
use freeform_motion::significant;
use freeform_sim_camera::{PaperExperiment, SequenceLength, Settings};
use nalgebra::SMatrix;

use super::Run;
use super::curves::curve;
use super::document::Section;
use super::exact_lines::{ExactLines, LawState};
use super::paper_figure::SIZE;
use super::sequence::FPS;
use super::traces::look_of;
use crate::ExperimentError;
use crate::figure::{Curve, Figure, Look, Panel};
use freeform_drawing::page::{Drawing, Table};

const EXPERIMENTS: [PaperExperiment; 3] =
    [PaperExperiment::FLIGHT_BIRD, PaperExperiment::GLIDER_OF_TEXT, PaperExperiment::CELLULAR_PHONE];

const LAWS: [(&str, AdaptiveLaw); 4] = [
    ("36 numbers as printed", AdaptiveLaw::Printed),
    ("structured law", AdaptiveLaw::Structured),
    ("fast law", AdaptiveLaw::FilteredLeastSquares),
    ("mixing law", AdaptiveLaw::RegressorMixing),
];

/// Steps between two frames of the other figures: the law takes the lines for resting within a step.
const STEPS_PER_FRAME: usize = 20;

/// Every so many frames a state is drawn.
const DRAWN: usize = 3;

/// The 36 numbers are run so many times as long as the experiments: half an hour.
const LONG: f64 = 60.0;

/// Steps between two frames of the long run: with one, the numbers come to rest up to 0.03 from the truth.
const LONG_STEPS_PER_FRAME: usize = 6;

/// The 36 numbers are drawn once in so many turns.
const TURNS: usize = 2;

/// Ends of the axes of e and of the Lyapunov function over its first value.
const ERROR_LIMITS: [f64; 2] = [1e-6, 10.0];
const FUNCTION_LIMITS: [f64; 2] = [1e-6, 2.0];

/// Sequences identified for the section.
pub(super) const RUNS: u64 = (EXPERIMENTS.len() * LAWS.len() + 1) as u64;

/// What one law did over one object.
struct Course {
    /// What is drawn.
    states: Vec<LawState>,
    summary: Summary,
}

/// The whole course, drawn or not.
#[derive(Debug, Clone, Copy, Default)]
struct Summary {
    first: Option<f64>,
    last: Option<f64>,
    /// Largest growth of the Lyapunov function in a step, in units of its first value; 0 if it never grows.
    growth: f64,
    largest_error: f64,
    last_error: f64,
}

impl Summary {
    fn take(&mut self, state: &LawState) {
        self.first = self.first.or(state.lyapunov);
        if let (Some(first), Some(before), Some(now)) = (self.first, self.last, state.lyapunov) {
            self.growth = self.growth.max((now - before) / first);
        }
        self.last = state.lyapunov;
        self.largest_error = self.largest_error.max(state.error);
        self.last_error = state.error;
    }

    fn row(&self, experiment: &str, law: &str) -> Vec<String> {
        let digits = |value: f64| significant(value, 2);
        let known = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), digits);
        let growth = self.first.map(|_| match self.growth {
            never if never <= 0.0 => "never".to_owned(),
            growth => format!("{growth:.0e}"),
        });
        vec![
            experiment.to_owned(),
            law.to_owned(),
            known(self.first),
            known(self.last),
            growth.unwrap_or_else(|| "-".to_owned()),
            digits(self.largest_error),
            digits(self.last_error),
        ]
    }
}

fn course(lines: &ExactLines, law: AdaptiveLaw, seconds: f64) -> Result<Course, ExperimentError> {
    let steps = (seconds * FPS).round() as usize * STEPS_PER_FRAME;
    let (mut states, mut summary, mut step) = (Vec::new(), Summary::default(), 0_usize);
    lines.run(law, 1.0 / (FPS * STEPS_PER_FRAME as f64), steps + 1, |state| {
        summary.take(&state);
        if step.is_multiple_of(DRAWN * STEPS_PER_FRAME) {
            states.push(state);
        }
        step += 1;
    })?;
    Ok(Course { states, summary })
}

pub(super) fn section(run: &Run) -> Result<Section, ExperimentError> {
    // No longer than other sequences can be.
    let length = SequenceLength::Seconds(run.seconds * LONG);
    Settings { fps: FPS, length, ..Settings::default() }.frame_count()?;
    let mut table = Table {
        name: "lyapunov-growth".to_owned(),
        title: "The Lyapunov function over exact lines".to_owned(),
        caption: format!(
            "V = e'Pe and the squared error of the parameters: of the motion, or of the 36 numbers. Growth is the largest in one of {} steps \
             a second, in units of V at the start. The fast and the mixing law have no such function; their e is that of the filtered regression.",
            FPS * STEPS_PER_FRAME as f64
        ),
        ..Table::of_data(&["experiment", "method", "V at start", "V at end", "V grows by", "largest |e|", "|e| at end"])
    };
    let mut data = Table::of_data(&["experiment", "method", "time", "error", "lyapunov"]);
    let (mut errors, mut functions) = (Vec::new(), Vec::new());
    for experiment in &EXPERIMENTS {
        let lines = ExactLines::of(experiment, SIZE)?;
        let (mut of_error, mut of_function) = (Vec::new(), Vec::new());
        for (name, law) in LAWS {
            let Course { states, summary } = course(&lines, law, run.seconds)?;
            run.advance();
            for state in &states {
                data.push_known(&[experiment.title, name], &[Some(state.time), Some(state.error), state.lyapunov]);
            }
            of_error.push(curve(
                name,
                look_of(name),
                vec![states.iter().map(|state| [state.time, state.error]).collect()],
            ));
            if let Some(first) = summary.first {
                let point = |state: &LawState| Some([state.time, state.lyapunov? / first]);
                of_function.push(curve(name, look_of(name), vec![states.iter().filter_map(point).collect()]));
            }
            table.rows.push(summary.row(experiment.title, name));
        }
        errors.push(panel(run, format!("|e|: {}", experiment.title), "|e|", ERROR_LIMITS, of_error));
        functions.push(panel(
            run,
            format!("V: {}", experiment.title),
            "V over V at the start",
            FUNCTION_LIMITS,
            of_function,
        ));
    }
    let drawing = drawing(errors.into_iter().chain(functions).collect(), data);
    let numbers = thirty_six_numbers(run)?;
    run.advance();
    Ok(Section {
        heading: "The error of the estimator and the Lyapunov function".to_owned(),
        text: "The paper shows that its Lyapunov function does not grow, and draws neither that nor the error. Outlines are fitted \
               anew in every frame, so that their lines follow the motion only nearly; here they follow it exactly."
            .to_owned(),
        drawings: vec![drawing, numbers],
        tables: vec![table],
        findings: Vec::new(),
    })
}

fn drawing(panels: Vec<Panel>, data: Table) -> Drawing {
    Drawing {
        name: "lyapunov".to_owned(),
        caption: format!(
            "Error e = Xh - X of the estimator (above) and Lyapunov function V = e'Pe and the squared error of the parameters (below), over the \
             first line pair of the bird, glider and phone. The lines are those of the first outline without noise, moved exactly by the \
             motion; RMS radius {SIZE} in the identifier, from zero, Am and Q as in the paper. V of the 36 numbers and of the structured law never \
             grows but for what the steps of the integration leave, which the table tells. That V does not grow says nothing of how soon it \
             falls: it rests wherever e is small while the parameters are still wrong, and that of the 36 numbers does so for long."
        ),
        data,
        figure: Figure {
            title: "Over exact lines: the error of the estimator and the Lyapunov function".to_owned(),
            shares_legend: true,
            panels,
            columns: EXPERIMENTS.len(),
            panel_size: [330.0, 250.0],
        },
    }
}

fn panel(run: &Run, title: String, y_label: &str, limits: [f64; 2], curves: Vec<Curve>) -> Panel {
    Panel {
        title,
        x_label: "time (s)".to_owned(),
        y_label: y_label.to_owned(),
        curves,
        x_from: Some(0.0),
        x_to: Some(run.seconds),
        y_logarithmic: true,
        y_limits: Some(limits),
        ..Panel::default()
    }
}

/// Rows and columns of `[A | C | B]` and what should stand there: in the order of the legend.
fn kinds() -> [(&'static str, Vec<(usize, usize)>); 5] {
    let named: [(&'static str, Vec<(usize, usize)>); 4] = [
        ("-b2, in A", vec![(2, 0), (3, 1)]),
        ("a3 = -omega, in C", (0..4).map(|i| (i, 4 + i)).collect()),
        ("a2 = omega, in B", vec![(0, 8)]),
        ("b1, in B", vec![(2, 8)]),
    ];
    let is_named = |entry: &(usize, usize)| named.iter().any(|(_, entries)| entries.contains(entry));
    let zeros = (0..4).flat_map(|i| (0..9).map(move |j| (i, j))).filter(|entry| !is_named(entry)).collect();
    let [b2, a3, a2, b1] = named;
    [("0", zeros), b2, a3, a2, b1]
}

/// The numbers of all matrices `[A | C | B]`, with their times in minutes.
type Found = [(f64, SMatrix<f64, 4, 9>)];

/// The entries of some of the columns over time.
fn panel_of_entries(title: &str, columns: Range<usize>, found: &Found, truth: &SMatrix<f64, 4, 9>) -> Panel {
    let curves = kinds().into_iter().enumerate().filter_map(|(kind, (name, entries))| {
        let entries: Vec<_> = entries.into_iter().filter(|(_, column)| columns.contains(column)).collect();
        let run = |entry: &(usize, usize)| found.iter().map(|(time, matrices)| [*time, matrices[*entry]]).collect();
        let look = if kind == 0 { Look::Faint } else { Look::Series(kind - 1) };
        (!entries.is_empty()).then(|| curve(name, look, entries.iter().map(run).collect()))
    });
    let end = found.last().map_or(0.0, |(time, _)| *time);
    let levels = kinds().into_iter().flat_map(|(_, entries)| entries.into_iter().take(1));
    let levels = levels.filter(|(_, column)| columns.contains(column)).map(|entry| truth[entry]);
    let truths = levels.map(|level| vec![[0.0, level], [end, level]]).collect();
    Panel {
        title: title.to_owned(),
        x_label: "time (min)".to_owned(),
        y_label: "entries (1/s)".to_owned(),
        curves: curves.chain([curve("true values", Look::Reference, truths)]).collect(),
        x_from: Some(0.0),
        x_to: Some(end),
        ..Panel::default()
    }
}

fn data_of_entries(found: &Found, truth: &SMatrix<f64, 4, 9>) -> Table {
    let mut data = Table::of_data(&["matrix", "row", "column", "minutes", "value", "truth"]);
    for (minutes, matrices) in found {
        for (matrix, columns) in [("A", 0..4_usize), ("C", 4..8), ("B", 8..9)] {
            for (row, column) in (0..4_usize).flat_map(|i| columns.clone().map(move |j| (i, j))) {
                let place = [(row + 1) as f64, (column - columns.start + 1) as f64];
                let numbers = [place[0], place[1], *minutes, matrices[(row, column)], truth[(row, column)]];
                data.push(&[matrix], &numbers);
            }
        }
    }
    data
}

/// All entries of A, B and C by the law as printed, over the flight bird.
fn thirty_six_numbers(run: &Run) -> Result<Drawing, ExperimentError> {
    let experiment = PaperExperiment::FLIGHT_BIRD;
    let lines = ExactLines::of(&experiment, SIZE)?;
    let truth = lines.true_matrices();
    // Between whole turns, so that what swings within one is not drawn.
    let interval = TURNS as f64 * TAU / experiment.motion.omega.abs();
    let frames = (interval * FPS).round() as usize * LONG_STEPS_PER_FRAME;
    let intervals = (LONG * run.seconds / interval).ceil() as usize;
    let mut found: Vec<(f64, SMatrix<f64, 4, 9>)> = vec![(0.0, SMatrix::zeros())];
    let mut frame = 0_usize;
    lines.run(AdaptiveLaw::Printed, interval / frames as f64, intervals * frames + 1, |state| {
        frame += 1;
        if let Some(matrices) = state.matrices.filter(|_| frame.is_multiple_of(frames)) {
            found.push((state.time / 60.0, matrices));
        }
    })?;
    let off = |matrices: &SMatrix<f64, 4, 9>| 100.0 * (matrices - truth).norm() / truth.norm();
    let at = |share: f64| found[((found.len() - 1) as f64 * share).round() as usize];
    let told = [1.0 / LONG, 0.1, 1.0].map(at);
    let told = told.map(|(minutes, matrices)| {
        format!("{} % after {} min", significant(off(&matrices), 2), significant(minutes, 2))
    });
    let panel = |title, columns| panel_of_entries(title, columns, &found, &truth);
    Ok(Drawing {
        name: "36-numbers".to_owned(),
        caption: format!(
            "The estimator (21) as printed over the first line pair of the flight bird, moved exactly: the 16 entries of A, the 16 of C and the 4 \
             of B by what they should be, once every {TURNS} turns ({interval:.2} s). Each comes to its value, and slowly: the 36 together are \
             off by {} (Frobenius norm, of that of the truth).",
            told.join(", ")
        ),
        data: data_of_entries(&found, &truth),
        figure: Figure {
            title: "The 36 numbers of equation 21 over exact lines of the flight bird".to_owned(),
            shares_legend: true,
            panels: vec![panel("A", 0..4), panel("C", 4..8), panel("B", 8..9)],
            columns: 3,
            panel_size: [330.0, 320.0],
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lyapunov_functions_of_the_figures_never_grow_over_exact_lines_but_for_the_steps() {
        for experiment in &EXPERIMENTS {
            let lines = ExactLines::of(experiment, SIZE).expect("lines");
            for (name, law) in &LAWS[..2] {
                let Course { states, summary } = course(&lines, *law, 4.0).expect("a course");
                assert!(summary.growth < 1e-6, "{} {name}: {summary:?}", experiment.title);
                let [first, last] = [summary.first, summary.last].map(|value| value.expect("a function"));
                assert!(last < 0.9 * first && states.len() == 40, "{} {name}: {summary:?}", experiment.title);
            }
        }
    }

    #[test]
    fn growth_is_told_of_the_steps_that_are_not_drawn_too() {
        let mut summary = Summary::default();
        let state = |lyapunov: f64, error: f64| LawState { time: 0.0, error, lyapunov: Some(lyapunov), matrices: None };
        [(2.0, 0.1), (1.0, 0.4), (1.5, 0.2), (1.0, 0.3)].iter().for_each(|(v, e)| summary.take(&state(*v, *e)));
        assert_eq!((summary.growth, summary.largest_error, summary.last_error), (0.25, 0.4, 0.3));
        assert_eq!(summary.row("x", "y"), ["x", "y", "2.0", "1.0", "2e-1", "0.40", "0.30"]);
        let mut falls = Summary::default();
        [2.0, 1.0, 1.0].iter().for_each(|v| falls.take(&state(*v, 0.0)));
        assert_eq!(falls.row("x", "y")[4], "never");
    }

    #[test]
    fn every_entry_of_the_36_is_of_one_kind_and_equal_to_the_others_of_it() {
        let truth = ExactLines::of(&PaperExperiment::FLIGHT_BIRD, SIZE).expect("lines").true_matrices();
        let kinds = kinds();
        assert_eq!(kinds.iter().map(|(_, entries)| entries.len()).sum::<usize>(), 36);
        for (name, entries) in &kinds {
            assert!(entries.iter().all(|entry| truth[*entry] == truth[entries[0]]), "{name}");
            assert_eq!(truth[entries[0]] == 0.0, *name == "0");
        }
    }
}
