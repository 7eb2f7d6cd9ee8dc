//! What every page has: its head with the styles, and its settings at the end.
use std::fmt::Write as _;

use crate::plot::escape;

const STYLE: &str = include_str!("report.css");

/// The settings as a table, and the command as it was given; none where it is empty.
pub(crate) fn write_settings(body: &mut String, settings: &[(&'static str, String)], command: &str) {
    body.push_str("<h2>Settings</h2>\n<div class=\"scroll\"><table class=\"words\">\n");
    for (name, value) in settings {
        let _ = writeln!(body, "<tr><th>{}</th><td>{}</td></tr>", escape(name), escape(value));
    }
    body.push_str("</table></div>\n");
    if !command.is_empty() {
        let _ = writeln!(body, "<h2>Command</h2>\n<pre>{}</pre>", escape(command));
    }
}

/// A whole document of an escaped title and a body.
pub(crate) fn document(title: &str, body: &str) -> String {
    let [before, after] = around_body(title);
    before + body + &after
}

/// What stands before the body of a document, and after it.
pub(super) fn around_body(title: &str) -> [String; 2] {
    let before = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n"
    );
    [before, "</body>\n</html>\n".to_owned()]
}
