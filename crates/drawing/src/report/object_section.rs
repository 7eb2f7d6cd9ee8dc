//! What a report says of one object.
use std::fmt::Write as _;

use freeform_motion::Truth;
use freeform_motion::tracker::{FrameRanges, Method, ObjectResult};

use super::bound_found::{NoBound, bound_found};
use super::figures::{fit_panel, parameter_panels, residual_panels};
use super::meaning_of_b::MeaningOfB;
use super::parameter_table::{PARAMETER_COLUMNS, meaning_of_v, parameter_rows};
use super::player::Player;
use super::pose_figures::{deviation_panels, pose_panels};
use crate::figure::{Look, Panel};
use crate::history::History;
use crate::plot::{escape, panel_svg};

/// What a reader should know of the figures of a pose, of the parameters, of their standard deviations, and of the bound.
const POSES: &str = "The turn since the first frame, and the place of the middle of the first outline. The true values lie within the \
                     bands in 95 of 100 cases; bands that are far wider than most go beyond the figure.";
const PARAMETERS: &str = "The parameters of the motion as they were known from the frames up to each time";
const TO_THE_END: &str = "The time goes to the end of the recording. Where nothing is stated there is no line, and the figure is grey, but for a \
                          single frame at either end.";
const DEVIATIONS: &str = "How far the parameters are likely to be off, from the frames up to each time: the true value is within 1.96 \
                          standard deviations in 95 of 100 cases.";
const BOUND: &str = "The dashed line is the Cramer-Rao bound: the least standard deviation that any unbiased method can have, if the outline \
                     is known, the motion is constant and the errors of the points are independent of each other. It is computed for what was \
                     found here: this motion, this outline in these places, the points that were seen, and their noise in every frame. A line well \
                     above it has errors that depend on each other, an outline that had to be learnt, or doubts whether the motion is constant.";

/// One object of a report.
#[derive(Debug, Clone, Copy)]
pub(super) struct ObjectSection<'a> {
    pub(super) result: &'a ObjectResult,
    /// What was found of it over time, if that was kept.
    pub(super) history: Option<&'a History>,
    pub(super) truth: Option<&'a Truth>,
    pub(super) b: &'a MeaningOfB,
}

impl ObjectSection<'_> {
    /// Writes it; `players` counts those of the page.
    pub(super) fn write(&self, body: &mut String, players: &mut usize) {
        let Self { result, history, .. } = *self;
        let object = escape(&result.object);
        let _ = writeln!(body, "<h2>Object {object}: {} motion, {} method</h2>", result.motion, result.method.name());
        self.write_parameters(body);
        self.write_warnings(body);
        let Some(history) = history else { return };
        self.write_player(body, history, players);
        self.write_poses(body, history);
        let panels = parameter_panels(history, "", result.motion, self.truth, self.b);
        let bands = match result.method {
            Method::Filter => ", with 95 % bands.",
            Method::Adaptive => ". The adaptive method gives no bands.",
        };
        write_panels(body, "How it moved", &format!("{PARAMETERS}{bands} {TO_THE_END}"), &panels);
        self.write_deviations(body, history);
        write_residuals(body, history, self.b);
    }

    fn write_parameters(&self, body: &mut String) {
        let rows = parameter_rows(self.result, self.truth, self.b);
        let count = rows.first().map_or(0, Vec::len);
        body.push_str("<div class=\"scroll\"><table>\n");
        write_row(body, "th", PARAMETER_COLUMNS.iter().take(count).copied());
        rows.iter().for_each(|row| write_row(body, "td", row.iter().map(String::as_str)));
        let _ = writeln!(body, "</table></div>\n<p class=\"soft\">b: {}</p>", escape(&self.b.to_string()));
        if let Some(velocity) = &self.result.velocity {
            let _ = writeln!(body, "<p class=\"soft\">{}</p>", escape(&meaning_of_v(velocity)));
        }
    }

    fn write_warnings(&self, body: &mut String) {
        if self.result.warnings.is_empty() {
            return;
        }
        body.push_str("<p class=\"alert\">Warnings</p>\n<ul>\n");
        for warning in &self.result.warnings {
            let _ =
                writeln!(body, "<li><code>warning[{}]</code>: {}</li>", warning.code(), escape(&warning.to_string()));
        }
        body.push_str("</ul>\n");
    }

    fn write_player(&self, body: &mut String, history: &History, players: &mut usize) {
        let Some((playback, model)) = history.playback.as_ref().zip(self.result.motion.model()) else { return };
        let Self { result, b, .. } = *self;
        let player = Player { number: *players, object: &result.object, playback, frames: result.frames, model, b };
        *players += usize::from(player.write(body));
    }

    fn write_poses(&self, body: &mut String, history: &History) {
        if let Some((poses, model)) = history.poses.as_ref().zip(self.result.motion.model()) {
            write_panels(
                body,
                "Where it was",
                &format!("{POSES} {TO_THE_END}"),
                &pose_panels(history, poses, model, self.b),
            );
        }
    }

    /// The standard deviations over time, and the bound where it can be computed.
    fn write_deviations(&self, body: &mut String, history: &History) {
        if history.poses.is_none() {
            return;
        }
        let bound = match &history.playback {
            Some(playback) => bound_found(self.result, playback, self.b.scale).map_err(NoBound::reason),
            None => Err("it is computed for the first objects of a page"),
        };
        let text = match &bound {
            Ok(_) => format!("{DEVIATIONS} {BOUND}"),
            Err(reason) => {
                format!("{DEVIATIONS} The least possible standard deviation (Cramer-Rao bound) is not drawn: {reason}.")
            }
        };
        let panels = deviation_panels(history, self.result.motion, bound.as_deref().unwrap_or_default(), self.b);
        write_panels(body, "How well that is known", &text, &panels);
    }
}

/// How well the frames fit, the last one with its curve, and which were rejected.
fn write_residuals(body: &mut String, history: &History, b: &MeaningOfB) {
    let mut panels = residual_panels(history, b);
    if let Some(latest) = &history.latest {
        let title = format!("Frame {}, the last one used", latest.0.frame);
        panels.push(fit_panel(title, std::slice::from_ref(latest), b.unit_of_outlines()));
    }
    write_panels(body, "How well the frames fit", "", &panels);
    if !history.rejected.is_empty() {
        let frames: FrameRanges = history.rejected.iter().map(|(frame, _)| *frame).collect();
        let _ = writeln!(body, "<p>Rejected frames: {frames}</p>");
    }
}

/// Panels below a heading, with what a reader should know of them. Those in which nothing would be drawn are named instead.
fn write_panels(body: &mut String, heading: &str, text: &str, panels: &[Panel]) {
    if panels.is_empty() {
        return;
    }
    let _ = writeln!(body, "<h3>{heading}</h3>");
    if !text.is_empty() {
        let _ = writeln!(body, "<p class=\"soft\">{}</p>", escape(text));
    }
    let (drawn, left_out): (Vec<_>, Vec<_>) = panels.iter().partition(|panel| shows_something(panel));
    if !left_out.is_empty() {
        let titles: Vec<&str> = left_out.iter().map(|panel| panel.title.as_str()).collect();
        let titles = escape(&titles.join("; "));
        let _ = writeln!(body, "<p class=\"soft\">Not stated in any frame, and so not drawn: {titles}.</p>");
    }
    body.push_str("<div class=\"panels\">\n");
    for panel in drawn {
        let height = if panel.view.is_some() { 400.0 } else { 300.0 };
        let _ = writeln!(body, "<div>{}</div>", panel_svg(panel, 400.0, height));
    }
    body.push_str("</div>\n");
}

/// Whether anything found is drawn in a panel, beside the truth and the bound.
fn shows_something(panel: &Panel) -> bool {
    let found = panel.curves.iter().filter(|curve| !matches!(curve.look, Look::Truth | Look::Reference | Look::Spans));
    found.flat_map(|curve| curve.runs.iter().flatten()).any(|point| point.iter().all(|value| value.is_finite()))
}

fn write_row<'a>(body: &mut String, tag: &str, cells: impl Iterator<Item = &'a str>) {
    let cells: String = cells.map(|cell| format!("<{tag}>{}</{tag}>", escape(cell))).collect();
    let _ = writeln!(body, "<tr>{cells}</tr>");
}
