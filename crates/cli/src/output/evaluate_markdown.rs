use std::io::{self, Write};

use freeform_experiments::monte_carlo::{Acquisition, MethodResult, Report, Statistics};

use super::evaluate_table::{Evaluated, decimals};

/// Tables for a document: all methods beside each other, then each in detail, then the acquisition.
pub(crate) fn write_evaluation_markdown(sink: &mut impl Write, evaluated: &Evaluated) -> io::Result<()> {
    let Evaluated { report, timing } = evaluated;
    let Report { shapes, runs, seed, .. } = report;
    writeln!(sink, "{} shapes ({}), {runs} runs each, seed {seed}.", shapes.len(), shapes.join(", "))?;
    if let Some(first) = report.evaluations.first() {
        writeln!(
            sink,
            "\n### RMSE over bound, by method\n\n(n): so many runs lost of {}.\n",
            first.methods[0].pooled.runs
        )?;
        let heads: Vec<_> = first.methods.iter().map(|result| result.method.name().to_owned()).collect();
        write_head(sink, &heads)?;
        for evaluation in &report.evaluations {
            write_row(sink, &evaluation.setting.name, evaluation.methods.iter().map(ratio_and_lost))?;
        }
        for (index, head) in heads.iter().enumerate() {
            writeln!(sink, "\n### {head}\n")?;
            let mut columns =
                vec!["RMSE / bound", "worst shape", "coverage", "bias / std. error", "lost", "frames rejected"];
            columns.extend(timing.then_some("us/frame"));
            write_head(sink, &columns.into_iter().map(str::to_owned).collect::<Vec<_>>())?;
            for evaluation in &report.evaluations {
                let result = &evaluation.methods[index];
                write_row(sink, &evaluation.setting.name, details(result, evaluated).into_iter())?;
            }
        }
    }
    if let Some(first) = report.acquisitions.first() {
        let runs = first.methods[0].pooled.runs;
        writeln!(sink, "\n### Share of second poses found\n\n(worst shape), of {runs} runs.\n")?;
        let heads: Vec<_> = first.methods.iter().map(|result| result.method.name().to_owned()).collect();
        write_head(sink, &heads)?;
        for acquisition in &report.acquisitions {
            write_row(sink, &acquisition.setting.name, found(acquisition, report))?;
        }
    }
    Ok(())
}

fn ratio_and_lost(result: &MethodResult<Statistics>) -> String {
    let ratio = decimals(result.pooled.ratio, 2);
    if result.pooled.lost > 0 { format!("{ratio} ({})", result.pooled.lost) } else { ratio }
}

fn details(result: &MethodResult<Statistics>, Evaluated { report, timing }: &Evaluated) -> Vec<String> {
    let pooled = &result.pooled;
    let shapes = result.shapes.iter().zip(&report.shapes);
    let worst = shapes
        .filter_map(|(statistics, name)| Some((statistics.ratio?, name)))
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map_or_else(|| "-".to_owned(), |(ratio, name)| format!("{ratio:.2} {name}"));
    let mut cells = vec![
        decimals(pooled.ratio, 2),
        worst,
        decimals(pooled.coverage, 3),
        decimals(pooled.bias_in_errors, 2),
        pooled.lost.to_string(),
        decimals(pooled.frames_rejected, 3),
    ];
    cells.extend(timing.then(|| decimals(pooled.microseconds_per_frame, 0)));
    cells
}

fn found<'a>(acquisition: &'a Acquisition, report: &'a Report) -> impl Iterator<Item = String> + 'a {
    acquisition.methods.iter().map(|result| {
        let worst = result.shapes.iter().zip(&report.shapes).min_by(|a, b| a.0.share().total_cmp(&b.0.share()));
        let worst = worst.map_or_else(String::new, |(found, name)| format!(" ({:.3} {name})", found.share()));
        format!("{:.4}{worst}", result.pooled.share())
    })
}

fn write_head(sink: &mut impl Write, columns: &[String]) -> io::Result<()> {
    writeln!(sink, "| setting | {} |", columns.join(" | "))?;
    writeln!(sink, "|{}", "---|".repeat(columns.len() + 1))
}

/// A cell must not end where a name holds a bar.
fn write_row(sink: &mut impl Write, name: &str, cells: impl Iterator<Item = String>) -> io::Result<()> {
    let cells: Vec<_> = cells.map(|cell| cell.replace('|', "\\|")).collect();
    writeln!(sink, "| {name} | {} |", cells.join(" | "))
}
