use std::io::{self, Write};

use super::aligned::write_aligned;
use super::number::{short, significant};
use crate::commands::{Acquisition, Evaluation, Found, Report, Setting, Statistics};

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
pub(super) const POOLED: &str = "pooled";
/// Under which name the parameters appear together.
pub(super) const ALL: &str = "all";

/// One table per setting.
pub(crate) fn write_evaluation_table(sink: &mut impl Write, report: &Report) -> io::Result<()> {
    let mut first = true;
    for evaluation in &report.evaluations {
        if !std::mem::take(&mut first) {
            writeln!(sink)?;
        }
        writeln!(sink, "{}; {} runs", describe(&evaluation.setting), report.runs)?;
        write_aligned(sink, &COLUMNS[..if report.timing { 12 } else { 11 }], &rows(evaluation, report), &[0, 1, 2])?;
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
    let Setting { model, frames, fps, noise, points, .. } = setting;
    let corruption = corruption(setting.occlusion, setting.outliers, setting.wrong_frames);
    format!("{model} motion, {frames} frames at {fps} frames/s, noise {noise}, {points} points{corruption}")
}

fn corruption(occlusion: f64, outliers: f64, wrong_frames: f64) -> String {
    let parts = [(occlusion, "of the outline missing"), (outliers, "outliers"), (wrong_frames, "wrong frames")];
    let present = parts.iter().filter(|(share, _)| *share > 0.0);
    present.map(|(share, what)| format!(", {} % {what}", short(100.0 * share))).collect()
}

/// Names and statistics of every shape, then of all together where there are several.
pub(super) fn by_shape<'a>(
    names: &'a [String],
    shapes: &'a [Statistics],
    pooled: &'a Statistics,
) -> impl Iterator<Item = (&'a str, &'a Statistics)> {
    let all = (names.len() > 1).then_some((POOLED, pooled));
    names.iter().map(String::as_str).zip(shapes).chain(all)
}

fn rows(evaluation: &Evaluation, report: &Report) -> Vec<Vec<String>> {
    let mut rows = Vec::new();
    for result in &evaluation.methods {
        for (shape, statistics) in by_shape(&report.shapes, &result.shapes, &result.pooled) {
            for (name, p) in evaluation.setting.model.parameter_names().iter().zip(&statistics.parameters) {
                let mut row = vec![result.method.name().to_owned(), shape.to_owned(), (*name).to_owned()];
                row.extend([p.rmse, p.bound].map(|value| number(value, 3)));
                row.push(decimals(p.ratio, 2));
                row.extend([p.bias, p.bias_standard_error].map(|value| number(value, 2)));
                row.push(decimals(p.coverage, 3));
                row.resize(if report.timing { 12 } else { 11 }, String::new());
                rows.push(row);
            }
            let mut row = vec![result.method.name().to_owned(), shape.to_owned(), ALL.to_owned()];
            row.extend([String::new(), String::new(), decimals(statistics.ratio, 2), String::new(), String::new()]);
            row.push(decimals(statistics.coverage, 3));
            row.push(format!("{} of {}", statistics.lost, statistics.runs));
            row.push(decimals(statistics.frames_rejected, 3));
            row.extend(report.timing.then(|| decimals(statistics.microseconds_per_frame, 0)));
            rows.push(row);
        }
    }
    rows
}

fn acquisition_rows(acquisition: &Acquisition, report: &Report) -> Vec<Vec<String>> {
    let mut rows = Vec::new();
    for (method, shapes) in &acquisition.methods {
        let pooled = (shapes.len() > 1).then(|| (POOLED, Found::pooled(shapes)));
        let named = report.shapes.iter().map(String::as_str).zip(shapes.iter().copied());
        for (shape, found) in named.chain(pooled) {
            let share = decimals(Some(found.share()), 3);
            rows.push(vec![
                method.name().to_owned(),
                shape.to_owned(),
                found.found.to_string(),
                found.runs.to_string(),
                share,
            ]);
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
