use std::fmt::Write as _;
use std::io;

use freeform_motion::Truth;
use freeform_motion::tracker::ObjectResult;

use super::document::{around_body, write_settings};
use super::meaning_of_b::MeaningOfB;
use super::object_section::ObjectSection;
use super::pictures_left_out::PicturesLeftOut;
use super::player::write_script;
use crate::history::{Histories, OBJECTS_PLAYED, OBJECTS_WITH_POSES};
use crate::plot::escape;

/// What a report says. The default says nothing, of b in the coordinates of a file.
#[derive(Debug, Default)]
pub struct Report<'a> {
    /// Its title.
    pub title: String,
    /// The command that made it, as it could be typed; there is none in the report if empty.
    pub command: String,
    /// Names and values of the settings.
    pub settings: Vec<(&'static str, String)>,
    /// Unit and origin of the velocity b.
    pub meaning_of_b: MeaningOfB,
    /// What was found, one for each method.
    pub findings: Vec<Findings<'a>>,
    /// The true motion, where it is known.
    pub truth: Option<&'a Truth>,
    /// Why no motion was found, where none was.
    pub no_motion: Option<&'a str>,
    /// What ended the reading before the end of the input.
    pub read_error: Option<&'a str>,
    /// Pictures without an outline.
    pub left_out: Option<&'a PicturesLeftOut>,
    /// Where the poses of all objects are to be had, as a sentence; it is said where the report does not have them all.
    pub all_poses: Option<&'a str>,
}

/// What one method found.
#[derive(Debug, Clone, Copy)]
pub struct Findings<'a> {
    /// The result of every object.
    pub results: &'a [ObjectResult],
    /// What was found over time.
    pub histories: &'a Histories,
}

/// Writes a page that needs nothing but itself, one object after the other: parameters, warnings, a player of the first objects, and figures.
///
/// # Errors
///
/// Those of the sink.
pub fn write_report(sink: &mut impl io::Write, report: &Report<'_>) -> io::Result<()> {
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
            let (history, truth, b) = (histories.of(&result.object), report.truth, &report.meaning_of_b);
            ObjectSection { result, history, truth, b }.write(&mut body, &mut players);
            sink.write_all(body.as_bytes())?;
            body.clear();
        }
        if results.len() > OBJECTS_PLAYED {
            let elsewhere = report.all_poses.map_or_else(String::new, |sentence| format!(" {}", escape(sentence)));
            let _ = writeln!(
                body,
                "<p class=\"soft\">The first {OBJECTS_PLAYED} objects are shown frame by frame, the first {OBJECTS_WITH_POSES} with \
                 positions and standard deviations over time.{elsewhere}</p>"
            );
        }
    }
    report.left_out.into_iter().for_each(|left_out| left_out.write(&mut body));
    write_settings(&mut body, &report.settings, &report.command);
    if players > 0 {
        write_script(&mut body);
    }
    sink.write_all(body.as_bytes())?;
    sink.write_all(after.as_bytes())
}

fn summary(results: &[ObjectResult]) -> String {
    let frames: usize = results.iter().map(|result| result.frames).sum();
    let rejected: usize = results.iter().map(|result| result.frames_rejected).sum();
    format!("{} object(s), {frames} frames, {rejected} rejected", results.len())
}
