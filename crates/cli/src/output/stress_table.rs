//! The stress suite as text.
use std::io::{self, Write};

use freeform_experiments::stress::{Class, Kind, NOTES, PoseSummary, Quantity, StressReport, Summary};
use freeform_motion::riccati::MotionModel;
use freeform_motion::significant;

use super::aligned::write_aligned;
use super::evaluate_table::decimals;

/// Heads of the columns before those of the quantities.
const COLUMNS: [&str; 8] = ["class", "kind", "runs", "silent wrong", "off", "unstated", "warned", "rejected"];

/// Heads of the columns of the poses, where any are judged.
const POSE_COLUMNS: [&str; 4] = ["poses silent", "poses off", "turn held", "place held"];

/// What the columns are.
const LEGEND: [&str; 7] = [
    "silent wrong: share of the runs in which a stated value was more than 4 standard deviations off, no warning questioned it, and no alias \
     named the true angular velocity",
    "off: the same, told or not; unstated: share of the runs in which a parameter or (round only) v was not stated",
    "warned: share of the runs with a warning that questions the values; rejected: share of the frames that were not used",
    "sigma, omega, a: growth, angular velocity, a1 to a4; b, v: velocity at the origin, of the middle; all at the last frame",
    "poses silent, poses off: share of the runs with a pose, in any frame that was used, that was more than 5 standard deviations off, without a \
     warning, with or without; turn held, place held: of the poses",
    "held: share of the stated values whose 95 % interval contains the truth",
    "median: median error in standard deviations, 0.67 where all is well",
];

/// One line for each kind, then for each class, then for all.
pub(crate) fn write_stress_table(sink: &mut impl Write, report: &StressReport) -> io::Result<()> {
    let (kinds, totals) = rows(report);
    let heads = heads(report);
    let blank = vec![String::new(); heads.len()];
    let rows: Vec<_> = kinds.into_iter().chain([blank]).chain(totals).collect();
    write_aligned(sink, &heads.iter().map(String::as_str).collect::<Vec<_>>(), &rows, &[0, 1])?;
    writeln!(sink)?;
    LEGEND.iter().try_for_each(|line| writeln!(sink, "{line}"))?;
    writeln!(sink, "{}", notes())
}

/// Writes the figures as Markdown, the classes first.
pub(crate) fn write_stress_markdown(sink: &mut impl Write, report: &StressReport) -> io::Result<()> {
    let (kinds, totals) = rows(report);
    let line =
        |cells: &mut dyn Iterator<Item = &str>| cells.fold("|".to_owned(), |line, cell| line + " " + cell + " |");
    let heads = heads(report);
    let aligned = |column: usize| if column < 2 { "---" } else { "---:" };
    for rows in [totals, kinds] {
        writeln!(sink, "{}", line(&mut heads.iter().map(String::as_str)))?;
        writeln!(sink, "{}", line(&mut (0..heads.len()).map(aligned)))?;
        rows.iter().try_for_each(|row| writeln!(sink, "{}", line(&mut row.iter().map(String::as_str))))?;
        writeln!(sink)?;
    }
    LEGEND.iter().try_for_each(|line| writeln!(sink, "- {line}"))?;
    let first = report.frames.map(|frames| format!(", at most the first {frames} frames of each")).unwrap_or_default();
    let motion = if report.model == MotionModel::Rigid { String::new() } else { format!(", {} motion", report.model) };
    writeln!(sink, "- {}\n\n{} runs of each kind{motion}{first}, seed {}.", notes(), report.runs, report.seed)
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

/// Heads of the columns, of the quantities that are judged in any run.
fn heads(report: &StressReport) -> Vec<String> {
    let of_quantity = |quantity: Quantity| {
        let unstated = (quantity != Quantity::V).then(|| format!("{quantity} unstated"));
        unstated.into_iter().chain([format!("{quantity} held"), format!("{quantity} median")])
    };
    let of_poses = report.overall.poses.iter().flat_map(|_| POSE_COLUMNS.map(str::to_owned));
    COLUMNS.map(str::to_owned).into_iter().chain(judged(report).flat_map(of_quantity)).chain(of_poses).collect()
}

fn judged(report: &StressReport) -> impl Iterator<Item = Quantity> {
    report.overall.quantities.iter().map(|of| of.quantity)
}

/// Rows of the kinds, and of the classes and all.
fn rows(report: &StressReport) -> (Vec<Vec<String>>, Vec<Vec<String>>) {
    let quantities: Vec<Quantity> = judged(report).collect();
    let has_poses = report.overall.poses.is_some();
    let row = |class: &str, kind: &str, summary: &Summary| {
        let mut cells = row(class, kind, summary, &quantities);
        if has_poses {
            cells.extend(pose_cells(summary.poses.as_ref()));
        }
        cells
    };
    let kinds = report.kinds.iter().map(|of| row(of.kind.class.name(), &of.kind.name, &of.summary)).collect();
    let classes = report.classes.iter().map(|(class, summary)| row(class.name(), "all", summary));
    (kinds, classes.chain([row("all", "all", &report.overall)]).collect())
}

fn pose_cells(poses: Option<&PoseSummary>) -> [String; 4] {
    let [silent, off] = [poses.and_then(|poses| poses.silent_wrong), poses.and_then(|poses| poses.off)].map(percent);
    let held = [poses.and_then(|poses| poses.turn_coverage), poses.and_then(|poses| poses.place_coverage)];
    let [turn, place] = held.map(|share| decimals(share, 2));
    [silent, off, turn, place]
}

fn percent(share: Option<f64>) -> String {
    share.map_or_else(|| "-".to_owned(), |share| format!("{:.1} %", 100.0 * share))
}

fn row(class: &str, kind: &str, summary: &Summary, quantities: &[Quantity]) -> Vec<String> {
    let mut row = vec![class.to_owned(), kind.to_owned(), summary.runs.to_string()];
    row.extend(
        [summary.silent_wrong, summary.off, summary.unstated, summary.warned, summary.frames_rejected].map(percent),
    );
    for quantity in quantities {
        let of = summary.quantities.iter().find(|of| of.quantity == *quantity);
        if *quantity != Quantity::V {
            row.push(percent(of.and_then(|of| of.unstated)));
        }
        row.push(decimals(of.and_then(|of| of.coverage), 2));
        row.push(
            of.and_then(|of| of.median_deviations).map_or_else(|| "-".to_owned(), |median| significant(median, 2)),
        );
    }
    row
}
