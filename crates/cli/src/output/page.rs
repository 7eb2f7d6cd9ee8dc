use std::fmt::Write as _;

use super::html::{document, write_settings};
use crate::commands::{Drawing, Section, Table};
use crate::plot::escape;

/// Least size of a figure on a narrow page, as a share of that of its file; beyond that it is scrolled.
const SMALLEST: f64 = 0.75;

/// A page of figures and tables that needs nothing but itself.
pub(crate) fn write_page(
    title: &str,
    introduction: &str,
    sections: &[Section],
    settings: &[(&'static str, String)],
    command: &str,
) -> String {
    let mut body = format!("<h1>{}</h1>\n<p class=\"soft\">{}</p>\n<ul>\n", escape(title), escape(introduction));
    for (index, Section { heading, .. }) in sections.iter().enumerate() {
        let _ = writeln!(body, "<li><a href=\"#part{index}\">{}</a></li>", escape(heading));
    }
    body.push_str("</ul>\n");
    for (index, section) in sections.iter().enumerate() {
        let _ = writeln!(body, "<h2 id=\"part{index}\">{}</h2>", escape(&section.heading));
        if !section.text.is_empty() {
            let _ = writeln!(body, "<p>{}</p>", escape(&section.text));
        }
        section.drawings.iter().for_each(|drawing| write_drawing(&mut body, drawing));
        section.tables.iter().for_each(|table| write_table(&mut body, table));
    }
    write_settings(&mut body, settings, command);
    document(&escape(title), &body)
}

fn write_drawing(body: &mut String, drawing: &Drawing) {
    let Drawing { name, caption, figure, .. } = drawing;
    // No larger than as a file, and where there is no room for it not so small that its text cannot be read.
    let [width, _] = figure.size();
    let least = (SMALLEST * width).round();
    let (caption, element) = (escape(caption), figure.element());
    let _ = writeln!(
        body,
        "<figure style=\"max-width:{width}px\">\n<div class=\"scroll\"><div style=\"min-width:{least}px\">{element}</div></div>\n\
         <figcaption>{caption} \
         <span class=\"soft\">{name}.svg, {name}.csv</span></figcaption>\n</figure>"
    );
}

fn write_table(body: &mut String, table: &Table) {
    let (title, caption) = (escape(&table.title), escape(&table.caption));
    let _ = writeln!(body, "<h3>{title}</h3>\n<p>{caption} <span class=\"soft\">{}.csv</span></p>", table.name);
    body.push_str("<div class=\"scroll\"><table class=\"numbers\">\n");
    for (tag, row) in std::iter::once(("th", &table.heads)).chain(table.rows.iter().map(|row| ("td", row))) {
        let cells = row.iter().enumerate().map(|(column, cell)| {
            let class = if table.is_of_names(column) { " class=\"name\"" } else { "" };
            format!("<{tag}{class}>{}</{tag}>", escape(cell))
        });
        let _ = writeln!(body, "<tr>{}</tr>", cells.collect::<String>());
    }
    body.push_str("</table></div>\n");
}
