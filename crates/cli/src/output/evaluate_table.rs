use std::io::{self, Write};

use freeform_motion::{short, significant};

use freeform_experiments::monte_carlo::{Acquisition, Evaluation, Report, Setting};

use super::aligned::write_aligned;

const COLUMNS: [&str; 12] = [
    "method",
    "shape",
    "parameter",
    "RMSE",
    "bound",
    "ratio",
    "bias",
    "std.err.",
    "coverage",
    "lost",
    "rejected",
    "us/frame",
];

/// Under which name the shapes appear together.
const POOLED: &str = "pooled";
/// Under which name the parameters appear together.
const ALL: &str = "all";

/// The result of `evaluate`, and how it is printed.
#[derive(Debug)]
pub(crate) struct Evaluated {
    pub(crate) report: Report,
    /// Whether times are printed.
    pub(crate) timing: bool,
}

/// One table per setting.
pub(crate) fn write_evaluation_table(sink: &mut impl Write, evaluated: &Evaluated) -> io::Result<()> {
    let Evaluated { report, timing } = evaluated;
    let mut first = true;
    for evaluation in &report.evaluations {
        if !std::mem::take(&mut first) {
            writeln!(sink)?;
        }
        writeln!(sink, "{}; {} runs", describe(&evaluation.setting), report.runs)?;
        write_aligned(sink, &COLUMNS[..column_count(*timing)], &rows(evaluation, evaluated), &[0, 1, 2])?;
    }
    for acquisition in &report.acquisitions {
        if !std::mem::take(&mut first) {
            writeln!(sink)?;
        }
        let setting = &acquisition.setting;
        writeln!(
            sink,
            "acquisition, {} motion, turns within 60 degrees, shifts up to half the size, noise {}, {} points{}",
            setting.model,
            setting.noise,
            setting.points,
            corruption(setting.occlusion, setting.outliers, 0.0)
        )?;
        let rows = acquisition_rows(acquisition, report);
        write_aligned(sink, &["method", "shape", "found", "runs", "share"], &rows, &[0, 1])?;
    }
    Ok(())
}

/// A setting in words.
fn describe(setting: &Setting) -> String {
    let Setting { frames, fps, noise, points, .. } = setting;
    let family = setting.family();
    let corruption = corruption(setting.occlusion, setting.outliers, setting.wrong_frames);
    format!("{family} motion, {frames} frames at {fps} frames/s, noise {noise}, {points} points{corruption}")
}

fn corruption(occlusion: f64, outliers: f64, wrong_frames: f64) -> String {
    let parts = [(occlusion, "of the outline missing"), (outliers, "outliers"), (wrong_frames, "wrong frames")];
    let present = parts.iter().filter(|(share, _)| *share > 0.0);
    present.map(|(share, what)| format!(", {} % {what}", short(100.0 * share))).collect()
}

fn column_count(timing: bool) -> usize {
    if timing { COLUMNS.len() } else { COLUMNS.len() - 1 }
}

fn rows(evaluation: &Evaluation, Evaluated { report, timing }: &Evaluated) -> Vec<Vec<String>> {
    let mut rows = Vec::new();
    for result in &evaluation.methods {
        for (shape, statistics) in result.by_shape(&report.shapes, POOLED) {
            let start = |parameter: &str| [result.method.name(), shape, parameter].map(str::to_owned).to_vec();
            for (name, p) in evaluation.setting.parameter_names().iter().zip(&statistics.parameters) {
                let mut row = start(name);
                row.extend([p.rmse, p.bound].map(|value| number(value, 3)));
                row.push(decimals(p.ratio, 2));
                row.extend([p.bias, p.bias_standard_error].map(|value| number(value, 2)));
                row.push(decimals(p.coverage, 3));
                row.resize(column_count(*timing), String::new());
                rows.push(row);
            }
            let mut row = start(ALL);
            row.extend([String::new(), String::new(), decimals(statistics.ratio, 2), String::new(), String::new()]);
            row.push(decimals(statistics.coverage, 3));
            row.push(format!("{} of {}", statistics.lost, statistics.runs));
            row.push(decimals(statistics.frames_rejected, 3));
            row.extend(timing.then(|| decimals(statistics.microseconds_per_frame, 0)));
            rows.push(row);
        }
    }
    rows
}

fn acquisition_rows(acquisition: &Acquisition, report: &Report) -> Vec<Vec<String>> {
    let mut rows = Vec::new();
    for result in &acquisition.methods {
        for (shape, found) in result.by_shape(&report.shapes, POOLED) {
            let mut row = [result.method.name(), shape].map(str::to_owned).to_vec();
            row.extend([found.found, found.runs].map(|count| count.to_string()));
            row.push(decimals(Some(found.share()), 3));
            rows.push(row);
        }
    }
    rows
}

fn number(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| "-".to_owned(), |value| significant(value, digits))
}

/// With so many decimals, `-` where there is no value.
pub(super) fn decimals(value: Option<f64>, decimals: usize) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:.decimals$}"))
}
