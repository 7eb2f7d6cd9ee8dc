//! The stress suite as text.
use std::io::{self, Write};

use freeform_experiments::stress::{Class, Kind, NOTES, Quantity, StressReport, Summary};
use freeform_motion::significant;

use super::aligned::write_aligned;
use super::evaluate_table::decimals;

/// Heads of the table; those of a quantity are preceded by its name.
const COLUMNS: [&str; 16] = [
    "class",
    "kind",
    "runs",
    "silent wrong",
    "off",
    "unstated",
    "warned",
    "rejected",
    "omega unstated",
    "omega held",
    "omega median",
    "b unstated",
    "b held",
    "b median",
    "v held",
    "v median",
];

/// What the columns are.
const LEGEND: [&str; 6] = [
    "silent wrong: share of the runs in which a stated value was more than 4 standard deviations off, no warning questioned it, and no alias \
     named the true angular velocity",
    "off: the same, told or not; unstated: share of the runs in which omega, b or (round only) v was not stated",
    "warned: share of the runs with a warning that questions the values; rejected: share of the frames that were not used",
    "omega, b, v: angular velocity, velocity at the origin, velocity of the middle; all at the last frame",
    "held: share of the stated values whose 95 % interval contains the truth",
    "median: median error in standard deviations, 0.67 where all is well",
];

/// One line for each kind, then for each class, then for all.
pub(crate) fn write_stress_table(sink: &mut impl Write, report: &StressReport) -> io::Result<()> {
    let (kinds, totals) = rows(report);
    let blank = vec![String::new(); COLUMNS.len()];
    let rows: Vec<_> = kinds.into_iter().chain([blank]).chain(totals).collect();
    write_aligned(sink, &COLUMNS, &rows, &[0, 1])?;
    writeln!(sink)?;
    LEGEND.iter().try_for_each(|line| writeln!(sink, "{line}"))?;
    writeln!(sink, "{}", notes())
}

/// Writes the figures as Markdown, the classes first.
pub(crate) fn write_stress_markdown(sink: &mut impl Write, report: &StressReport) -> io::Result<()> {
    let (kinds, totals) = rows(report);
    let line =
        |cells: &mut dyn Iterator<Item = &str>| cells.fold("|".to_owned(), |line, cell| line + " " + cell + " |");
    for rows in [totals, kinds] {
        writeln!(sink, "{}", line(&mut COLUMNS.into_iter()))?;
        writeln!(
            sink,
            "{}",
            line(&mut COLUMNS.iter().map(|head| if *head == "class" || *head == "kind" { "---" } else { "---:" }))
        )?;
        rows.iter().try_for_each(|row| writeln!(sink, "{}", line(&mut row.iter().map(String::as_str))))?;
        writeln!(sink)?;
    }
    LEGEND.iter().try_for_each(|line| writeln!(sink, "- {line}"))?;
    let first = report.frames.map(|frames| format!(", at most the first {frames} frames of each")).unwrap_or_default();
    writeln!(sink, "- {}\n\n{} runs of each kind{first}, seed {}.", notes(), report.runs, report.seed)
}

/// The kinds with what they are.
pub(crate) fn write_kinds(sink: &mut impl Write, kinds: &[Kind]) -> io::Result<()> {
    let rows: Vec<Vec<String>> =
        kinds.iter().map(|kind| vec![kind.class.to_string(), kind.name.clone(), kind.explanation.clone()]).collect();
    write_aligned(sink, &["class", "kind", "explanation"], &rows, &[0, 1, 2])
}

/// Writes the kinds as Markdown, class by class.
pub(crate) fn write_kinds_markdown(sink: &mut impl Write, kinds: &[Kind]) -> io::Result<()> {
    for class in Class::ALL {
        let of_class: Vec<&Kind> = kinds.iter().filter(|kind| kind.class == class).collect();
        if of_class.is_empty() {
            continue;
        }
        writeln!(sink, "### {class}: {}\n\n| kind | what it is |\n| --- | --- |", class.description())?;
        of_class.iter().try_for_each(|kind| writeln!(sink, "| {} | {} |", kind.name, kind.explanation))?;
        writeln!(sink)?;
    }
    Ok(())
}

fn notes() -> String {
    format!("warnings that do not question a stated value and do not count: {}", NOTES.join(", "))
}

/// Rows of the kinds, and of the classes and all.
fn rows(report: &StressReport) -> (Vec<Vec<String>>, Vec<Vec<String>>) {
    let kinds = report.kinds.iter().map(|of| row(of.kind.class.name(), &of.kind.name, &of.summary)).collect();
    let classes = report.classes.iter().map(|(class, summary)| row(class.name(), "all", summary));
    (kinds, classes.chain([row("all", "all", &report.overall)]).collect())
}

fn row(class: &str, kind: &str, summary: &Summary) -> Vec<String> {
    let percent = |share: Option<f64>| share.map_or_else(|| "-".to_owned(), |share| format!("{:.1} %", 100.0 * share));
    let mut row = vec![class.to_owned(), kind.to_owned(), summary.runs.to_string()];
    row.extend(
        [summary.silent_wrong, summary.off, summary.unstated, summary.warned, summary.frames_rejected].map(percent),
    );
    for quantity in Quantity::ALL {
        let of = summary.quantities.iter().find(|of| of.quantity == quantity);
        if quantity != Quantity::V {
            row.push(percent(of.and_then(|of| of.unstated)));
        }
        row.push(decimals(of.and_then(|of| of.coverage), 2));
        row.push(
            of.and_then(|of| of.median_deviations).map_or_else(|| "-".to_owned(), |median| significant(median, 2)),
        );
    }
    row
}
