use std::fmt::Write as _;
use std::io;

use freeform_experiments::figure::Panel;
use freeform_motion::tracker::{FrameRanges, ObjectResult};

use super::figures::{fit_panel, parameter_panels, residual_panels};
use super::identify_table::{COLUMNS, parameter_rows};
use super::player::{Player, write_script};
use super::pose_figures::{deviation_panels, pose_panels};
use super::velocity::meaning_of_v;
use crate::bound_found::{NoBound, bound_found};
use crate::history::{Histories, History, OBJECTS_PLAYED, OBJECTS_WITH_POSES};
use crate::left_out::LeftOut;
use crate::meaning_of_b::MeaningOfB;
use crate::plot::{escape, panel_svg};
use crate::truth::Truth;

/// Number of left-out pictures that are listed with their reasons.
const PICTURES_TOLD: usize = 10;

/// What a reader should know of the figures of a pose, of the parameters, of their standard deviations, and of the bound.
const POSES: &str = "The turn since the first frame, and the place of the middle of the first outline. The true values lie within the \
                     bands in 95 of 100 cases. There is no line where nothing is stated.";
const PARAMETERS: &str =
    "The parameters of the motion as they were known from the frames up to each time, with 95 % bands.";
const DEVIATIONS: &str = "How far the parameters are likely to be off, from the frames up to each time: the true value is within 1.96 \
                          standard deviations in 95 of 100 cases.";
const BOUND: &str = "The dashed line is the Cramer-Rao bound: the least standard deviation that any unbiased method can have, if the outline \
                     is known, the motion is constant and the errors of the points are independent of each other. It is computed for what was \
                     found here: this motion, this outline in these places, the points that were seen, and their noise in every frame. A line well \
                     above it has errors that depend on each other, an outline that had to be learnt, or doubts whether the motion is constant.";

const STYLE: &str = include_str!("report.css");

/// What stands in a report.
#[derive(Debug)]
pub(crate) struct Report<'a> {
    pub(crate) title: String,
    /// The command as it was given.
    pub(crate) command: String,
    pub(crate) settings: Vec<(&'static str, String)>,
    /// Unit and origin of the velocity b.
    pub(crate) meaning_of_b: MeaningOfB,
    /// One for each method.
    pub(crate) findings: Vec<Findings<'a>>,
    pub(crate) truth: Option<&'a Truth>,
    /// Why no motion was found, where none was.
    pub(crate) no_motion: Option<&'a str>,
    /// What ended the reading before the end of the input.
    pub(crate) read_error: Option<&'a str>,
    pub(crate) left_out: &'a LeftOut,
}

/// What one method found.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Findings<'a> {
    pub(crate) results: &'a [ObjectResult],
    pub(crate) histories: &'a Histories,
}

/// Writes a page that needs nothing but itself, one object after the other.
pub(crate) fn write_report(sink: &mut impl io::Write, report: &Report<'_>) -> io::Result<()> {
    let title = escape(&report.title);
    let [before, after] = around_body(&title);
    sink.write_all(before.as_bytes())?;
    let mut body = format!("<h1>{title}</h1>\n");
    if let Some(first) = report.findings.first() {
        let _ = writeln!(body, "<p class=\"soft\">{}</p>", escape(&summary(first.results)));
        if let Some(left_out) = first.histories.left_out(first.results.len()) {
            let _ = writeln!(body, "<p class=\"soft\">Of many: {left_out}.</p>");
        }
    }
    if let Some(reason) = report.no_motion {
        let _ = writeln!(body, "<p class=\"alert\">No motion was identified. {}</p>", escape(reason));
    }
    if let Some(error) = report.read_error {
        let error = escape(error);
        let _ = writeln!(body, "<p class=\"alert\">The input could not be read to its end: {error}</p>");
    }
    let mut players = 0;
    for Findings { results, histories } in &report.findings {
        for result in *results {
            let history = histories.of(&result.object);
            write_object(&mut body, result, history, report, &mut players);
            sink.write_all(body.as_bytes())?;
            body.clear();
        }
        if results.len() > OBJECTS_PLAYED {
            let _ = writeln!(
                body,
                "<p class=\"soft\">The first {OBJECTS_PLAYED} objects are shown frame by frame, the first {OBJECTS_WITH_POSES} with \
                 positions and standard deviations over time. --trajectory writes those of all {}.</p>",
                results.len()
            );
        }
    }
    write_left_out(&mut body, report.left_out);
    write_settings(&mut body, &report.settings, &report.command);
    if players > 0 {
        write_script(&mut body);
    }
    sink.write_all(body.as_bytes())?;
    sink.write_all(after.as_bytes())
}

/// Pictures without an outline.
fn write_left_out(body: &mut String, left_out: &LeftOut) {
    let LeftOut { count, pictures, .. } = left_out;
    if *count == 0 {
        return;
    }
    let _ = writeln!(body, "<h2>Pictures without an outline: {count}</h2>\n<ul>");
    let (told, others) = pictures.split_at(pictures.len().min(PICTURES_TOLD));
    told.iter().for_each(|(_, reason)| {
        let _ = writeln!(body, "<li>{}</li>", escape(reason));
    });
    let frames: FrameRanges = others.iter().map(|(frame, _)| *frame).collect();
    let more = count - told.len() as u64;
    let _ = if more > 0 { writeln!(body, "<li>{more} more: {frames}</li>\n</ul>") } else { writeln!(body, "</ul>") };
}

/// The settings as a table and the command as it was given.
pub(super) fn write_settings(body: &mut String, settings: &[(&'static str, String)], command: &str) {
    body.push_str("<h2>Settings</h2>\n<div class=\"scroll\"><table class=\"words\">\n");
    for (name, value) in settings {
        let _ = writeln!(body, "<tr><th>{}</th><td>{}</td></tr>", escape(name), escape(value));
    }
    let version = env!("CARGO_PKG_VERSION");
    let _ = writeln!(body, "<tr><th>Version</th><td>freeform {version}</td></tr>\n</table></div>");
    let _ = writeln!(body, "<h2>Command</h2>\n<pre>{}</pre>", escape(command));
}

/// A whole document of an escaped title and a body.
pub(super) fn document(title: &str, body: &str) -> String {
    let [before, after] = around_body(title);
    before + body + &after
}

/// What stands before the body of a document, and after it.
fn around_body(title: &str) -> [String; 2] {
    let before = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n"
    );
    [before, "</body>\n</html>\n".to_owned()]
}

fn summary(results: &[ObjectResult]) -> String {
    let frames: usize = results.iter().map(|result| result.frames).sum();
    let rejected: usize = results.iter().map(|result| result.frames_rejected).sum();
    format!("{} object(s), {frames} frames, {rejected} rejected", results.len())
}

fn write_object(
    body: &mut String,
    result: &ObjectResult,
    history: Option<&History>,
    report: &Report<'_>,
    players: &mut usize,
) {
    let truth = report.truth;
    let object = escape(&result.object);
    let _ = writeln!(body, "<h2>Object {object}: {} motion, {} method</h2>", result.motion, result.method.name());
    let rows = parameter_rows(result, truth, &report.meaning_of_b);
    let count = rows.first().map_or(0, Vec::len);
    body.push_str("<div class=\"scroll\"><table>\n");
    write_row(body, "th", COLUMNS.iter().take(count).copied());
    rows.iter().for_each(|row| write_row(body, "td", row.iter().map(String::as_str)));
    let b = &report.meaning_of_b;
    let _ = writeln!(body, "</table></div>\n<p class=\"soft\">b: {}</p>", escape(&b.to_string()));
    if let Some(velocity) = &result.velocity {
        let _ = writeln!(body, "<p class=\"soft\">{}</p>", escape(&meaning_of_v(velocity)));
    }
    if !result.warnings.is_empty() {
        body.push_str("<p class=\"alert\">Warnings</p>\n<ul>\n");
        result.warnings.iter().for_each(|warning| {
            let _ = writeln!(body, "<li>{}</li>", escape(&warning.to_string()));
        });
        body.push_str("</ul>\n");
    }
    let Some(history) = history else { return };
    let scale = report.meaning_of_b.scale;
    let model = result.motion.model();
    if let Some((playback, model)) = history.playback.as_ref().zip(model) {
        let player = Player {
            number: *players,
            object: &result.object,
            playback,
            frames: result.frames,
            model,
            b: &report.meaning_of_b,
        };
        *players += usize::from(player.write(body));
    }
    if let Some((poses, model)) = history.poses.as_ref().zip(model) {
        let panels = pose_panels(poses, history.start, model, &report.meaning_of_b);
        write_panels(body, "Where it was", POSES, &panels);
    }
    write_panels(body, "How it moved", PARAMETERS, &parameter_panels(history, "", result.motion, truth));
    if history.poses.is_some() {
        let bound = match &history.playback {
            Some(playback) => bound_found(result, playback, scale).map_err(NoBound::reason),
            None => Err("it is computed for the first objects of a page"),
        };
        let text = match &bound {
            Ok(_) => format!("{DEVIATIONS} {BOUND}"),
            Err(reason) => {
                format!("{DEVIATIONS} The least possible standard deviation (Cramer-Rao bound) is not drawn: {reason}.")
            }
        };
        let panels = deviation_panels(history, result.motion, bound.as_deref().unwrap_or_default());
        write_panels(body, "How well that is known", &text, &panels);
    }
    let mut panels = residual_panels(history);
    if let Some(latest) = &history.latest {
        let title = format!("Frame {}, the last one used", latest.0.frame);
        panels.push(fit_panel(title, std::slice::from_ref(latest)));
    }
    write_panels(body, "How well the frames fit", "", &panels);
    if !history.rejected.is_empty() {
        let frames: FrameRanges = history.rejected.iter().map(|(frame, _)| *frame).collect();
        let _ = writeln!(body, "<p>Rejected frames: {frames}</p>");
    }
}

/// Panels below a heading, with what a reader should know of them.
fn write_panels(body: &mut String, heading: &str, text: &str, panels: &[Panel]) {
    if panels.is_empty() {
        return;
    }
    let _ = writeln!(body, "<h3>{heading}</h3>");
    if !text.is_empty() {
        let _ = writeln!(body, "<p class=\"soft\">{}</p>", escape(text));
    }
    body.push_str("<div class=\"panels\">\n");
    for panel in panels {
        let height = if panel.view.is_some() { 400.0 } else { 300.0 };
        let _ = writeln!(body, "<div>{}</div>", panel_svg(panel, 400.0, height));
    }
    body.push_str("</div>\n");
}

fn write_row<'a>(body: &mut String, tag: &str, cells: impl Iterator<Item = &'a str>) {
    let cells: String = cells.map(|cell| format!("<{tag}>{}</{tag}>", escape(cell))).collect();
    let _ = writeln!(body, "<tr>{cells}</tr>");
}
